//! Group 1 of the shaders that walk the building map (`shaders/lib/building_map.wgsl`).

use crate::gpu::Gpu;
use crate::scene::Resident;

/// The group and its layout.
pub struct MapBindings {
    /// Layout.
    pub layout: wgpu::BindGroupLayout,
    /// Group.
    pub group: wgpu::BindGroup,
}

/// A layout entry for the vertex and fragment stages.
pub fn entry(binding: u32, ty: wgpu::BindingType) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
        ty,
        count: None,
    }
}

/// A texture that is read by `textureLoad`.
pub fn texture(sample_type: wgpu::TextureSampleType, array: bool) -> wgpu::BindingType {
    wgpu::BindingType::Texture {
        sample_type,
        view_dimension: if array {
            wgpu::TextureViewDimension::D2Array
        } else {
            wgpu::TextureViewDimension::D2
        },
        multisampled: false,
    }
}

/// f32 texels, unfiltered.
pub const FLOAT: wgpu::TextureSampleType = wgpu::TextureSampleType::Float { filterable: false };
/// A read-only storage buffer.
pub const RECORDS: wgpu::BindingType = wgpu::BindingType::Buffer {
    ty: wgpu::BufferBindingType::Storage { read_only: true },
    has_dynamic_offset: false,
    min_binding_size: None,
};
/// A uniform buffer.
pub const UNIFORM: wgpu::BindingType = wgpu::BindingType::Buffer {
    ty: wgpu::BufferBindingType::Uniform,
    has_dynamic_offset: false,
    min_binding_size: None,
};

/// A layout of entries numbered from 0.
pub fn layout_of(gpu: &Gpu, label: &str, types: &[wgpu::BindingType]) -> wgpu::BindGroupLayout {
    let entries: Vec<_> = (0..)
        .zip(types)
        .map(|(binding, &ty)| entry(binding, ty))
        .collect();
    gpu.device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some(label),
            entries: &entries,
        })
}

/// A group of resources numbered from 0.
pub fn group_of(
    gpu: &Gpu,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    resources: Vec<wgpu::BindingResource<'_>>,
) -> wgpu::BindGroup {
    let entries: Vec<_> = (0..)
        .zip(resources)
        .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
        .collect();
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some(label),
        layout,
        entries: &entries,
    })
}

impl MapBindings {
    /// Binds a resident city's building map.
    pub fn new(gpu: &Gpu, resident: &Resident) -> Self {
        use wgpu::BindingResource::TextureView;
        let layout = layout_of(
            gpu,
            "building map",
            &[
                texture(wgpu::TextureSampleType::Sint, false),
                RECORDS,
                texture(wgpu::TextureSampleType::Uint, true),
                texture(wgpu::TextureSampleType::Uint, true),
                RECORDS,
                RECORDS,
                RECORDS,
            ],
        );
        let group = group_of(
            gpu,
            "building map",
            &layout,
            vec![
                TextureView(&resident.tile_table),
                resident.slot_buffer.as_entire_binding(),
                TextureView(&resident.cells.view),
                TextureView(&resident.pyramid.view),
                resident.corners.as_entire_binding(),
                resident.lists.as_entire_binding(),
                resident.along_outline.as_entire_binding(),
            ],
        );
        Self { layout, group }
    }
}
