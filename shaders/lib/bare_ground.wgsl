// Ground that no imagery shows: open land and yards, with contour lines as on a plan, paving where houses stand close, streets, and
// gardens with bushes between them. All are guesses by what buildings cover, in quiet tones.

// Which part of the ground round a place buildings cover. Host: src/scene/site_coverage.rs.
@group(2) @binding(13) var site_coverage: texture_2d_array<f32>;

// Reflectances. Open land is soil with tufts.
const SOIL: vec3<f32> = vec3<f32>(0.300, 0.286, 0.214);
const TUFT: vec3<f32> = vec3<f32>(0.205, 0.220, 0.115);
const YARD: vec3<f32> = vec3<f32>(0.300, 0.290, 0.245);
const PAVED: vec3<f32> = vec3<f32>(0.242, 0.240, 0.233);
const LAWN: vec3<f32> = vec3<f32>(0.150, 0.172, 0.078);
const ASPHALT: vec3<f32> = vec3<f32>(0.138, 0.138, 0.139);
const PAVEMENT: vec3<f32> = vec3<f32>(0.262, 0.257, 0.243);
const KERB: vec3<f32> = vec3<f32>(0.330, 0.324, 0.308);
const TRACK: vec3<f32> = vec3<f32>(0.285, 0.262, 0.215);
// Coverages between which open land goes over to yards, and yards to paving.
const YARDS: vec2<f32> = vec2<f32>(0.05, 0.12);
const PAVING: vec2<f32> = vec2<f32>(0.26, 0.42);
// The same of yards between known streets; coverages between which tracks come to be streets, and part of a track that is seen.
const PAVED_YARDS: vec2<f32> = vec2<f32>(0.60, 0.80);
const STREETS: vec2<f32> = vec2<f32>(0.18, 0.30);
const TRACK_PART: f32 = 0.5;
// Metres from a wall that are paved; width of a kerb and of the gutter before it, metres; how dark the gutter is; width of a pixel from
// which on neither is told.
const APRON_M: f32 = 1.0;
const KERB_M: f32 = 0.15;
const GUTTER_M: f32 = 0.4;
const GUTTER: f32 = 0.88;
const KERB_TO_M: vec2<f32> = vec2<f32>(0.1, 0.3);
// How much of the paving's grain asphalt has.
const ASPHALT_GRAIN: f32 = 0.6;
// Metres from the houses between which yards go over to open land.
const YARDS_TO_M: vec2<f32> = vec2<f32>(6.0, 18.0);
// Part of a yard that is lawn.
const LAWNS: f32 = 0.9;
// How far blotches move the borders of the three.
const RAGGED: f32 = 0.12;

// Sizes of the tile, by a roof's; widths of a pixel between which each fades, metres: from farther away its repetition would be seen.
const FINE: f32 = 0.3125;
const FINE_TO_M: vec2<f32> = vec2<f32>(0.03, 0.12);
const BROAD: f32 = 4.0;
const BROAD_TO_M: vec2<f32> = vec2<f32>(0.08, 0.3);
const BLOTCHES_TO_M: vec2<f32> = vec2<f32>(0.2, 0.7);
const PATCHES: f32 = 45.0;
const PATCHES_TO_M: vec2<f32> = vec2<f32>(3.0, 9.0);
const REGIONS: f32 = 310.0;
const REGIONS_TO_M: vec2<f32> = vec2<f32>(20.0, 60.0);
// Regions by patches.
const REGIONAL: f32 = 0.8;
// How far patches move the lightness of open land, and its tufts.
const PATCHED: f32 = 0.30;
const PATCHED_TUFTS: f32 = 0.9;
// Tufts of open land among houses.
const PARK_TUFTS: f32 = 0.35;

const CONTOUR: vec3<f32> = vec3<f32>(0.19, 0.155, 0.105);
// Metres between contours near by; every fifth is bolder. Width of a line, metres and pixels at least.
const CONTOUR_M: f32 = 2.0;
const LINE_M: f32 = 0.35;
const LINE_PIXELS: f32 = 1.2;
// Width of a pixel up to which no lines are drawn, metres; and how steeply one looks down on a plan: cosines between which they come.
const NEAR_PIXEL_M: f32 = 0.03;
const FROM_ABOVE: vec2<f32> = vec2<f32>(0.06, 0.22);
// Part of them that is drawn on yards.
const ON_YARDS: f32 = 0.35;

