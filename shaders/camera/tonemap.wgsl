// Exposure and tone mapping to the display. Curve: Khronos PBR Neutral (Khronos 2024, "PBR Neutral Tone Mapper"),
// which leaves colours below 0.76 as they are: a surveyor's photo keeps its colours. The curve's toe is left out: it takes
// away a reflection of 4 %, which this radiance does not have, and would drown the shade of streets.

struct Exposure {
    // Factor from summed radiance to the display's linear 0..1.
    scale: f32,
    // Factor of the flare, which is no sum.
    flare_scale: f32,
    padding: vec2<f32>,
}

@group(0) @binding(0) var sum: texture_2d<f32>;
@group(0) @binding(1) var<uniform> exposure: Exposure;
@group(0) @binding(2) var flare: texture_2d<f32>;

const START_COMPRESSION: f32 = 0.76;
const DESATURATION: f32 = 0.15;

fn pbr_neutral(colour: vec3<f32>) -> vec3<f32> {
    let c = max(colour, vec3<f32>(0.0));
    let peak = max(c.r, max(c.g, c.b));
    if peak < START_COMPRESSION { return c; }
    let d = 1.0 - START_COMPRESSION;
    let new_peak = 1.0 - d * d / (peak + d - START_COMPRESSION);
    let g = 1.0 - 1.0 / (DESATURATION * (peak - new_peak) + 1.0);
    return mix(c * new_peak / peak, vec3<f32>(new_peak), g);
}

@fragment
fn fs(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let pixel = vec2<i32>(position.xy);
    let colour = textureLoad(sum, pixel, 0).rgb * exposure.scale + textureLoad(flare, pixel, 0).rgb * exposure.flare_scale;
    return vec4<f32>(pbr_neutral(colour), 1.0);
}
