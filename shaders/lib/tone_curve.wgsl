// The tone curve: the shoulder of Khronos PBR Neutral (Khronos 2024, "PBR Neutral Tone Mapper"), which leaves values below 0.76
// as they are: a surveyor's photo keeps its colours. Twin: src/camera/tone_curve.rs.
// Two things of the original are left out. Its toe takes away a reflection of 4 %, which this radiance does not have, and would
// drown the shade of streets. And it scales all channels by the brightest one's compression, so that red light added to a blue
// sky lowers green and blue: here each channel has the curve to itself, and added light darkens nothing.

fn shoulder(value: f32) -> f32 {
    let c = max(value, 0.0);
    if c < START_COMPRESSION { return c; }
    let d = 1.0 - START_COMPRESSION;
    return 1.0 - d * d / (c + d - START_COMPRESSION);
}

fn tone_curve(colour: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(shoulder(colour.r), shoulder(colour.g), shoulder(colour.b));
}
