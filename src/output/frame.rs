//! The conductor: the passes of a picture in their order.
//!
//! ```text
//! for every sample:  ground ─▶ relief ─▶ shade ─▶ sum
//! then:              sum + flare of the lens ─▶ exposure, tone mapping ─▶ picture
//! ```
//! Depth and ids are those of the pixel centre, whatever the number of samples.

use std::sync::Arc;

use glam::DVec2;
use thiserror::Error;

use super::Renderer;
use crate::camera::flare::{
    Aperture, Blend, Fit, FlareEffect, FlareLight, FlareRequest, GhostParameters, Preset, TableFile,
};
use crate::camera::lens::{D_LINE_UM, Lens};
use crate::camera::{Develop, Paraxial};
use crate::gpu::{Gpu, GpuError, PassTimer, read_texture};
use crate::relief::{Light, ReliefMode, ReliefPass, ReliefTargets, SUN_RADIUS, sun_irradiance};
use crate::scene::SceneError;
use crate::space::View;

/// A picture could not be made.
#[derive(Debug, Error)]
pub enum RenderError {
    /// The city could not be loaded.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A tile or the footprint dataset could not be read.
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

/// The lens that a picture is taken through.
pub struct LensRequest<'a> {
    /// Its prescription. The sensor is taken as large as the view needs at its focal length.
    pub lens: &'a Lens,
    /// The f-number.
    pub f_number: f64,
    /// The iris.
    pub aperture: Aperture,
    /// How its ghosts are made, and how finely.
    pub preset: Preset,
    /// Whether ghosts are drawn.
    pub ghosts: bool,
    /// A table to play, baked for the same lens and f-number.
    pub table: Option<&'a TableFile>,
    /// How linear and nonlinear ghosts come together.
    pub blend: Blend,
    /// What of the nonlinear ghosts is fitted to the linear ones.
    pub fit: Fit,
    /// Visible share of the sun, 0 to 1.
    pub sun_visibility: f64,
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
        self.picture_through(request, None)
    }

    /// Draws one picture, through a lens if one is given.
    pub fn picture_through(
        &self,
        request: &PictureRequest,
        lens: Option<&LensRequest<'_>>,
    ) -> Result<Picture, RenderError> {
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
        if let Some(lens) = lens {
            add_flare(&self.gpu, &mut encoder, &develop, request, lens)?;
        }
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

/// Draws the sun's ghosts, and its image with its starburst, where the sun stands before the lens.
fn add_flare(
    gpu: &Gpu,
    encoder: &mut wgpu::CommandEncoder,
    develop: &Develop,
    request: &PictureRequest,
    lens: &LensRequest<'_>,
) -> Result<(), RenderError> {
    let projection = request.view.projection(request.size);
    let to_sun = request.light.to_sun;
    let basis = [projection.right, projection.up, projection.forward];
    let [angle, azimuth] = FlareLight::angle_azimuth(basis.map(|axis| to_sun.dot(axis)).into());
    let focal_mm = Paraxial::new(lens.lens, D_LINE_UM, None).efl_mm.abs();
    let half_height = focal_mm * projection.tan_half_fov_y;
    let [width, height] = request.size.map(f64::from);
    let flare = FlareRequest {
        lens: Arc::new(lens.lens.clone()),
        f_number: lens.f_number,
        aperture: lens.aperture,
        ghosts: lens.ghosts.then(|| GhostParameters {
            blend: lens.blend,
            fit: lens.fit,
            ..lens.preset.ghosts()
        }),
        starburst: Some(lens.preset.starburst()),
        table: lens.table.cloned().map(Arc::new),
        light: FlareLight {
            angle,
            azimuth,
            angular_radius: SUN_RADIUS,
            irradiance: sun_irradiance(to_sun),
            visible_fraction: lens.sun_visibility,
        },
        image_half_mm: [half_height * width / height, half_height],
    };
    let mut effect = FlareEffect::new(gpu, Develop::FLARE);
    effect.prepare(gpu, &flare)?;
    effect.encode(encoder, &develop.flare, None);
    Ok(())
}
