//! What the camera's lens adds to an image: a target of its own, drawn anew only when something of the flare changed. It shows the
//! image as a whole, also where that is drawn in windows: with as many pixels as a window may have, of which each shows its part.

use std::sync::Arc;

use super::flare_window::FlareWindow;
use super::windows::MAX_WINDOW_PX;
use super::{FrameRequest, RenderError, Renderer};
use crate::camera::flare::{
    Aperture, FlareEffect, FlareRequest, GhostParameters, GhostTable, Preset, StarburstParameters,
};
use crate::gpu::{BySize, Gpu, PassTimer, Target};
use crate::space::ImageWindow;

/// How the flare of a lens is made.
#[derive(Clone, Debug)]
pub struct FlareSettings {
    /// The iris.
    pub aperture: Aperture,
    /// How ghosts are made; none are drawn without.
    pub ghosts: Option<GhostParameters>,
    /// How the starburst is made.
    pub starburst: StarburstParameters,
    /// Ghosts made beforehand for the same lens and f-number.
    pub table: Option<Arc<GhostTable>>,
}

impl FlareSettings {
    /// All ghosts and the starburst, as a preset makes them.
    pub fn from_preset(preset: Preset, aperture: Aperture) -> Self {
        Self {
            aperture,
            ghosts: Some(preset.ghosts()),
            starburst: preset.starburst(),
            table: None,
        }
    }
}

/// The flare of the camera's lens.
pub(super) struct FlarePass {
    effect: FlareEffect,
    /// Of the whole image.
    whole: BySize<Target>,
    /// Of the window, where the image is drawn in several.
    window: Option<FlareWindow>,
    /// Whether the target shows something else than the effect.
    is_stale: bool,
    /// Whether the effect shows a flare.
    is_lit: bool,
}

/// Longest side of a flare, pixels; that of a larger image is enlarged.
const MAX_FLARE_PX: u32 = MAX_WINDOW_PX;

/// Pixels of the flare of an image.
fn flare_size(image: [u32; 2]) -> [u32; 2] {
    let longest = image[0].max(image[1]).max(1);
    if longest <= MAX_FLARE_PX {
        return image;
    }
    let part = f64::from(MAX_FLARE_PX) / f64::from(longest);
    image.map(|side| ((f64::from(side) * part).round() as u32).max(1))
}

/// Format of the flare's radiance.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

impl FlarePass {
    pub(super) fn new(gpu: &Gpu) -> Self {
        Self {
            effect: FlareEffect::new(gpu, FORMAT),
            whole: BySize::default(),
            window: None,
            is_stale: true,
            is_lit: false,
        }
    }

    /// For an image of `image` pixels.
    pub(super) fn resize(&mut self, gpu: &Gpu, image: [u32; 2]) {
        let size = flare_size(image);
        self.whole
            .select(size, || Target::new(gpu, "flare", size, FORMAT));
        self.window = None;
        self.is_stale = true;
    }

    /// Which part of an image of `image` pixels is drawn next.
    pub(super) fn show(&mut self, gpu: &Gpu, image: [u32; 2], window: &ImageWindow) {
        let Some(whole) = self.whole.current() else {
            return;
        };
        if *window == ImageWindow::whole(whole.size()) {
            self.window = None;
            return;
        }
        let known = self
            .window
            .take()
            .filter(|known| known.target().size() == window.size);
        let shown = known.unwrap_or_else(|| FlareWindow::new(gpu, whole, window.size));
        shown.show(gpu, window, [image, whole.size()]);
        self.window = Some(shown);
    }

    /// Part of the sun's light that its sharp image keeps, mean of the channels.
    pub(super) fn disc_fraction(&self) -> f64 {
        if self.is_lit {
            self.effect.disc_fraction().iter().sum::<f64>() / 3.0
        } else {
            1.0
        }
    }

    /// Whether the target shows a part of the flare, or enlarges it.
    pub(super) fn shows_part(&self) -> bool {
        self.window.is_some()
    }

    /// Radiance that the lens adds to what is drawn of the image.
    pub(super) fn target(&self) -> Option<&Target> {
        let window = self.window.as_ref().map(FlareWindow::target);
        window.or_else(|| self.whole.current())
    }

    /// Draws the flare where it changed; else a pass that draws nothing, so that it has its times.
    pub(super) fn encode(&mut self, encoder: &mut wgpu::CommandEncoder, timed: (&PassTimer, u32)) {
        let Some(target) = self.whole.current() else {
            return;
        };
        let is_drawn = self.is_stale && self.is_lit;
        let attachment = if self.is_stale {
            target.cleared(wgpu::Color::TRANSPARENT)
        } else {
            target.loaded()
        };
        let (timer, number) = timed;
        drop(encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("no flare"),
            color_attachments: &[attachment],
            timestamp_writes: if is_drawn { None } else { timer.pass(number) },
            ..Default::default()
        }));
        if is_drawn {
            self.effect.encode(encoder, target, Some(timed));
        }
        if let Some(window) = &self.window {
            window.encode(encoder);
        }
        self.is_stale = false;
    }
}

impl Renderer {
    /// Brings the flare up to date with the camera and the sun.
    pub(super) fn prepare_flare(&mut self, request: &FrameRequest<'_>) -> Result<(), RenderError> {
        let (Some(optics), Some(settings)) = (request.camera.lens(), request.flare) else {
            self.flare.is_stale |= self.flare.is_lit;
            self.flare.is_lit = false;
            return Ok(());
        };
        let light = request.camera.light_from(&self.sun_seen(request));
        let flare = FlareRequest {
            lens: Arc::clone(&optics.lens),
            f_number: optics.f_number,
            aperture: settings.aperture,
            ghosts: settings.ghosts,
            starburst: Some(settings.starburst),
            table: settings.table.clone(),
            light,
            image_half_mm: optics.image_half_mm(request.size),
        };
        let size = flare_size(request.size);
        self.flare.is_stale |= self.flare.effect.prepare(&self.gpu, &flare, size)?;
        // Also where it was only switched off for a while.
        self.flare.is_stale |= self.flare.is_lit != light.is_lit();
        self.flare.is_lit = light.is_lit();
        Ok(())
    }
}
