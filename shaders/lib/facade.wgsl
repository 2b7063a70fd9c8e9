// What walls and roofs look like: a tile of a facade for each storey and bay, a tile of roofing laid along the building. Host:
// src/material, which tells how the tiles and a building's code are made.
//
// The facade coordinate of KR 10-0738500, x = scale_x d and y = scale_y h, with d in bays along the outline and h in storeys over the
// base: whole numbers of both, so that no window is cut.

@group(2) @binding(6) var facade_colour: texture_2d_array<f32>;
@group(2) @binding(7) var facade_detail: texture_2d_array<f32>;
@group(2) @binding(8) var facade_sampler: sampler;
@group(2) @binding(9) var facade_palette: texture_2d<f32>;

// Fields of a building's code (`BuildingMaterial::code`).
// One that the rules no longer have is drawn as the first.
fn facade_of(code: u32) -> u32 {
    let number = code & 127u;
    return select(0u, number, number < textureDimensions(facade_palette).y);
}
// The first layer of a facade: the user's own stand behind roofs and ground.
fn facade_layer(facade: u32) -> u32 {
    let own = OWN_LAYERS + (max(facade, FACADES) - FACADES) * FACADE_BANDS;
    return select(facade * FACADE_BANDS, own, facade >= FACADES);
}
fn has_shops(code: u32) -> bool { return (code & 128u) != 0u; }
fn roof_of(code: u32) -> u32 { return (code >> 8u) & 255u; }
// Gravel and membrane lie on roofs with parapets.
fn is_flat_roof(code: u32) -> bool { return roof_of(code) == GRAVEL || roof_of(code) == MEMBRANE; }
fn storeys_of(code: u32) -> f32 { return f32(max((code >> 16u) & 255u, 1u)); }
fn direction_of(code: u32) -> f32 { return f32(code >> 24u) * (PI / 256.0); }

// Numbers of the bands (`FacadeBand::ALL`).
const BAND_GROUND: u32 = 0u;
const BAND_SHOP: u32 = 1u;
const BAND_MIDDLE: u32 = 2u;
const BAND_TOP: u32 = 3u;

// Where a wall's pixel lies, from the building passes.
struct WallPosition {
    // Bays along the outline; bays a metre, 0 on a column, whose bays are not known.
    bays: f32,
    bays_per_m: f32,
    // Metres over the base; the roof's.
    above_base: f32,
    height: f32,
}

// A surface's material at a pixel.
struct Material {
    albedo: vec3<f32>,
    // Unit normal, with the relief of the tile.
    normal: vec3<f32>,
    // The part that is glass.
    glass: f32,
    // The part of its windows that are lit at night, and by how much of a lamp.
    lit: f32,
}

// A bay narrower than this part of what its facade asks for has no window: its wall goes on.
const NARROWEST_BAY: f32 = 0.55;
// What of a bay the wall beside its window takes, on one side.
const PIER: f32 = 0.12;
// How light rooms are by day, by the tile's: dark ones are the most.
const DARK_ROOM: f32 = 0.6;
const LIGHT_ROOM: f32 = 3.4;
// Reflectance up to which a light room makes what is seen behind a pane lighter.
const LIGHTEST_ROOM: f32 = 0.34;
// Bays a metre of a column far away.
const FAR_BAYS_PER_M: f32 = 0.33;

// A place on a tile. `footprint`: width and height of a pixel on the surface, in tiles.
struct TilePlace {
    layer: u32,
    uv: vec2<f32>,
    footprint: vec2<f32>,
}

// A tile at a place: its colour and glass; its slopes and tint.
struct TileTexel {
    colour: vec4<f32>,
    detail: vec4<f32>,
}

fn tile_lod(place: TilePlace) -> f32 {
    let texels = max(place.footprint * TILE_SIZE, vec2<f32>(1.0e-6));
    let wide = max(texels.x, texels.y);
    // Between the pixel's width and its height: sharper than its width asks for by at most a level.
    return log2(max(min(texels.x, texels.y), 0.5 * wide));
}

fn tile_colour(place: TilePlace) -> vec4<f32> {
    return textureSampleLevel(facade_colour, facade_sampler, place.uv, place.layer, tile_lod(place));
}

fn tile_texel(place: TilePlace) -> TileTexel {
    let detail = textureSampleLevel(facade_detail, facade_sampler, place.uv, place.layer, tile_lod(place));
    return TileTexel(tile_colour(place), detail);
}

// Slopes of a tile along u and v, metres a metre.
fn tile_slope(detail: vec4<f32>) -> vec2<f32> { return (2.0 * detail.xy - 1.0) * MAX_SLOPE; }

// What of a wall's tile a pixel shows.
struct WallTile {
    place: TilePlace,
    // How far the window of the bay and storey is lit at night; how light the room behind it is by day, by the tile's.
    lit: f32,
    room: f32,
}