// How much of a pixel contours of an interval cover. `slope`: metres a metre.
fn contour(height: f32, interval: f32, slope: f32, pixel_m: f32) -> f32 {
    let away = abs(height - round(height / interval) * interval) / max(slope, 1.0e-3);
    let width = max(LINE_M, LINE_PIXELS * pixel_m);
    // On level ground a contour would be an area; far away lines would merge, and who stands on the ground sees no plan.
    let spacing = interval / max(slope, 1.0e-3);
    let fades = smoothstep(0.01, 0.04, slope) * smoothstep(4.0, 10.0, spacing / width) * smoothstep(NEAR_PIXEL_M, 3.0 * NEAR_PIXEL_M, pixel_m);
    return fades * (1.0 - smoothstep(0.5 * width - 0.5 * pixel_m, 0.5 * width + 0.5 * pixel_m, away));
}

fn contours(height: f32, normal: vec3<f32>, size: f32) -> f32 {
    let slope = length(normal.xy) / max(normal.z, 0.05);
    return max(
        max(0.11 * contour(height, CONTOUR_M, slope, size), 0.18 * contour(height, 5.0 * CONTOUR_M, slope, size)),
        0.18 * contour(height, 25.0 * CONTOUR_M, slope, size),
    );
}

// How dark joints of paving are; coverages between which paving comes to be of slabs.
const JOINT: f32 = 0.28;
const SLABS: vec2<f32> = vec2<f32>(0.38, 0.50);

// Bushes and trees of gardens, a crown in so many cells of a lattice at most: relief on the ground, for who looks down on them. Side of
// a cell, the least and the largest radius, metres; the part of the cells of a garden that have one.
const CROWN_CELL_M: f32 = 6.5;
const CROWN_M: vec2<f32> = vec2<f32>(1.1, 2.7);
const CROWNS: f32 = 0.72;
// Metres from the houses that gardens reach to.
const GARDEN_M: f32 = 10.0;
// Reflectances of the lightest and the darkest; how steep a crown's sides are, how far it has lobes; what of the light its shadow takes,
// and its length by the radius at most.
const SHRUB: vec3<f32> = vec3<f32>(0.148, 0.162, 0.070);
const TREE: vec3<f32> = vec3<f32>(0.085, 0.115, 0.048);
const CROWN_STEEP: f32 = 0.85;
const CROWN_LOBES: f32 = 0.10;
const CROWN_SHADE: f32 = 0.5;
const CROWN_SHADOW: f32 = 0.9;
// Cosines between the ray and the ground between which crowns come; widths of a pixel between which they go over to their mean, metres.
const CROWNS_FROM_ABOVE: vec2<f32> = vec2<f32>(0.15, 0.40);
const CROWNS_TO_M: vec2<f32> = vec2<f32>(1.2, 3.0);
// Part of a garden that crowns cover.
const CROWNS_COVER: f32 = 0.13;

// A crown at a place.
struct Crown {
    // The part of the place that it covers; what its shadow takes of the light beside it.
    cover: f32,
    shade: f32,
    // Slope of its dome where it covers the place, metres a metre; 0 for the lightest, 1 for the darkest.
    dome: vec2<f32>,
    tone: f32,
}

// A disc of radius 1 with five lobes, `turned` by that of a vector.
fn lobed_disc(from_centre: vec2<f32>, edge: f32, turned: vec2<f32>) -> f32 {
    let away = max(length(from_centre), 1.0e-3);
    let once = from_centre / away;
    let twice = vec2<f32>(once.x * once.x - once.y * once.y, 2.0 * once.x * once.y);
    let four = vec2<f32>(twice.x * twice.x - twice.y * twice.y, 2.0 * twice.x * twice.y);
    let five = vec2<f32>(four.x * once.x - four.y * once.y, four.x * once.y + four.y * once.x);
    return 1.0 - smoothstep(1.0 - edge, 1.0 + edge, away * (1.0 + CROWN_LOBES * dot(five, turned)));
}

