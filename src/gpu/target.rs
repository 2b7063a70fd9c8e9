//! Textures that passes draw into.

use super::Gpu;

/// A render target that later passes can read.
pub struct Target {
    /// The texture.
    pub texture: wgpu::Texture,
    /// Its only view.
    pub view: wgpu::TextureView,
}

impl Target {
    /// A target of `size` pixels.
    pub fn new(gpu: &Gpu, label: &str, size: [u32; 2], format: wgpu::TextureFormat) -> Self {
        Self::with_views(gpu, label, size, format, &[])
    }

    /// The same, whose texels can also be viewed in other formats.
    pub fn with_views(
        gpu: &Gpu,
        label: &str,
        size: [u32; 2],
        format: wgpu::TextureFormat,
        view_formats: &[wgpu::TextureFormat],
    ) -> Self {
        gpu.count_creation();
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d {
                width: size[0],
                height: size[1],
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                | wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::COPY_SRC,
            view_formats,
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        Self { texture, view }
    }

    /// The attachment that clears this target to `value` first.
    pub fn cleared(&self, value: wgpu::Color) -> Option<wgpu::RenderPassColorAttachment<'_>> {
        Some(wgpu::RenderPassColorAttachment {
            view: &self.view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(value),
                store: wgpu::StoreOp::Store,
            },
        })
    }

    /// The attachment that draws over what this target holds.
    pub fn loaded(&self) -> Option<wgpu::RenderPassColorAttachment<'_>> {
        Some(wgpu::RenderPassColorAttachment {
            view: &self.view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Load,
                store: wgpu::StoreOp::Store,
            },
        })
    }

    /// Its size, pixels.
    pub fn size(&self) -> [u32; 2] {
        let size = self.texture.size();
        [size.width, size.height]
    }

    /// Gives a pass onto this target its usual viewport back.
    pub fn show_whole(&self, pass: &mut wgpu::RenderPass<'_>) {
        let [width, height] = self.size().map(|side| side as f32);
        pass.set_viewport(0.0, 0.0, width, height, 0.0, 1.0);
    }

    /// The first of several attachments clears, the others draw over; `is_begun` remembers.
    pub fn begun(&self, is_begun: &mut bool) -> Option<wgpu::RenderPassColorAttachment<'_>> {
        if std::mem::replace(is_begun, true) {
            self.loaded()
        } else {
            self.cleared(wgpu::Color::TRANSPARENT)
        }
    }

    /// For a bind group.
    pub fn binding(&self) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::TextureView(&self.view)
    }

    /// The depth attachment, cleared to the far end of reversed depth.
    pub fn cleared_depth(&self) -> Option<wgpu::RenderPassDepthStencilAttachment<'_>> {
        Some(wgpu::RenderPassDepthStencilAttachment {
            view: &self.view,
            depth_ops: Some(wgpu::Operations {
                load: wgpu::LoadOp::Clear(0.0),
                store: wgpu::StoreOp::Store,
            }),
            stencil_ops: None,
        })
    }
}

/// A colour target state that blends what is drawn, its alpha multiplied in, over what is there.
pub fn blended_target(format: wgpu::TextureFormat) -> Option<wgpu::ColorTargetState> {
    Some(wgpu::ColorTargetState {
        format,
        blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
        write_mask: wgpu::ColorWrites::ALL,
    })
}

/// A colour target state without blending.
pub fn color_target(format: wgpu::TextureFormat) -> Option<wgpu::ColorTargetState> {
    Some(wgpu::ColorTargetState {
        format,
        blend: None,
        write_mask: wgpu::ColorWrites::ALL,
    })
}
