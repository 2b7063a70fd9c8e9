//! The window's surface, and the panel over the image on it.

use std::sync::Arc;

use egui_wgpu::{RendererOptions, ScreenDescriptor};
use winit::event::WindowEvent;
use winit::window::Window;

use crate::gpu::Gpu;

/// A window with egui.
pub struct Screen {
    /// The window.
    pub window: Arc<Window>,
    surface: wgpu::Surface<'static>,
    configuration: wgpu::SurfaceConfiguration,
    /// The panel's context.
    pub egui: egui::Context,
    input: egui_winit::State,
    painter: egui_wgpu::Renderer,
    /// The city's image in egui, and its pixels.
    image: Option<(egui::TextureId, [u32; 2])>,
}

impl Screen {
    /// For a window and its surface.
    pub fn new(
        gpu: &Gpu,
        window: Arc<Window>,
        surface: wgpu::Surface<'static>,
        configuration: wgpu::SurfaceConfiguration,
    ) -> Self {
        let egui = egui::Context::default();
        egui.set_theme(egui::Theme::Dark);
        let input = egui_winit::State::new(
            egui.clone(),
            egui::ViewportId::ROOT,
            &window,
            Some(window.scale_factor() as f32),
            None,
            Some(gpu.device.limits().max_texture_dimension_2d as usize),
        );
        let painter = egui_wgpu::Renderer::new(&gpu.device, configuration.format, RendererOptions::default());
        Self {
            window,
            surface,
            configuration,
            egui,
            input,
            painter,
            image: None,
        }
    }

    /// Pixels of the window.
    pub fn size(&self) -> [u32; 2] {
        [self.configuration.width, self.configuration.height]
    }

    /// The window has another size.
    pub fn resize(&mut self, gpu: &Gpu, size: [u32; 2]) {
        if size.contains(&0) {
            return;
        }
        [self.configuration.width, self.configuration.height] = size;
        self.surface.configure(&gpu.device, &self.configuration);
    }

    /// Hands an event to the panel; true when the panel took it.
    pub fn on_event(&mut self, event: &WindowEvent) -> bool {
        self.input.on_window_event(&self.window, event).consumed
    }

    /// Shows an image of `image_size` pixels over the whole window, with a panel on it.
    pub fn draw(
        &mut self,
        gpu: &Gpu,
        image: &wgpu::TextureView,
        image_size: [u32; 2],
        panel: impl FnMut(&egui::Context),
    ) {
        let image = self.image_id(gpu, image, image_size);
        let output = self.run(image, panel);
        self.input
            .handle_platform_output(&self.window, output.platform_output);
        let pixels_per_point = output.pixels_per_point;
        let primitives = self.egui.tessellate(output.shapes, pixels_per_point);
        let descriptor = ScreenDescriptor {
            size_in_pixels: self.size(),
            pixels_per_point,
        };
        for (id, deltas) in &output.textures_delta.set {
            for delta in deltas {
                self.painter.update_texture(&gpu.device, &gpu.queue, *id, delta);
            }
        }
        let surface = match self.surface.get_current_texture() {
            wgpu::CurrentSurfaceTexture::Success(texture)
            | wgpu::CurrentSurfaceTexture::Suboptimal(texture) => texture,
            _ => {
                self.surface.configure(&gpu.device, &self.configuration);
                self.window.request_redraw();
                return;
            }
        };
        let view = surface
            .texture
            .create_view(&wgpu::TextureViewDescriptor::default());
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let buffers =
            self.painter
                .update_buffers(&gpu.device, &gpu.queue, &mut encoder, &primitives, &descriptor);
        {
            let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("screen"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                ..Default::default()
            });
            self.painter
                .render(&mut pass.forget_lifetime(), &primitives, &descriptor);
        }
        gpu.queue.submit(buffers.into_iter().chain([encoder.finish()]));
        self.window.pre_present_notify();
        gpu.queue.present(surface);
        for id in &output.textures_delta.free {
            self.painter.free_texture(id);
        }
    }

    /// The image in egui: bound anew when it was made anew, as it is for another size.
    fn image_id(&mut self, gpu: &Gpu, view: &wgpu::TextureView, size: [u32; 2]) -> egui::TextureId {
        match &mut self.image {
            Some((id, known)) => {
                if *known != size {
                    let filter = wgpu::FilterMode::Linear;
                    self.painter
                        .update_egui_texture_from_wgpu_texture(&gpu.device, view, filter, *id);
                    *known = size;
                }
                *id
            }
            None => {
                let filter = wgpu::FilterMode::Linear;
                let id = self.painter.register_native_texture(&gpu.device, view, filter);
                self.image = Some((id, size));
                id
            }
        }
    }

    fn run(&mut self, image: egui::TextureId, mut panel: impl FnMut(&egui::Context)) -> egui::FullOutput {
        let input = self.input.take_egui_input(&self.window);
        let whole = egui::Rect::from_min_max(egui::pos2(0.0, 0.0), egui::pos2(1.0, 1.0));
        self.egui.clone().run_ui(input, |ui| {
            let context = ui.ctx().clone();
            let screen = context.viewport_rect();
            context.layer_painter(egui::LayerId::background()).image(
                image,
                screen,
                whole,
                egui::Color32::WHITE,
            );
            panel(&context);
        })
    }
}
