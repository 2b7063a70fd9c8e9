// Buildings by the method of KR 10-0738500: the building map as a displacement map, searched slice by slice (`extrusion_search.wgsl`).
//
// A tile is drawn on the faces of its volume that look away from the viewer: its ground extended in its plane, and upright faces at
// the borders over which buildings overflow. Only the raised shape is drawn, never the face. Tiles come in the order of their
// distance, the farthest first, each over those before it: occlusion as the patent solves it.

@group(2) @binding(0) var ground_distance: texture_2d<f32>;

struct TileVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(flat) tile: vec2<i32>,
}

// `instance`: the tile's place in the grid, row by row.
@vertex
fn vs(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> TileVertex {
    let tile = vec2<i32>(i32(instance) % frame.grid.x, i32(instance) / frame.grid.x);
    let corner = volume_corner(index);
    let entry = map_entry(tile);
    if entry.slot < 0 { return TileVertex(vec4<f32>(0.0), tile); }
    let slot = slot_at(entry.slot);
    let plan = mix(tile_corner(tile), tile_corner(tile + 1), corner.xy);
    let height = mix(slot.min_height, slot.max_height, corner.z) - frame.eye_elevation;
    return TileVertex(frame.clip_from_eye_relative * vec4<f32>(plan, height, 1.0), tile);
}

// The tile that the pixel searches.
var<private> searched: TileRecord;
var<private> searched_corner: vec2<f32>;
var<private> searched_level: u32;

fn displaced_height(at: vec3<f32>) -> f32 { return map_height(searched, at.xy - searched_corner, searched_level).height; }

@fragment
fn fs(in: TileVertex) -> BuildingTexels {
    let ray = make_ray(vec3<f32>(0.0), ray_direction(in.clip.xy));
    let entry = map_entry(in.tile);
    if entry.slot < 0 { discard; }
    searched = slot_at(entry.slot);
    searched_corner = tile_corner(tile_over(in.tile, entry.level));
    searched_level = entry.level;
    // The part of the ray in the tile's volume, down to the ground.
    let low = vec3<f32>(tile_corner(in.tile), searched.min_height - frame.eye_elevation);
    let high = vec3<f32>(tile_corner(in.tile + 1), searched.max_height - frame.eye_elevation);
    let inverse = 1.0 / ray.direction;
    let t_in = min(low * inverse, high * inverse);
    let t_out = max(low * inverse, high * inverse);
    let t_top = max(max(t_in.x, t_in.y), max(t_in.z, 0.0));
    let t_ground = textureLoad(ground_distance, vec2<i32>(in.clip.xy), 0).x;
    let t_end = min(min(t_out.x, t_out.y), min(t_out.z, t_ground));
    if t_top >= t_end { discard; }
    let found = search(vec3<f32>(0.0), ray.direction, t_top, t_end, frame.search);
    if found.t >= FAR { discard; }
    let at = found.t * ray.direction;
    let local = at.xy - searched_corner;
    let met = map_height(searched, local, searched_level);
    let roof = roof_at(met.roof_place);
    let base = roof.base_m - frame.eye_elevation;
    var normal = vec3<f32>(0.0, 0.0, 1.0);
    var bays = 0.0;
    var bays_per_m = 0.0;
    if is_steep(found, frame.search) {
        // A wall faces where the map falls; one that faces away cannot be seen.
        let step = frame.texel_m * f32(1u << searched_level);
        let fall = vec2<f32>(
            clamped_height(local - vec2<f32>(step, 0.0), base) - clamped_height(local + vec2<f32>(step, 0.0), base),
            clamped_height(local - vec2<f32>(0.0, step), base) - clamped_height(local + vec2<f32>(0.0, step), base),
        );
        let facing = -normalize(ray.direction.xy);
        let flat = select(facing, normalize(fall), dot(fall, fall) > 1.0e-4);
        normal = vec3<f32>(select(facing, flat, dot(flat, facing) > 0.0), 0.0);
        // x = scale_x d with d = u + v, the simplest of the patent's; y = scale_y h follows from the base (`facade.wgsl`).
        bays_per_m = 1.0 / SEARCH_BAY_M;
        bays = (local.x + local.y) * bays_per_m;
    }
    let bays_or_roof = select(select(0u, met.roof_place, searched.roof_quads == 2u), bitcast<u32>(bays), normal.z == 0.0);
    let surface = vec4<u32>(bitcast<u32>(found.t), roof.fid, bays_or_roof, pack_normal(normal));
    let facade = bitcast<vec3<u32>>(vec3<f32>(bays_per_m, base, roof.roof_m - roof.base_m));
    return BuildingTexels(surface, vec4<u32>(facade, roof.material));
}

fn clamped_height(local: vec2<f32>, base: f32) -> f32 { return max(map_height(searched, local, searched_level).height, base); }
