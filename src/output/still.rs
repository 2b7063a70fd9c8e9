//! A still image in memory: many samples, read back.

use half::f16;

use super::{FrameRequest, RenderError, Renderer};
use crate::gpu::{PassTimes, read_texture};
use crate::relief::FAR;

/// An image in memory, rows from the top.
pub struct Still {
    /// 8-bit sRGB.
    pub rgba: Vec<u8>,
    /// Metres along the view ray of the pixel's centre, NaN = sky.
    pub depth: Vec<f32>,
    /// Building ids at the pixel's centre, 0 = ground or sky.
    pub ids: Vec<u32>,
    /// GPU milliseconds of the last sample's passes, where the device can time.
    pub pass_times: Option<PassTimes>,
}

impl Renderer {
    /// Draws `samples` samples and reads the image back. Depth and ids are those of the pixel centre, whatever the number.
    ///
    /// # Errors
    /// When the device fails.
    pub fn still(&mut self, request: &FrameRequest<'_>, samples: u32) -> Result<Still, RenderError> {
        self.still_of(&vec![*request; samples.max(1) as usize])
    }

    /// The same with a request for every sample, of one size: motion blur.
    ///
    /// # Errors
    /// When the device fails.
    pub fn still_of(&mut self, requests: &[FrameRequest<'_>]) -> Result<Still, RenderError> {
        let mut centre = None;
        for (sample, request) in (0..).zip(requests) {
            if sample as usize + 1 == requests.len() {
                self.frame(request, sample)?;
                break;
            }
            self.add_sample(request, sample)?;
            if sample == 0 {
                centre = Some(self.read_surfaces()?);
            }
        }
        self.gpu.wait()?;
        let (depth, ids) = match centre {
            Some(centre) => centre,
            None => self.read_surfaces()?,
        };
        let rgba = match self.image() {
            Some(image) => read_texture(&self.gpu, &image.texture)?,
            None => Vec::new(),
        };
        Ok(Still {
            rgba,
            depth,
            ids,
            pass_times: self.pass_times()?,
        })
    }

    /// Linear radiance of the still drawn last, of that many samples, with what the lens adds: before exposure and tone mapping.
    ///
    /// # Errors
    /// When the device fails.
    pub fn radiance(&self, samples: u32) -> Result<Vec<[f32; 3]>, RenderError> {
        let Some(sums) = self.accumulate.targets() else {
            return Ok(Vec::new());
        };
        let samples = samples.max(1);
        let sum = read_texture::<[f32; 4]>(&self.gpu, &sums[(samples as usize - 1) % 2].texture)?;
        let added = match self.flare.target() {
            Some(flare) => read_texture::<[f16; 4]>(&self.gpu, &flare.texture)?,
            None => vec![[f16::ZERO; 4]; sum.len()],
        };
        let [width, height] = self.size().map(f64::from);
        let mm_per_pixel = 2.0 * self.image_half_mm[1] / height;
        // Of the city's light; the flare's has been through the lens.
        let vignetting = |index: usize| {
            let Some(vignetting) = &self.vignetting else {
                return 1.0;
            };
            let (x, y) = (
                (index as f64 % width).floor() + 0.5,
                (index as f64 / width).floor() + 0.5,
            );
            vignetting.at((x - 0.5 * width).hypot(y - 0.5 * height) * mm_per_pixel)
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
