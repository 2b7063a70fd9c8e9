//! Group 1 of the relief's shaders: the resident city (`shaders/lib/building_map.wgsl`, `shaders/lib/terrain.wgsl`).

use wgpu::TextureSampleType::Uint;

use crate::gpu::{FLOAT, Gpu, RECORDS, texture, texture_array};
use crate::scene::Resident;

/// The group and its layout.
pub struct CityBindings {
    /// Layout.
    pub layout: wgpu::BindGroupLayout,
    /// Group.
    pub group: wgpu::BindGroup,
}

impl CityBindings {
    /// What the shaders declare, in order.
    pub const TYPES: [wgpu::BindingType; 6] = [
        texture(Uint),
        texture(Uint),
        texture(Uint),
        RECORDS,
        texture_array(FLOAT),
        texture_array(FLOAT),
    ];

    /// Binds a resident city.
    pub fn new(gpu: &Gpu, resident: &Resident) -> Self {
        let layout = gpu.layout("city", &Self::TYPES);
        Self {
            group: Self::group(gpu, &layout, resident),
            layout,
        }
    }

    /// Binds it again, as parts of it were made anew.
    pub fn bind(&mut self, gpu: &Gpu, resident: &Resident) {
        self.group = Self::group(gpu, &self.layout, resident);
    }

    fn group(gpu: &Gpu, layout: &wgpu::BindGroupLayout, resident: &Resident) -> wgpu::BindGroup {
        use wgpu::BindingResource::TextureView;
        let (maps, terrain) = (&resident.maps, &resident.terrain);
        let resources = [
            TextureView(&resident.tile_table.view),
            TextureView(&maps.words.view),
            TextureView(&maps.quads.view),
            terrain.records.buffer.as_entire_binding(),
            TextureView(&terrain.heights.view),
            TextureView(&terrain.bounds.view),
        ];
        gpu.group("city", layout, &resources)
    }
}
