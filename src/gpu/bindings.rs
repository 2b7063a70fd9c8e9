//! The one binding idiom of all passes: a layout is a list of binding types numbered from 0, a group a list of resources in
//! the same order. Both are made once; encoding a frame makes none.

use super::Gpu;

/// f32 texels, read by `textureLoad`.
pub const FLOAT: wgpu::TextureSampleType = wgpu::TextureSampleType::Float { filterable: false };
/// f32 texels, read through a sampler.
pub const FILTERED: wgpu::TextureSampleType = wgpu::TextureSampleType::Float { filterable: true };
/// A linear sampler.
pub const SAMPLER: wgpu::BindingType = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
/// A read-only storage buffer.
pub const RECORDS: wgpu::BindingType = storage(true);
/// A storage buffer that a compute shader writes.
pub const OUTPUT: wgpu::BindingType = storage(false);
/// A uniform buffer.
pub const UNIFORM: wgpu::BindingType = wgpu::BindingType::Buffer {
    ty: wgpu::BufferBindingType::Uniform,
    has_dynamic_offset: false,
    min_binding_size: None,
};

const fn storage(read_only: bool) -> wgpu::BindingType {
    wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Storage { read_only },
        has_dynamic_offset: false,
        min_binding_size: None,
    }
}

/// A 2D texture.
pub const fn texture(sample_type: wgpu::TextureSampleType) -> wgpu::BindingType {
    wgpu::BindingType::Texture {
        sample_type,
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    }
}

/// A 3D texture.
pub const fn texture_volume(sample_type: wgpu::TextureSampleType) -> wgpu::BindingType {
    wgpu::BindingType::Texture {
        sample_type,
        view_dimension: wgpu::TextureViewDimension::D3,
        multisampled: false,
    }
}

/// A 2D array texture.
pub const fn texture_array(sample_type: wgpu::TextureSampleType) -> wgpu::BindingType {
    wgpu::BindingType::Texture {
        sample_type,
        view_dimension: wgpu::TextureViewDimension::D2Array,
        multisampled: false,
    }
}

impl Gpu {
    /// A layout of bindings numbered from 0. Vertex and fragment stages see it, or the compute stage where one is written.
    pub fn layout(&self, label: &str, types: &[wgpu::BindingType]) -> wgpu::BindGroupLayout {
        let visibility = if types.contains(&OUTPUT) {
            wgpu::ShaderStages::COMPUTE
        } else {
            wgpu::ShaderStages::VERTEX_FRAGMENT
        };
        let entries: Vec<_> = (0..)
            .zip(types)
            .map(|(binding, &ty)| wgpu::BindGroupLayoutEntry {
                binding,
                visibility,
                ty,
                count: None,
            })
            .collect();
        self.count_creation();
        self.device
            .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some(label),
                entries: &entries,
            })
    }

    /// A group of resources numbered from 0.
    pub fn group(
        &self,
        label: &str,
        layout: &wgpu::BindGroupLayout,
        resources: &[wgpu::BindingResource<'_>],
    ) -> wgpu::BindGroup {
        let entries: Vec<_> = (0..)
            .zip(resources)
            .map(|(binding, resource)| wgpu::BindGroupEntry {
                binding,
                resource: resource.clone(),
            })
            .collect();
        self.count_creation();
        self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(label),
            layout,
            entries: &entries,
        })
    }

    /// A sampler between texels and levels of images that repeat.
    pub fn tiling_sampler(&self, label: &str) -> wgpu::Sampler {
        self.count_creation();
        self.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some(label),
            address_mode_u: wgpu::AddressMode::Repeat,
            address_mode_v: wgpu::AddressMode::Repeat,
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..Default::default()
        })
    }

    /// A sampler between texels and, with `mips`, between levels.
    pub fn linear_sampler(&self, label: &str, mips: bool) -> wgpu::Sampler {
        self.count_creation();
        self.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some(label),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: if mips {
                wgpu::MipmapFilterMode::Linear
            } else {
                wgpu::MipmapFilterMode::Nearest
            },
            ..Default::default()
        })
    }
}
