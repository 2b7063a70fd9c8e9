// A textured rectangle with a displacement map, raised out of its plane: image-based extrusion displacement mapping, KR 10-0738500.
// Host: src/relief/extrusion, which has the claims.
//
// Every pixel stands for a base point A on the plane. The search goes down the view ray from the top of the volume over the plane to A,
// and what it finds is drawn at A's pixel. Where the volume overflows the rectangle, A lies on a virtual extension of the plane, which
// is reached over the plane itself, extended, or over an upright face at the rectangle's border.

struct ExtrusionFrame {
    clip_from_eye_relative: mat4x4<f32>,
    // South-west corner of the rectangle, eye-relative, metres; height of the map's 1, metres.
    corner: vec3<f32>,
    height_m: f32,
    // Size of the rectangle and of the facade's tile, metres.
    size_m: vec2<f32>,
    facade_m: vec2<f32>,
    search: SearchParameters,
    method: u32,
    padding_a: u32,
    padding_b: u32,
    padding_c: u32,
}

@group(0) @binding(0) var<uniform> scene: ExtrusionFrame;
@group(0) @binding(1) var surface: texture_2d<f32>;
@group(0) @binding(2) var displacement: texture_2d<f32>;
@group(0) @binding(3) var facade: texture_2d<f32>;
@group(0) @binding(4) var tiling: sampler;

// Methods: the texture alone; sunk below the plane, as before the patent; raised over it; raised with a facade on steep slopes.
const FLAT: u32 = 0u;
const SUNKEN: u32 = 1u;
const FACADES: u32 = 3u;

// Pieces that are drawn, by their instance: the rectangle; its plane extended; upright faces at its borders west, east, south, north.
const RECTANGLE: u32 = 0u;
const EXTENSION: u32 = 1u;
const FACES: u32 = 2u;

struct PieceVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) at: vec3<f32>,
    @location(1) @interpolate(flat) piece: u32,
}

@vertex
fn vs(@builtin(vertex_index) index: u32, @builtin(instance_index) piece: u32) -> PieceVertex {
    var square = array<vec2<f32>, 6>(
        vec2<f32>(0.0, 0.0), vec2<f32>(1.0, 0.0), vec2<f32>(1.0, 1.0),
        vec2<f32>(0.0, 0.0), vec2<f32>(1.0, 1.0), vec2<f32>(0.0, 1.0),
    );
    let uv = square[index];
    var place = vec3<f32>(uv * scene.size_m, 0.0);
    if piece == EXTENSION {
        // So far out that no ray over the volume's top edge comes down beyond, short of the horizon.
        place = vec3<f32>((uv * 41.0 - 20.0) * scene.size_m, 0.0);
    } else if piece >= FACES {
        let axis = (piece - FACES) >> 1u;
        let along = uv.x * scene.size_m[1u - axis];
        let border = select(0.0, scene.size_m[axis], ((piece - FACES) & 1u) == 1u);
        place = vec3<f32>(select(vec2<f32>(along, border), vec2<f32>(border, along), axis == 0u), uv.y * scene.height_m);
    }
    let at = scene.corner + place;
    return PieceVertex(scene.clip_from_eye_relative * vec4<f32>(at, 1.0), at, piece);
}

fn texel_of(image: texture_2d<f32>, uv: vec2<f32>) -> vec2<i32> {
    let size = vec2<i32>(textureDimensions(image));
    return clamp(vec2<i32>(floor(vec2<f32>(uv.x, 1.0 - uv.y) * vec2<f32>(size))), vec2<i32>(0), size - 1);
}

fn plan_of(at: vec3<f32>) -> vec2<f32> { return (at.xy - scene.corner.xy) / scene.size_m; }

fn displaced_height(at: vec3<f32>) -> f32 {
    let uv = plan_of(at);
    if any(uv < vec2<f32>(0.0)) || any(uv >= vec2<f32>(1.0)) { return -1.0e9; }
    let value = textureLoad(displacement, texel_of(displacement, uv), 0).x;
    return scene.corner.z + scene.height_m * select(value, value - 1.0, scene.method == SUNKEN);
}

