//! Vignetting: how a lens's image darkens towards its corners. Light from an angle a gives the sensor, by that on the axis,
//! A(a) / A(0) · cos⁴ a, A being the area of the entrance through which it passes stop and barrel, by the power that the glass lets
//! through (Born & Wolf, *Principles of Optics*, 7th ed., section 4.8.3; the image is the projection's, r = f tan a).
//!
//! Many files give clear radii that only the beam on the axis needs: where they do not let the chief ray to the sensor's corner pass, the
//! barrel is left out.

use std::sync::Arc;

use glam::DVec2;
use rayon::prelude::*;

use super::lens::{D_LINE_UM, Lens};
use super::{LensOptics, Paraxial, Tracer, beam_direction};

/// Places from the centre to the sensor's corner at which it is known.
pub const FALLOFF_PLACES: usize = 16;
/// Least part of the light that is drawn: no corner is black for a prescription's sake.
const MIN_FALLOFF: f64 = 0.1;
/// Rays along an edge of the grid over the entrance.
const RAYS: usize = 96;

/// Part of the light on the axis, from the centre to the sensor's corner.
#[derive(Clone, Debug, PartialEq)]
pub struct Vignetting {
    /// At equal distances.
    pub falloff: [f32; FALLOFF_PLACES],
    /// Distance of the last, millimetres.
    pub corner_mm: f64,
    lens: Arc<Lens>,
    f_number: f64,
}

/// Light from one angle.
struct Beam<'a> {
    tracer: &'a Tracer<'a>,
    stop_mm: f64,
    angle: f64,
    /// Whether the barrel cuts.
    has_barrel: bool,
}

impl Beam<'_> {
    /// The rays of a grid over a part of the entrance that pass: where they come in, and their power.
    fn passing(&self, [min, max]: [DVec2; 2]) -> impl Iterator<Item = (DVec2, f64)> {
        (0..RAYS * RAYS).filter_map(move |k| {
            let unit = DVec2::new((k % RAYS) as f64 + 0.5, (k / RAYS) as f64 + 0.5) / RAYS as f64;
            let entry = min + (max - min) * unit;
            let ray = self.tracer.trace(None, entry, beam_direction(self.angle))?;
            let is_cut = self.has_barrel && ray.relative_height > 1.0;
            let passes = !is_cut && ray.stop_mm.length() <= self.stop_mm;
            passes.then_some((entry, ray.power))
        })
    }

    /// The part of a part of the entrance through which rays pass, a cell of the grid round them.
    fn pupil(&self, part: [DVec2; 2]) -> Option<[DVec2; 2]> {
        let cell = (part[1] - part[0]) / RAYS as f64;
        let corners = self.passing(part).map(|(entry, _)| [entry - cell, entry + cell]);
        corners.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
    }

    /// Power through a part of the entrance, square millimetres.
    fn light(&self, part: [DVec2; 2]) -> f64 {
        let cell = (part[1] - part[0]).element_product() / (RAYS * RAYS) as f64;
        self.passing(part).map(|(_, power)| power * cell).sum()
    }
}

impl Vignetting {
    /// Of a lens before its sensor.
    pub fn new(optics: &LensOptics) -> Self {
        let lens = &*optics.lens;
        let d_line = Paraxial::new(lens, D_LINE_UM, None);
        let stop_mm = d_line
            .stop_radius(optics.f_number)
            .min(lens.clear_radius(lens.stop));
        let corner_mm = 0.5 * optics.sensor_mm[0].hypot(optics.sensor_mm[1]);
        let tracer = Tracer::new(lens, D_LINE_UM, d_line.sensor_gap_mm());
        let front_mm = lens
            .clear_radius(0)
            .min(8.0 * d_line.entrance_pupil(stop_mm).max(optics.focal_mm));
        let whole = |has_barrel: bool| {
            let half = DVec2::splat(if has_barrel { front_mm } else { 3.0 * front_mm });
            [-half, half]
        };
        let beam = |place: usize, has_barrel| {
            let tangent = corner_mm * place as f64 / (FALLOFF_PLACES - 1) as f64 / optics.focal_mm;
            Beam {
                tracer: &tracer,
                stop_mm,
                angle: tangent.atan(),
                has_barrel,
            }
        };
        let corner = beam(FALLOFF_PLACES - 1, false);
        let chief = corner.pupil(whole(false)).and_then(|near| corner.pupil(near));
        let has_barrel = chief.is_some_and(|[min, max]| {
            let ray = tracer.trace(None, 0.5 * (min + max), beam_direction(corner.angle));
            ray.is_some_and(|ray| ray.relative_height <= 1.0)
        });
        let light: Vec<f64> = (0..FALLOFF_PLACES)
            .into_par_iter()
            .map(|place| {
                let beam = beam(place, has_barrel);
                // Where it comes in, then how much.
                let pupil = beam.pupil(whole(has_barrel)).and_then(|near| beam.pupil(near));
                pupil.map_or(0.0, |pupil| beam.light(pupil)) * beam.angle.cos().powi(4)
            })
            .collect();
        // A pupil between the rays is no pupil to tell anything by.
        let centre = light[0];
        let falloff = std::array::from_fn(|place| match centre > 0.0 {
            true => (light[place] / centre).max(MIN_FALLOFF) as f32,
            false => 1.0,
        });
        Self {
            falloff,
            corner_mm,
            lens: Arc::clone(&optics.lens),
            f_number: optics.f_number,
        }
    }

    /// Whether it is that of a lens before its sensor.
    pub fn is_of(&self, optics: &LensOptics) -> bool {
        Arc::ptr_eq(&self.lens, &optics.lens)
            && self.f_number == optics.f_number
            && self.corner_mm == 0.5 * optics.sensor_mm[0].hypot(optics.sensor_mm[1])
    }

    /// Part of the light at a distance from the centre, millimetres.
    pub fn at(&self, r_mm: f64) -> f32 {
        let place = (r_mm / self.corner_mm).clamp(0.0, 1.0) * (FALLOFF_PLACES - 1) as f64;
        let below = (place as usize).min(FALLOFF_PLACES - 2);
        let along = (place - below as f64) as f32;
        self.falloff[below] + (self.falloff[below + 1] - self.falloff[below]) * along
    }
}
