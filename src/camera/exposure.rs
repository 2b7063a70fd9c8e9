//! Exposure: the factor from radiance to the values that the tone curve takes.

use super::tone_curve::brightest;

/// Factor that brings all but the brightest 0.5 % of the lit pixels below 1.5, which [`tone_mapped`] shows at 0.6 of the
/// display's white.
pub fn auto_exposure(radiance: &[[f32; 3]]) -> f32 {
    let mut lit: Vec<f32> = radiance
        .iter()
        .map(brightest)
        .filter(|&value| value > 0.0)
        .collect();
    if lit.is_empty() {
        return 1.0;
    }
    lit.sort_by(f32::total_cmp);
    1.5 / lit[(lit.len() - 1) * 995 / 1000].max(f32::MIN_POSITIVE)
}