// The base point of an upright face's point C on the virtual extension (claims 7, 19, 26). The face's tangent space is the plane's with
// normal = -tangent, tangent = normal, binormal = binormal: C lies dx along the plane's normal over the border and dy along it; `view`
// is the view direction in the plane's tangent space, x out over the border, y along it, z down to the plane.
// Gives how far out and along the border A lies. Twin: virtual_extension in src/relief/extrusion/overflow.rs.
fn virtual_extension(dx: f32, dy: f32, view: vec3<f32>) -> vec2<f32> {
    return vec2<f32>(dx * view.x / view.z, dx * view.y / view.z + dy);
}

// The base point of a pixel, eye-relative.
fn base_point(in: PieceVertex, direction: vec3<f32>) -> vec3<f32> {
    if in.piece < FACES || direction.z >= 0.0 { return in.at; }
    let axis = (in.piece - FACES) >> 1u;
    let out = select(-1.0, 1.0, ((in.piece - FACES) & 1u) == 1u);
    let dx = in.at.z - scene.corner.z;
    let dy = in.at[1u - axis] - scene.corner[1u - axis];
    let view = vec3<f32>(out * direction[axis], direction[1u - axis], -direction.z);
    let reached = virtual_extension(dx, dy, view);
    var base = vec3<f32>(0.0, 0.0, scene.corner.z);
    base[axis] = in.at[axis] + out * reached.x;
    base[1u - axis] = scene.corner[1u - axis] + reached.y;
    return base;
}

@fragment
fn fs(in: PieceVertex) -> @location(0) vec4<f32> {
    let direction = normalize(in.at);
    let base = base_point(in, direction);
    let t_base = length(base);
    let is_rectangle = in.piece == RECTANGLE;
    let uv_base = plan_of(base);
    // The extension is what lies beyond the rectangle.
    if in.piece == EXTENSION && all(uv_base >= vec2<f32>(0.0)) && all(uv_base < vec2<f32>(1.0)) { discard; }
    let flat_colour = textureLoad(surface, texel_of(surface, uv_base), 0);
    if scene.method == FLAT { return flat_colour; }

    // The volume: over the plane, or under it.
    var t_top = max((scene.corner.z + scene.height_m) / direction.z, 0.0);
    var t_end = t_base;
    if scene.method == SUNKEN {
        t_top = t_base;
        // Just past the lowest value, so that this is met as well.
        t_end = (scene.corner.z - 1.001 * scene.height_m) / direction.z;
    }
    if direction.z >= 0.0 { t_top = 0.0; }
    let found = search(vec3<f32>(0.0), direction, t_top, t_end, scene.search);
    if found.t >= FAR {
        if is_rectangle && scene.method != SUNKEN { return flat_colour; }
        // Only the raised shape is drawn, never the face (claims 8, 20, 27).
        discard;
    }
    let at = found.t * direction;
    let uv = plan_of(at);
    let colour = textureLoad(surface, texel_of(surface, uv), 0);
    if !is_steep(found, scene.search) { return colour; }
    let texel = scene.size_m / vec2<f32>(textureDimensions(displacement));
    let fall = vec2<f32>(
        fallen(at - vec3<f32>(texel.x, 0.0, 0.0)) - fallen(at + vec3<f32>(texel.x, 0.0, 0.0)),
        fallen(at - vec3<f32>(0.0, texel.y, 0.0)) - fallen(at + vec3<f32>(0.0, texel.y, 0.0)),
    );
    let normal = select(vec2<f32>(0.0), normalize(fall), dot(fall, fall) > 0.0);
    let shade = 0.72 + 0.22 * dot(normal, vec2<f32>(-0.8, -0.6));
    if scene.method != FACADES { return vec4<f32>(colour.rgb * shade, 1.0); }
    // A tiled texture on the slope: x = scale_x d, y = scale_y h, d = u + v.
    let metres = at - scene.corner;
    let tile = vec2<f32>(metres.x + metres.y, -metres.z) / scene.facade_m;
    return vec4<f32>(textureSampleLevel(facade, tiling, tile, 0.0).rgb * shade, 1.0);
}

fn fallen(at: vec3<f32>) -> f32 { return max(displaced_height(at), scene.corner.z - scene.height_m); }