// The crown of the lattice's cell at a place, where its middle lies in a garden: clear of walls, streets and pavements, and by houses.
fn crown_at(at: GroundView, settled: f32) -> Crown {
    let cell = floor(at.plan / CROWN_CELL_M);
    let chance = random3(vec3<u32>(vec2<u32>(vec2<i32>(cell) + 65536), 91u));
    let radius = mix(CROWN_M.x, CROWN_M.y, chance.z * chance.z);
    let centre = (cell + 0.5) * CROWN_CELL_M + 0.8 * (chance.xy - 0.5) * (CROWN_CELL_M - 2.0 * radius);
    let from_centre = (at.plan - centre) / radius;
    let garden = street_at(at.at - from_centre * radius);
    let is_clear = garden.from_building > 0.7 * radius && garden.from_building < GARDEN_M;
    let is_aside = garden.from_kerb < -garden.pavement - radius;
    let grows = is_clear && is_aside && fract(7.3 * (chance.x + chance.y)) < CROWNS;
    let seen = garden.known * settled * smoothstep(CROWNS_FROM_ABOVE.x, CROWNS_FROM_ABOVE.y, at.facing);
    let far = smoothstep(CROWNS_TO_M.x, CROWNS_TO_M.y, at.size);
    let edge = clamp(0.5 * at.size / radius, 0.12, 1.0);
    let sun = frame.sun.xy / max(frame.sun.z, 0.1);
    // No farther than the cell reaches on every side.
    let room = 0.5 * CROWN_CELL_M / radius - 1.0 - 0.4 * (CROWN_CELL_M / radius - 2.0);
    let shadow = sun * min(0.7, min(CROWN_SHADOW, room) / max(length(sun), 1.0e-3));
    let is_there = select(0.0, seen * (1.0 - far), grows);
    let turned = 2.0 * chance.yx - 1.0;
    let cover = is_there * lobed_disc(from_centre, edge, turned);
    let shade = CROWN_SHADE * smoothstep(0.0, 0.05, frame.sun.z) * is_there * lobed_disc(from_centre + shadow, 2.0 * edge, turned);
    return Crown(max(cover, seen * far * CROWNS_COVER), shade, CROWN_STEEP * cover * from_centre, chance.z);
}

// What the ground looks like at a place.
struct BareGround {
    albedo: vec3<f32>,
    // Unit normal, with the relief of the tile.
    normal: vec3<f32>,
    // How light it is by its mean: enlarged imagery gets some of it.
    lightness: f32,
}

// The finer of the two sizes of the tile, at a place `plan` metres from the city's corner. `size`: of a pixel on the ground, metres.
fn ground_tile(plan: vec2<f32>, size: f32) -> TilePlace {
    return TilePlace(GROUND_LAYER, plan / FINE / ROOF_M, vec2<f32>(size / FINE) / ROOF_M);
}

// Where the ground is seen from.
struct GroundView {
    // Metres from the eye in plan, and from the city's corner; elevation above the vertical datum.
    at: vec2<f32>,
    plan: vec2<f32>,
    height: f32,
    // Unit normal; cosine between it and the ray.
    normal: vec3<f32>,
    facing: f32,
    // Of a pixel on the ground, metres.
    size: f32,
}

// Of the whole tile: its last level is one texel.
fn mean_ground() -> vec4<f32> {
    return textureLoad(facade_colour, vec2<i32>(0), GROUND_LAYER, textureNumLevels(facade_colour) - 1u);
}

// How much more than the mean grows in the patches of open land, and in the regions that they lie in.
fn land_patches(plan: vec2<f32>, size: f32, mean: vec4<f32>) -> f32 {
    let aside = vec2<f32>(0.28 * plan.x + 0.96 * plan.y, 0.28 * plan.y - 0.96 * plan.x) / PATCHES;
    let patch_tile = tile_colour(TilePlace(GROUND_LAYER, aside / ROOF_M, vec2<f32>(size / PATCHES) / ROOF_M));
    let askew = vec2<f32>(0.6 * plan.x + 0.8 * plan.y, 0.6 * plan.y - 0.8 * plan.x) / REGIONS;
    let region_tile = tile_colour(TilePlace(GROUND_LAYER, askew / ROOF_M, vec2<f32>(size / REGIONS) / ROOF_M));
    return (patch_tile.b - mean.b) * (1.0 - smoothstep(PATCHES_TO_M.x, PATCHES_TO_M.y, size))
        + REGIONAL * (region_tile.b - mean.b) * (1.0 - smoothstep(REGIONS_TO_M.x, REGIONS_TO_M.y, size));
}

// Reflectance of open land far away, as beyond the survey, of which nothing is known.
fn open_land(plan: vec2<f32>, size: f32) -> vec3<f32> {
    let mean = mean_ground();
    let patches = land_patches(plan, size, mean);
    return mix(SOIL, TUFT, clamp(mean.g + PATCHED_TUFTS * patches, 0.0, 1.0)) * (1.0 + PATCHED * patches);
}

