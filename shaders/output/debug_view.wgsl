// An intermediate image in false colours. Host: src/output/debug_view.rs.

struct DebugFrame {
    // Which way of colouring: see the constants.
    kind: u32,
    // Which component of an integer image.
    component: u32,
    // Pixels of the image, by those of the view.
    scale: vec2<f32>,
}

@group(0) @binding(0) var<uniform> debug: DebugFrame;
@group(0) @binding(1) var floats: texture_2d<f32>;
@group(0) @binding(2) var words: texture_2d<u32>;

const DISTANCE: u32 = 0u;
const DISTANCE_BITS: u32 = 1u;
const NORMAL: u32 = 2u;
const ID: u32 = 3u;
const METRES_BITS: u32 = 4u;

// Near things bright, a tenfold distance two fifths darker; nothing is black.
fn distance_colour(t: f32) -> vec3<f32> {
    if t >= FAR { return vec3<f32>(0.0); }
    return vec3<f32>(clamp(1.0 - 0.2 * log2(1.0 + t) / log2(10.0), 0.05, 1.0));
}

fn normal_colour(code: u32) -> vec3<f32> {
    if code == 0u { return vec3<f32>(0.0); }
    let p = unpack2x16snorm(code);
    let z = 1.0 - abs(p.x) - abs(p.y);
    let folded = (1.0 - abs(p.yx)) * select(vec2<f32>(-1.0), vec2<f32>(1.0), p >= vec2<f32>(0.0));
    return 0.5 + 0.5 * normalize(vec3<f32>(select(p, folded, z < 0.0), z));
}

// A colour for every id, by multiplicative hashing (Knuth).
fn id_colour(id: u32) -> vec3<f32> {
    if id == 0u { return vec3<f32>(0.0); }
    let hash = id * 2654435761u;
    return 0.25 + 0.75 * vec3<f32>((vec3<u32>(hash) >> vec3<u32>(8u, 16u, 24u)) & vec3<u32>(255u)) / 255.0;
}

@fragment
fn fs(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let pixel = vec2<i32>(position.xy * debug.scale);
    let value = textureLoad(floats, pixel, 0);
    let word = textureLoad(words, pixel, 0)[debug.component];
    var colour = value.rgb;
    switch debug.kind {
        case DISTANCE: { colour = distance_colour(value.x); }
        case DISTANCE_BITS: { colour = distance_colour(bitcast<f32>(word)); }
        case NORMAL: { colour = normal_colour(word); }
        case ID: { colour = id_colour(word); }
        // Stripes of a metre, dark towards the outline's end of ten.
        case METRES_BITS: { colour = vec3<f32>(fract(bitcast<f32>(word)), fract(0.1 * bitcast<f32>(word)), 0.2); }
        default: {}
    }
    return vec4<f32>(colour, 1.0);
}
