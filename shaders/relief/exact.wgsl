// Buildings raised out of the building map, drawn on overflow faces.
//
// The terrain's own polygons do not cover what rises above them: a roof before the sky, a tower over the tile's
// border. KR 10-0738500 adds faces for what overflows. Here they are the faces of the tile's volume (its border
// upright, from its lowest ground to its highest roof) that face AWAY from the viewer: those cover every pixel whose
// ray meets the volume, also with the eye inside it or above the horizon. Only the raised shape is drawn, never
// the face.
//
// Tiles come nearest first; the face of the nearest tile claims the pixel by the depth test, and its ray goes on
// from tile to tile (`walk_city`), so that each pixel walks once.

@group(2) @binding(0) var ground_distance: texture_2d<f32>;

struct OverflowVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(flat) slot: u32,
}

// A face is extended in its plane by this share of its side, and a strip of this width lies over the diagonal of its
// two triangles: where a rasteriser clips them it may leave pixels out along shared edges.
const EXTENDED: f32 = 0.002;
const STRIP: f32 = 0.01;

// Corner `index` (0..12) of a face's triangles, counter-clockwise: two for the square, two for the strip.
fn face_corner(index: u32) -> vec2<f32> {
    const FROM: f32 = -EXTENDED;
    const TO: f32 = 1.0 + EXTENDED;
    var corners = array<vec2<f32>, 8>(
        vec2<f32>(FROM, FROM), vec2<f32>(TO, FROM), vec2<f32>(TO, TO), vec2<f32>(FROM, TO),
        vec2<f32>(FROM + STRIP, FROM), vec2<f32>(TO, TO - STRIP), vec2<f32>(TO - STRIP, TO), vec2<f32>(FROM, FROM + STRIP),
    );
    var order = array<u32, 12>(0u, 1u, 2u, 0u, 2u, 3u, 4u, 5u, 6u, 4u, 6u, 7u);
    return corners[order[index]];
}

// Corner `index` (0..72) of the volume's six faces, in 0..1; counter-clockwise seen from outside.
fn volume_corner(index: u32) -> vec3<f32> {
    let face = index / 12u;
    let corner = face_corner(index % 12u);
    let side = f32(face & 1u);
    // The far side of an axis is seen with its two other axes in order, the near side with them swapped.
    let on_face = select(corner.yx, corner, face % 2u == 1u);
    switch face / 2u {
        case 0u: { return vec3<f32>(side, on_face.x, on_face.y); }
        case 1u: { return vec3<f32>(on_face.y, side, on_face.x); }
        default: { return vec3<f32>(on_face.x, on_face.y, side); }
    }
}

@vertex
fn vs_overflow(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> OverflowVertex {
    let slot = slots[instance];
    let corner = volume_corner(index);
    let plan = tile_corner(slot.tile) + corner.xy * frame.tile_m;
    let elevation = mix(slot.low, slot.high, corner.z) - frame.eye_elevation;
    return OverflowVertex(frame.clip_from_eye_relative * vec4<f32>(plan, elevation, 1.0), instance);
}

struct ReliefSurface {
    @location(0) distance: f32,
    @location(1) id: u32,
    // Facade coordinate (bits of an f32, metres along the outline) and packed normal.
    @location(2) surface: vec2<u32>,
}

@fragment
fn fs(in: OverflowVertex) -> ReliefSurface {
    let ray = make_ray(vec3<f32>(0.0), ray_direction(in.clip.xy));
    let t_ground = textureLoad(ground_distance, vec2<i32>(in.clip.xy), 0).x;
    // Where the ray enters the tile's volume.
    let slot = slots[in.slot];
    let corner = tile_corner(slot.tile);
    let t_sides = select(corner + frame.tile_m, corner, ray.direction.xy >= vec2<f32>(0.0)) * ray.inverse;
    var t_enter = max(max(t_sides.x, t_sides.y), 0.0);
    if ray.direction.z < 0.0 { t_enter = max(t_enter, (slot.high - frame.eye_elevation) / ray.direction.z); }
    // From a little before it: the face reaches a little beyond the volume.
    let before = 2.0 * EXTENDED * frame.tile_m / max(length(ray.direction.xy), 0.01);
    let hit = walk_city(ray, max(t_enter - before, 0.0), t_ground);
    // The face itself is never drawn: without a hit the surface stays at FAR, which shows nothing. It is not
    // discarded, so that its depth keeps the tiles behind from walking the same ray again.
    if hit.t >= FAR { return ReliefSurface(FAR, 0u, vec2<u32>(0u)); }
    return ReliefSurface(hit.t, roofs[hit.building].fid, vec2<u32>(bitcast<u32>(hit.along_m), pack_normal(hit_normal(hit))));
}