// `tile`: the tile at `ground_tile`; `has_plan`: streets are drawn, what lies between them is not paved.
fn bare_ground(at: GroundView, tile: TileTexel, has_plan: bool) -> BareGround {
    let plan = at.plan;
    let size = at.size;
    // The same tile larger, turned so that its repetition is not seen. Channels: `src/material/ground_painter.rs`.
    let turned = vec2<f32>(0.8 * plan.x - 0.6 * plan.y, 0.6 * plan.x + 0.8 * plan.y) / BROAD;
    let broad_tile = tile_colour(TilePlace(GROUND_LAYER, turned / ROOF_M, vec2<f32>(size / BROAD) / ROOF_M));
    let mean = mean_ground();
    let near = 1.0 - smoothstep(FINE_TO_M.x, FINE_TO_M.y, size);
    let fine = mix(mean, tile.colour, near);
    let broad = mix(broad_tile, mean, smoothstep(BROAD_TO_M.x, BROAD_TO_M.y, size));
    let blotch = (broad_tile.b - mean.b) * (1.0 - smoothstep(BLOTCHES_TO_M.x, BLOTCHES_TO_M.y, size));
    let patches = land_patches(plan, size, mean);
    let lightness = fine.a * broad.a / (mean.a * mean.a) * (1.0 + PATCHED * patches);
    let place = plan / (vec2<f32>(frame.grid) * frame.tile_m);
    let covered = textureSampleLevel(site_coverage, imagery_sampler, place, 0, 0.0).r + RAGGED * blotch;
    let park = PARK_TUFTS * smoothstep(YARDS.x, PAVING.x, covered);
    let tufts = clamp(0.6 * fine.g + 0.4 * broad.g + blotch + PATCHED_TUFTS * patches + park, 0.0, 1.0);
    let street = street_at(at.at);
    let by_houses = 1.0 - street.known * smoothstep(YARDS_TO_M.x, YARDS_TO_M.y, street.from_building + 8.0 * blotch);
    let settled = smoothstep(YARDS.x, YARDS.y, covered) * by_houses;
    let slabs = 1.0 - JOINT * tile.detail.z * near;
    let stone = fine.r * broad.r / (mean.r * mean.r);
    let paving = mix(PAVING, PAVED_YARDS, street.known);
    let dense = select(smoothstep(paving.x, paving.y, covered), 0.0, has_plan);
    // Lawns and paths, and what is paved along the walls.
    let edge = max(0.6 * size, 0.06);
    let lawn = LAWNS * smoothstep(-0.12, 0.12, blotch + 0.07) * street.known;
    let apron = street.known * (1.0 - smoothstep(APRON_M - edge, APRON_M + edge, street.from_building + 0.8 * blotch));
    let yard = mix(mix(YARD, mix(LAWN, TUFT, 0.6 * tufts), lawn) * lightness, 0.9 * PAVEMENT * stone, apron);
    var open = mix(mix(SOIL, TUFT, tufts) * lightness, yard, settled);
    let crown = crown_at(at, settled);
    open = mix(open * (1.0 - crown.shade), mix(SHRUB, TREE, crown.tone) * lightness * lightness, crown.cover);
    let off_street = mix(open, PAVED * stone * mix(1.0, slabs, smoothstep(SLABS.x, SLABS.y, covered)), dense);
    // Carriageway, gutter, kerb and pavement of a street; a track where few stand.
    let is_town = smoothstep(STREETS.x, STREETS.y, covered);
    let told = 1.0 - smoothstep(KERB_TO_M.x, KERB_TO_M.y, size);
    let gutter = told * (1.0 - smoothstep(GUTTER_M - edge, GUTTER_M + edge, street.from_kerb));
    let carriageway = smoothstep(-edge, edge, street.from_kerb);
    let kerb = told * (1.0 - smoothstep(KERB_M - edge, KERB_M + edge, abs(street.from_kerb + KERB_M)));
    let beside = mix(PAVEMENT * slabs, KERB, kerb) * stone;
    let asphalt = ASPHALT * mix(1.0, GUTTER, gutter) * mix(1.0, stone, ASPHALT_GRAIN);
    let surface = mix(TRACK * stone, mix(beside, asphalt, carriageway), is_town);
    let pavement = smoothstep(-street.pavement - edge, -street.pavement + edge, street.from_kerb);
    let on_street = street.known * mix(TRACK_PART * carriageway, pavement, is_town);
    let albedo = mix(off_street, surface, select(on_street, 0.0, has_plan));
    let lines = mix(1.0, ON_YARDS, settled) * (1.0 - dense) * (1.0 - on_street) * smoothstep(FROM_ABOVE.x, FROM_ABOVE.y, at.facing);
    let slope = near * tile_slope(tile.detail);
    let dome = crown.dome * (1.0 - on_street) * (1.0 - dense);
    let normal = normalize(at.normal - vec3<f32>(slope - dome, 0.0));
    return BareGround(mix(albedo, CONTOUR, lines * contours(at.height, at.normal, size)), normal, lightness);
}
