//! The conductor: the passes of a picture in their order.
//!
//! ```text
//! for every sample:  ground ─▶ relief ─▶ shade ─▶ sum
//! then:              sum ─▶ exposure, tone mapping ─▶ picture
//! ```
//! Depth and ids are those of the pixel centre, whatever the number of samples.

use glam::DVec2;
use thiserror::Error;

use super::Renderer;
use crate::camera::Develop;
use crate::gpu::{GpuError, PassTimer, read_texture};
use crate::relief::{Light, ReliefMode, ReliefPass, ReliefTargets};
use crate::scene::SceneError;
use crate::space::View;

/// A picture could not be made.
#[derive(Debug, Error)]
pub enum RenderError {
    /// The city could not be loaded.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A tile or the digital map could not be read.
    #[error(transparent)]
    City(#[from] crate::city::CityError),
    /// The device failed.
    #[error(transparent)]
    Gpu(#[from] GpuError),
}

/// What to draw.
#[derive(Clone, Copy, Debug)]
pub struct PictureRequest {
    /// The pose.
    pub view: View,
    /// Pixels.
    pub size: [u32; 2],
    /// The sun.
    pub light: Light,
    /// How buildings are drawn.
    pub mode: ReliefMode,
    /// Samples a pixel, at least 1.
    pub samples: u32,
}

/// A picture in memory, rows from the top.
pub struct Picture {
    /// 8-bit sRGB.
    pub rgba: Vec<u8>,
    /// Metres along the view ray, NaN = sky.
    pub depth: Vec<f32>,
    /// Building ids, 0 = ground or sky.
    pub ids: Vec<u32>,
    /// GPU milliseconds of the last sample's passes (ground, buildings, light), where the device can time.
    pub pass_ms: Option<Vec<f64>>,
}

/// Sub-pixel place of sample `index`: the R2 low-discrepancy sequence (Roberts 2018), the first at the centre.
fn jitter(index: u32) -> DVec2 {
    const STEP: DVec2 = DVec2::new(0.754_877_666_246_692_7, 0.569_840_290_998_053_3);
    (DVec2::splat(0.5) + STEP * f64::from(index)).fract() - 0.5
}

impl Renderer {
    /// Draws one picture.
    pub fn picture(&self, request: &PictureRequest) -> Result<Picture, RenderError> {
        let targets = ReliefTargets::new(&self.gpu, request.size);
        let develop = Develop::new(&self.gpu, request.size);
        let timer = PassTimer::new(&self.gpu, ReliefPass::PASSES);
        let mut centre = None;
        for index in 0..request.samples {
            let mut projection = request.view.projection(request.size);
            projection.jitter = jitter(index);
            let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
            self.relief.encode(
                &self.gpu,
                &mut encoder,
                &self.resident,
                &request.view,
                &projection,
                &request.light,
                if request.samples > 1 { index + 1 } else { 0 },
                request.mode,
                &targets,
                Some(&timer),
            );
            develop.encode_sample(&self.gpu, &mut encoder, &targets.radiance, index);
            timer.resolve(&mut encoder);
            self.gpu.queue.submit([encoder.finish()]);
            self.gpu.wait()?;
            if index == 0 {
                centre = Some((
                    read_texture::<f32>(&self.gpu, &targets.distance.texture)?,
                    read_texture::<u32>(&self.gpu, &targets.id.texture)?,
                ));
            }
        }
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        develop.encode_picture(&self.gpu, &mut encoder, request.samples, 1.0);
        self.gpu.queue.submit([encoder.finish()]);
        let (mut depth, ids) = centre.unwrap_or_default();
        for t in &mut depth {
            if *t >= 3.0e38 {
                *t = f32::NAN;
            }
        }
        Ok(Picture {
            rgba: read_texture(&self.gpu, &develop.picture.texture)?,
            depth,
            ids,
            pass_ms: timer.milliseconds(&self.gpu)?,
        })
    }
}
