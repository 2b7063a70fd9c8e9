//! The panel as an image of its own, painted anew when it may have changed and laid over the city's.

use std::time::{Duration, Instant};

use egui_wgpu::{RendererOptions, ScreenDescriptor};
use winit::event::WindowEvent;
use winit::window::Window;

use super::blit::Blit;
use crate::gpu::{Gpu, Target, blended_target};

/// The user interface, and its image.
pub struct Overlay {
    /// The user interface's context.
    pub egui: egui::Context,
    input: egui_winit::State,
    painter: egui_wgpu::Renderer,
    format: wgpu::TextureFormat,
    image: Option<Target>,
    blit: Blit,
    /// Pixels of the image that hold something: position and size.
    painted: Option<[u32; 4]>,
    last_painted: Option<Instant>,
    /// Whether the user interface is in the middle of an animation.
    is_animated: bool,
    /// Whether painting is so fast that every frame can have it: it is where pixels do not cost the processor's time.
    is_cheap: bool,
}

/// While the camera moves the panels are painted so often: where they tell of times, and where they do not.
const LIVE_INTERVAL: Duration = Duration::from_millis(250);
const INTERVAL: Duration = Duration::from_millis(1000);

impl Overlay {
    /// For a window and its surface's format.
    pub fn new(gpu: &Gpu, window: &Window, format: wgpu::TextureFormat) -> Self {
        let egui = egui::Context::default();
        egui.set_theme(egui::Theme::Dark);
        let input = egui_winit::State::new(
            egui.clone(),
            egui::ViewportId::ROOT,
            window,
            Some(window.scale_factor() as f32),
            None,
            Some(gpu.device.limits().max_texture_dimension_2d as usize),
        );
        let options = RendererOptions {
            dithering: false,
            ..RendererOptions::default()
        };
        Self {
            egui,
            input,
            painter: egui_wgpu::Renderer::new(&gpu.device, format, options),
            format,
            image: None,
            blit: Blit::new(gpu, blended_target(format)),
            painted: None,
            last_painted: None,
            is_animated: false,
            is_cheap: !gpu.is_software,
        }
    }

    /// Hands an event to the user interface; true when it took it.
    pub fn on_event(&mut self, window: &Window, event: &WindowEvent) -> bool {
        self.input.on_window_event(window, event).consumed
    }

    /// Whether the user interface wants to be painted even if nothing happens.
    pub fn is_animated(&self) -> bool {
        self.is_animated
    }

    /// Whether the pointer or the keyboard is in the user interface.
    pub fn is_used(&self) -> bool {
        self.egui.egui_wants_pointer_input() || self.egui.egui_wants_keyboard_input()
    }

    /// Whether the image may be out of date; while the camera moves that must be worth its time.
    /// `is_live`: it tells of times.
    pub fn is_due(&self, size: [u32; 2], is_moving: bool, is_live: bool) -> bool {
        let interval = if is_live { LIVE_INTERVAL } else { INTERVAL };
        let is_recent = self.last_painted.is_some_and(|last| last.elapsed() < interval);
        let is_sized = self.image.as_ref().is_some_and(|image| {
            let known = image.texture.size();
            [known.width, known.height] == size
        });
        !(is_moving && is_recent && is_sized) || self.is_used() || self.is_cheap()
    }

    /// Whether every frame can have it.
    pub fn is_cheap(&self) -> bool {
        self.is_cheap
    }

    /// Runs the user interface and paints its image of `size` pixels.
    pub fn paint(
        &mut self,
        gpu: &Gpu,
        window: &Window,
        size: [u32; 2],
        mut panel: impl FnMut(&egui::Context),
    ) {
        let input = self.input.take_egui_input(window);
        let output = self.egui.clone().run_ui(input, |ui| panel(&ui.ctx().clone()));
        self.input.handle_platform_output(window, output.platform_output);
        self.is_animated = output
            .viewport_output
            .values()
            .any(|viewport| viewport.repaint_delay.is_zero());
        let descriptor = ScreenDescriptor {
            size_in_pixels: size,
            pixels_per_point: output.pixels_per_point,
        };
        let primitives = self.egui.tessellate(output.shapes, descriptor.pixels_per_point);
        for (id, deltas) in &output.textures_delta.set {
            for delta in deltas {
                self.painter.update_texture(&gpu.device, &gpu.queue, *id, delta);
            }
        }
        self.image.take_if(|image| {
            let known = image.texture.size();
            [known.width, known.height] != size
        });
        let image = self
            .image
            .get_or_insert_with(|| Target::new(gpu, "panel", size, self.format));
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let buffers =
            self.painter
                .update_buffers(&gpu.device, &gpu.queue, &mut encoder, &primitives, &descriptor);
        {
            let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("panel"),
                color_attachments: &[image.cleared(wgpu::Color::TRANSPARENT)],
                ..Default::default()
            });
            self.painter
                .render(&mut pass.forget_lifetime(), &primitives, &descriptor);
        }
        gpu.queue.submit(buffers.into_iter().chain([encoder.finish()]));
        for id in &output.textures_delta.free {
            self.painter.free_texture(id);
        }
        self.painted = painted_pixels(&primitives, &descriptor);
        self.last_painted = Some(Instant::now());
    }

    /// Binds the image for a window of `window` pixels.
    pub fn bind(&mut self, gpu: &Gpu, window: [u32; 2]) {
        if let Some(image) = &self.image {
            self.blit.bind(gpu, &image.view, window);
        }
    }

    /// Draws the image over what is there.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        let Some([x, y, width, height]) = self.painted else {
            return;
        };
        pass.set_scissor_rect(x, y, width, height);
        self.blit.draw(pass);
    }
}

/// The pixels that primitives may cover: position and size; none when they cover none.
fn painted_pixels(primitives: &[egui::ClippedPrimitive], screen: &ScreenDescriptor) -> Option<[u32; 4]> {
    let mut bounds = egui::Rect::NOTHING;
    for clipped in primitives {
        let extent = match &clipped.primitive {
            egui::epaint::Primitive::Mesh(mesh) => mesh.calc_bounds(),
            egui::epaint::Primitive::Callback(callback) => callback.rect,
        };
        let seen = extent.intersect(clipped.clip_rect);
        if seen.is_positive() {
            bounds |= seen;
        }
    }
    let [width, height] = screen.size_in_pixels;
    let pixel = |at: f32, count: u32| (at * screen.pixels_per_point).clamp(0.0, count as f32);
    let [x, right] = [
        pixel(bounds.min.x, width).floor() as u32,
        pixel(bounds.max.x, width).ceil() as u32,
    ];
    let [y, bottom] = [
        pixel(bounds.min.y, height).floor() as u32,
        pixel(bounds.max.y, height).ceil() as u32,
    ];
    (bounds.is_positive() && right > x && bottom > y).then(|| [x, y, right - x, bottom - y])
}
