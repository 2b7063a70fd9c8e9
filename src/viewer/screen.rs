//! The window's surface: the city's image, and the panel over it.

use std::sync::Arc;

use winit::window::Window;

use super::blit::Blit;
use super::overlay::Overlay;
use crate::gpu::{Gpu, color_target};

/// Where no image is shown.
const GROUND: wgpu::Color = wgpu::Color {
    r: 0.05,
    g: 0.07,
    b: 0.10,
    a: 1.0,
};

/// A window and what is shown on it.
pub struct Screen {
    /// The window.
    pub window: Arc<Window>,
    /// The panel.
    pub overlay: Overlay,
    surface: wgpu::Surface<'static>,
    configuration: wgpu::SurfaceConfiguration,
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
        Self {
            overlay: Overlay::new(gpu, &window, configuration.format),
            blit: Blit::new(gpu, color_target(configuration.format)),
            window,
            surface,
            configuration,
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

    /// Shows an image over the whole window, and the panel over it; without an image a plain ground.
    pub fn draw(&mut self, gpu: &Gpu, image: Option<&wgpu::TextureView>) {
        let size = self.size();
        if let Some(image) = image {
            self.blit.bind(gpu, image, size);
        }
        self.overlay.bind(gpu, size);
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
        {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("screen"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(GROUND),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                ..Default::default()
            });
            if image.is_some() {
                self.blit.draw(&mut pass);
            }
            self.overlay.draw(&mut pass);
        }
        gpu.queue.submit([encoder.finish()]);
        self.window.pre_present_notify();
        gpu.queue.present(surface);
    }

    /// Whether the surface encodes what is drawn on it.
    pub fn is_srgb(&self) -> bool {
        self.configuration.format.is_srgb()
    }
}
