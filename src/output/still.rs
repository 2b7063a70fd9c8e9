//! A still image in memory: many samples, read back.

use glam::DVec2;
use half::f16;

use super::windows::{Assembled, image_windows};
use super::{FrameRequest, RenderError, Renderer};
use crate::gpu::{Band, PassTimes, read_texture};
use crate::relief::FAR;

/// An image in memory, rows from the top.
pub struct Still {
    /// 8-bit sRGB.
    pub rgba: Vec<u8>,
    /// Linear radiance with what the lens adds, before exposure and tone mapping; none where it was not asked for.
    pub radiance: Vec<[f32; 3]>,
    /// Metres along the view ray of the pixel's centre, NaN = sky.
    pub depth: Vec<f32>,
    /// Building ids at the pixel's centre, 0 = ground or sky.
    pub ids: Vec<u32>,
    /// GPU milliseconds of the last sample's passes, where the device can time.
    pub pass_times: Option<PassTimes>,
}

/// What comes of one window.
struct Part {
    rgba: Vec<[u8; 4]>,
    radiance: Vec<[f32; 3]>,
    surfaces: (Vec<f32>, Vec<u32>),
}

impl Renderer {
    /// Draws `samples` samples and reads the image back, in as many windows as its size needs. Depth and ids are those of the pixel
    /// centre, whatever the number.
    ///
    /// # Errors
    /// When the device fails.
    pub fn still(&mut self, request: &FrameRequest<'_>, samples: u32) -> Result<Still, RenderError> {
        self.still_of(&vec![*request; samples.max(1) as usize], false)
    }

    /// The same with a request for every sample, of one size: motion blur. `with_radiance`: reads that back as well.
    ///
    /// # Errors
    /// When the device fails.
    pub fn still_of(
        &mut self,
        requests: &[FrameRequest<'_>],
        with_radiance: bool,
    ) -> Result<Still, RenderError> {
        let size = requests.first().map_or([0; 2], |request| request.size);
        let (mut rgba, mut radiance) = (Assembled::new(size), Assembled::new(size));
        let (mut depth, mut ids) = (Assembled::new(size), Assembled::new(size));
        for window in image_windows(size, self.max_window_px) {
            self.show(size, window.drawn);
            let part = self.draw_part(requests, with_radiance)?;
            rgba.put(&window, part.rgba);
            depth.put(&window, part.surfaces.0);
            ids.put(&window, part.surfaces.1);
            if with_radiance {
                radiance.put(&window, part.radiance);
            }
        }
        Ok(Still {
            rgba: rgba.into_values().into_flattened(),
            radiance: radiance.into_values(),
            depth: depth.into_values(),
            ids: ids.into_values(),
            pass_times: self.pass_times()?,
        })
    }

    /// Draws all samples of the window that is shown.
    fn draw_part(&mut self, requests: &[FrameRequest<'_>], with_radiance: bool) -> Result<Part, RenderError> {
        let mut centre = None;
        for (sample, request) in (0..).zip(requests) {
            if sample as usize + 1 == requests.len() {
                self.draw_band(request, sample, Band::WHOLE)?;
                break;
            }
            self.add_sample(request, sample)?;
            if sample == 0 {
                centre = Some(self.read_surfaces()?);
            }
        }
        self.gpu.wait()?;
        let surfaces = match centre {
            Some(centre) => centre,
            None => self.read_surfaces()?,
        };
        Ok(Part {
            rgba: match self.image() {
                Some(image) => read_texture(&self.gpu, &image.texture)?,
                None => Vec::new(),
            },
            radiance: match with_radiance {
                true => self.radiance(requests.len())?,
                false => Vec::new(),
            },
            surfaces,
        })
    }

    /// Linear radiance of what was drawn last, of that many samples, with what the lens adds: before exposure and tone mapping.
    fn radiance(&self, samples: usize) -> Result<Vec<[f32; 3]>, RenderError> {
        let Some(sums) = self.accumulate.targets() else {
            return Ok(Vec::new());
        };
        let samples = samples.max(1);
        let sum = read_texture::<[f32; 4]>(&self.gpu, &sums[(samples - 1) % 2].texture)?;
        let added = match self.flare.target() {
            Some(flare) => read_texture::<[f16; 4]>(&self.gpu, &flare.texture)?,
            None => vec![[f16::ZERO; 4]; sum.len()],
        };
        let width = self.size()[0].max(1) as usize;
        let centre = self.image_centre();
        // Of the city's light; the flare's has been through the lens.
        let vignetting = |index: usize| {
            let Some((vignetting, mm_per_pixel)) = &self.vignetting else {
                return 1.0;
            };
            let pixel = DVec2::new((index % width) as f64, (index / width) as f64) + 0.5;
            vignetting.at(pixel.distance(centre) * mm_per_pixel)
        };
        let pixel = |(index, (sum, added)): (usize, (&[f32; 4], &[f16; 4]))| {
            let part = vignetting(index) / samples as f32;
            std::array::from_fn(|k| sum[k] * part + f32::from(added[k].min(f16::MAX)))
        };
        Ok(sum.iter().zip(&added).enumerate().map(pixel).collect())
    }

    /// Depth (metres along the view ray, NaN = sky) and ids of the last sample.
    ///
    /// # Errors
    /// When the device fails.
    pub fn read_surfaces(&self) -> Result<(Vec<f32>, Vec<u32>), RenderError> {
        let Some(targets) = self.relief_targets() else {
            return Ok((Vec::new(), Vec::new()));
        };
        let mut depth = read_texture::<f32>(&self.gpu, &targets.distance.texture)?;
        for t in depth.iter_mut().filter(|t| **t >= FAR) {
            *t = f32::NAN;
        }
        Ok((depth, read_texture(&self.gpu, &targets.id.texture)?))
    }
}