// `pixel_m`: width of a pixel on a surface that faces the eye, metres; `direction`: of the view ray.
fn wall_tile(code: u32, fid: u32, place: WallPosition, normal: vec3<f32>, direction: vec3<f32>, pixel_m: f32) -> WallTile {
    let style = facade_of(code);
    let is_column = place.bays_per_m == 0.0;
    let bays_per_m = select(place.bays_per_m, FAR_BAYS_PER_M, is_column);
    let storeys = storeys_of(code);
    let storey_m = max(place.height, 0.5) / storeys;
    let storey_place = place.above_base / storey_m;
    let storey = clamp(floor(storey_place), 0.0, storeys - 1.0);
    let is_ground = storey == 0.0;
    var band = select(BAND_MIDDLE, BAND_TOP, storey == storeys - 1.0);
    if is_ground { band = select(BAND_GROUND, BAND_SHOP, has_shops(code)); }
    let layer = facade_layer(style) + band;

    let bay = floor(place.bays);
    let chance = random3(vec3<u32>(fid, u32(i32(bay) + 4096), u32(storey)));
    // One of a tile's two bays; the same on all upper storeys of a facade, so that its axes run up.
    let variant_seed = select(chance.x, random3(vec3<u32>(fid, u32(i32(bay) + 4096), 77u)).x, band != BAND_GROUND);
    let variant = select(0.0, 1.0, variant_seed < select(0.5, 0.25, is_ground));
    var across = place.bays - bay;
    // Too narrow for a window: the pier beside it, wall after wall.
    let is_narrow = bays_per_m * facade_bay_m(style) > 1.0 / NARROWEST_BAY;
    if is_narrow { across = PIER * abs(2.0 * fract(0.5 * place.bays / bays_per_m) - 1.0) ; }
    // Below the base the foot of the wall goes on.
    let up = clamp(storey_place - storey, 0.5 / TILE_SIZE.y, 1.0 - 0.5 / TILE_SIZE.y);
    let uv = vec2<f32>(0.5 * (variant + across), up);
    let facing = max(abs(dot(direction, normal)), 0.02);
    let level = max(length(direction.xy), 0.02);
    let size = vec2<f32>(pixel_m / facing * 0.5 * bays_per_m, pixel_m / level / storey_m);
    let is_lit = select(0.0, 1.0, chance.y < 0.42);
    // Far away all windows are lit by the part that is.
    let far = smoothstep(0.3, 1.5, size.x * 2.0);
    let room = mix(DARK_ROOM, LIGHT_ROOM, chance.z * chance.z * chance.z);
    let place_on_tile = TilePlace(layer, uv, select(size, max(size, vec2<f32>(1.0)), is_column));
    return WallTile(place_on_tile, mix(is_lit, 0.42, far), mix(room, mix(DARK_ROOM, LIGHT_ROOM, 0.25), far));
}

fn wall_material(code: u32, fid: u32, normal: vec3<f32>, texel: TileTexel, tile: WallTile) -> Material {
    let style = facade_of(code);
    let palette = textureLoad(facade_palette, vec2<u32>(u32(random3(vec3<u32>(fid, 3u, 7u)).x * 4.0), style), 0).rgb;
    let shade = 0.88 + 0.24 * random3(vec3<u32>(fid, 5u, 7u)).y;
    var material: Material;
    material.albedo = texel.colour.rgb * mix(vec3<f32>(1.0), palette * shade / WALL_GREY, texel.detail.z);
    // A curtain is as light as it is.
    material.albedo *= mix(1.0, clamp(tile.room, DARK_ROOM, max(LIGHTEST_ROOM / max(texel.colour.g, 0.01), 1.0)), texel.colour.a);
    let along = vec3<f32>(-normal.y, normal.x, 0.0);
    let slope = tile_slope(texel.detail);
    material.normal = normalize(normal - along * slope.x - vec3<f32>(0.0, 0.0, slope.y));
    material.glass = texel.colour.a;
    // Curtains glow.
    material.lit = tile.lit * clamp(0.5 + 8.0 * texel.colour.g, 0.5, 1.6);
    return material;
}

// The width that a bay of a facade comes near to, metres (`FacadeStyle::bay_m`).
fn facade_bay_m(style: u32) -> f32 { return textureLoad(facade_palette, vec2<u32>(0u, style), 0).a; }

// The direction that a building's roofing is laid along.
fn roof_along(code: u32) -> vec2<f32> { return vec2<f32>(cos(direction_of(code)), sin(direction_of(code))); }

// `local`: metres along the roofing and across it; `size`: of a pixel on the roof, metres.
fn roof_tile(code: u32, local: vec2<f32>, size: f32) -> TilePlace {
    return TilePlace(FACADE_LAYERS + roof_of(code), local / ROOF_M, vec2<f32>(size) / ROOF_M);
}

// `along`: unit vector in plan that the roofing is laid along.
fn roof_material(along: vec2<f32>, fid: u32, texel: TileTexel) -> Material {
    let chance = random3(vec3<u32>(fid, 11u, 5u));
    let shade = 0.80 + 0.40 * chance.y;
    let warm = vec3<f32>(1.0 + 0.08 * (chance.z - 0.5), 1.0, 1.0 - 0.08 * (chance.z - 0.5));
    let slope = tile_slope(texel.detail);
    let plane = slope.x * along + slope.y * vec2<f32>(-along.y, along.x);
    return Material(texel.colour.rgb * shade * warm, normalize(vec3<f32>(-plane, 1.0)), 0.0, 0.0);
}
