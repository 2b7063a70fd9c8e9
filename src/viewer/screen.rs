//! The window's surface, and the panel over the image on it.

use std::sync::Arc;

use egui_wgpu::{RendererOptions, ScreenDescriptor};
use winit::event::WindowEvent;
use winit::window::Window;

use super::blit::Blit;
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
    blit: Blit,
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
        let options = RendererOptions {
            dithering: false,
            ..RendererOptions::default()
        };
        let painter = egui_wgpu::Renderer::new(&gpu.device, configuration.format, options);
        let blit = Blit::new(gpu, configuration.format);
        Self {
            window,
            surface,
            configuration,
            egui,
            input,
            painter,
            blit,
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
        self.blit.bind(gpu, image, image_size, self.size());
        let output = self.run(panel);
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
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
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
            self.blit.draw(&mut pass);
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

    fn run(&mut self, mut panel: impl FnMut(&egui::Context)) -> egui::FullOutput {
        let input = self.input.take_egui_input(&self.window);
        self.egui.clone().run_ui(input, |ui| panel(&ui.ctx().clone()))
    }

    /// Whether the surface encodes what is drawn on it.
    pub fn is_srgb(&self) -> bool {
        self.configuration.format.is_srgb()
    }
}
