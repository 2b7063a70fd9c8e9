//! The tone curve on the CPU.

/// The brightest channel, no more than a half float holds: a sum may have run over.
pub fn brightest(rgb: &[f32; 3]) -> f32 {
    rgb.iter()
        .fold(0.0_f32, |most, &value| most.max(value))
        .min(65504.0)
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

/// 8-bit sRGB of linear radiance times an exposure. The ghosts of one flare differ a hundredfold: the brightest channel is
/// brought to x / (1 + x) and the others in proportion, so that none is cut off at white and all keep their hue
/// (Reinhard et al. 2002, "Photographic Tone Reproduction for Digital Images", equation 3).
pub fn tone_mapped(radiance: &[[f32; 3]], exposure: f32) -> Vec<u8> {
    radiance
        .iter()
        .flat_map(|rgb| {
            let share = exposure / (1.0 + exposure * brightest(rgb));
            let [r, g, b] = rgb.map(|value| srgb(value.min(65504.0) * share));
            [r, g, b, 255]
        })
        .collect()
}
