//! The conductor: the passes of a frame in their order.
//!
//! ```text
//! every sample:  ground ─▶ buildings (cone, exact | search | polygons) ─▶ light (ambient, light) ─▶ accumulate | temporal ─┐
//! then:                                                           flare (sun through the lens) ──┴▶ tone map ─▶ image
//! ```
//! Before them the tile pool takes what the view wants. A frame is a sample and the image of all samples so far; in
//! motion, of what the frames before it showed of what it sees. It reads nothing
//! back and allocates nothing on the device, unless tiles come.

use glam::DVec2;

use super::{FlareSettings, RenderError, Renderer};
use crate::camera::{
    Camera, ToneMapping, Vignetting, daylight, daylight_exposure, towards_sun_exposure, white_balance,
};
use crate::gpu::Band;
use crate::relief::{ReliefSettings, ReliefView, TIMED_PASSES, sun_seen_from};
use crate::space::{ImageWindow, Projection, Sun};

const RELIEF: usize = TIMED_PASSES.len();
/// Timed passes of a frame: the relief's, then the camera's.
pub(super) const PASSES: [&str; RELIEF + 3] = {
    let [ground, buildings, light] = TIMED_PASSES;
    [ground, buildings, light, "accumulate", "flare", "tone map"]
};
const ACCUMULATE: u32 = RELIEF as u32;
const FLARE: u32 = ACCUMULATE + 1;
const TONE_MAP: u32 = ACCUMULATE + 2;

/// Samples after which the frames of a moving camera take the first one's place again.
const MOVING_SAMPLES: u32 = 32;

/// What to draw.
#[derive(Clone, Copy)]
pub struct FrameRequest<'a> {
    /// The camera.
    pub camera: &'a Camera,
    /// The sun.
    pub sun: &'a Sun,
    /// Pixels.
    pub size: [u32; 2],
    /// How the city is drawn.
    pub relief: ReliefSettings,
    /// What the camera's lens adds; counts only behind a lens.
    pub flare: Option<&'a FlareSettings>,
    /// Factor on radiance before tone mapping, over that which follows the daylight.
    pub exposure: f32,
}

/// Sub-pixel position of sample `index`: the R2 low-discrepancy sequence (Roberts 2018), the first at the centre.
fn jitter(index: u32) -> DVec2 {
    const STEP: DVec2 = DVec2::new(0.754_877_666_246_692_7, 0.569_840_290_998_053_3);
    (DVec2::splat(0.5) + STEP * f64::from(index)).fract() - 0.5
}

impl Renderer {
    /// Draws sample number `sample` of a view and the image of all samples so far; sample 0 begins the view anew.
    ///
    /// # Errors
    /// When the device fails.
    pub fn frame(&mut self, request: &FrameRequest<'_>, sample: u32) -> Result<(), RenderError> {
        self.frame_band(request, sample, Band::WHOLE)
    }

    /// The same a band at a time, the first to the last of one request and sample; the last makes the image.
    ///
    /// # Errors
    /// When the device fails.
    pub fn frame_band(
        &mut self,
        request: &FrameRequest<'_>,
        sample: u32,
        band: Band,
    ) -> Result<(), RenderError> {
        self.show(request.size, ImageWindow::whole(request.size));
        self.draw_band(request, sample, band)
    }

    /// Draws a band of the window that is shown.
    pub(super) fn draw_band(
        &mut self,
        request: &FrameRequest<'_>,
        sample: u32,
        band: Band,
    ) -> Result<(), RenderError> {
        if band.is_first() {
            self.prepare(request)?;
            self.prepare_flare(request)?;
        }
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        self.encode_sample(&mut encoder, request, sample, band);
        if band.is_last() {
            self.encode_image(&mut encoder, request, sample + 1);
        }
        self.timer.resolve(&mut encoder);
        self.gpu.queue.submit([encoder.finish()]);
        Ok(())
    }

