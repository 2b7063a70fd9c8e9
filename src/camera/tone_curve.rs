//! The tone curve on the CPU, function for function that of `shaders/lib/tone_curve.wgsl`, where its source is told; and the
//! encoding of sRGB, which the display's target does on the device.

/// What is darker than this is shown as it is.
pub const START_COMPRESSION: f32 = 0.76;

/// Display-linear value, 0 to 1, of an exposed one.
pub fn shoulder(value: f32) -> f32 {
    let c = value.max(0.0);
    if c < START_COMPRESSION {
        return c;
    }
    let d = 1.0 - START_COMPRESSION;
    1.0 - d * d / (c + d - START_COMPRESSION)
}

/// Display-linear colour of an exposed one.
pub fn tone_curve(colour: [f32; 3]) -> [f32; 3] {
    colour.map(shoulder)
}

/// 8-bit sRGB code of a linear value (IEC 61966-2-1); what is brighter than 1 is white.
pub fn srgb(linear: f32) -> u8 {
    let value = linear.clamp(0.0, 1.0);
    let encoded = if value <= 0.003_130_8 {
        12.92 * value
    } else {
        1.055 * value.powf(1.0 / 2.4) - 0.055
    };
    (255.0 * encoded).round() as u8
}

/// 8-bit sRGB, RGBA, of linear radiance times an exposure.
pub fn tone_mapped(radiance: &[[f32; 3]], exposure: f32) -> Vec<u8> {
    radiance
        .iter()
        .flat_map(|rgb| {
            let [r, g, b] = tone_curve(rgb.map(|value| value * exposure)).map(srgb);
            [r, g, b, 255]
        })
        .collect()
}
