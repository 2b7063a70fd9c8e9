//! Exposure: the factor from radiance to the values that the tone curve takes.

/// Fraction of the lit pixels that may be brighter than `BRIGHT`.
const BRIGHTER_FRACTION: f64 = 0.005;
/// What the tone curve shows at 0.94 of the display's white.
const BRIGHT: f32 = 1.5;

/// Factor that brings all but the brightest 0.5 % of the lit pixels below 1.5: the ghosts of one flare differ a hundredfold, so
/// the brightest are compressed and none is cut off.
pub fn auto_exposure(radiance: &[[f32; 3]]) -> f32 {
    let mut lit: Vec<f32> = radiance
        .iter()
        .map(|rgb| rgb.iter().fold(0.0_f32, |brightest, &value| brightest.max(value)))
        .filter(|&value| value > 0.0)
        .collect();
    if lit.is_empty() {
        return 1.0;
    }
    let index = ((lit.len() - 1) as f64 * (1.0 - BRIGHTER_FRACTION)) as usize;
    let (_, bright, _) = lit.select_nth_unstable_by(index, f32::total_cmp);
    BRIGHT / bright.max(f32::MIN_POSITIVE)
}