    /// Draws a view as the next of a moving camera: one sample, and what the frames before it showed of what it sees.
    ///
    /// # Errors
    /// When the device fails.
    pub fn moving_frame(&mut self, request: &FrameRequest<'_>) -> Result<(), RenderError> {
        self.show(request.size, ImageWindow::whole(request.size));
        self.prepare(request)?;
        self.prepare_flare(request)?;
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        let sample = self.moving_frames % MOVING_SAMPLES;
        self.moving_frames = sample + 1;
        let projection = self.encode_relief(&mut encoder, request, sample, Band::WHOLE);
        if let Some([sum, _]) = self.accumulate.targets() {
            let timestamps = self.timer.pass(ACCUMULATE);
            self.temporal
                .encode(&self.gpu, &mut encoder, &projection, sum, timestamps);
        }
        self.encode_image(&mut encoder, request, 1);
        self.timer.resolve(&mut encoder);
        self.gpu.queue.submit([encoder.finish()]);
        Ok(())
    }

    /// The next frame of a moving camera keeps nothing of those before.
    pub fn cut(&mut self) {
        self.temporal.forget();
    }

    /// Adds a sample of the window that is shown without making an image of it.
    pub(super) fn add_sample(&mut self, request: &FrameRequest<'_>, sample: u32) -> Result<(), RenderError> {
        self.prepare(request)?;
        if sample == 0 {
            self.prepare_flare(request)?;
        }
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        self.encode_sample(&mut encoder, request, sample, Band::WHOLE);
        self.gpu.queue.submit([encoder.finish()]);
        Ok(self.gpu.wait()?)
    }

    fn encode_sample(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        request: &FrameRequest<'_>,
        sample: u32,
        band: Band,
    ) {
        self.encode_relief(encoder, request, sample, band);
        if band.is_last() {
            self.accumulate
                .encode(encoder, sample, self.timer.pass(ACCUMULATE));
        }
    }

    /// Draws a sample's radiance; gives its view.
    fn encode_relief(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        request: &FrameRequest<'_>,
        sample: u32,
        band: Band,
    ) -> Projection {
        let projection = Projection {
            jitter: jitter(sample),
            window: self.window,
            ..request.camera.projection(request.size)
        };
        let view = ReliefView {
            projection: &projection,
            sun: request.sun,
            sample,
            disc_fraction: self.flare.disc_fraction(),
            settings: request.relief,
            band,
        };
        self.relief
            .encode(&self.gpu, encoder, &self.resident, &view, &self.timer);
        projection
    }

    fn encode_image(&mut self, encoder: &mut wgpu::CommandEncoder, request: &FrameRequest<'_>, samples: u32) {
        self.flare.encode(encoder, (&self.timer, FLARE));
        self.prepare_vignetting(request);
        let timestamps = self.timer.pass(TONE_MAP);
        let daylight = daylight(request.sun, self.relief.sky_on_level_ground());
        let metered = match request.camera.lens() {
            Some(_) => towards_sun_exposure(request.camera.pose.forward, request.sun),
            None => 1.0,
        };
        let exposure = request.exposure * metered * daylight_exposure(daylight);
        let mapping = ToneMapping {
            exposure,
            white_balance: white_balance(daylight),
            samples,
            vignetting: self
                .vignetting
                .as_ref()
                .map(|(vignetting, mm_per_pixel)| (vignetting, *mm_per_pixel)),
            centre: self.image_centre(),
        };
        self.tone_map.encode(&self.gpu, encoder, &mapping, timestamps);
    }

    /// Brings the vignetting up to date with the camera's lens.
    fn prepare_vignetting(&mut self, request: &FrameRequest<'_>) {
        let known = self.vignetting.take();
        self.vignetting = request.camera.lens().map(|optics| {
            let known = known
                .map(|(vignetting, _)| vignetting)
                .filter(|known| known.is_of(optics));
            let mm_per_pixel = 2.0 * optics.image_half_mm(request.size)[1] / f64::from(request.size[1]);
            (known.unwrap_or_else(|| Vignetting::new(optics)), mm_per_pixel)
        });
    }

    /// The image's centre, pixels from the first one that is drawn.
    pub(super) fn image_centre(&self) -> DVec2 {
        let first = DVec2::from_array(self.window.first.map(f64::from));
        0.5 * DVec2::from_array(self.image_size().map(f64::from)) - first
    }

    /// The sun as the camera sees it, past roofs and hills.
    pub fn sun_seen(&self, request: &FrameRequest<'_>) -> Sun {
        sun_seen_from(&self.resident.tiles, request.camera.pose.eye, request.sun)
    }
}
