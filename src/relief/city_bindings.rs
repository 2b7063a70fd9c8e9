//! Group 1 of the relief's shaders: the resident city (`shaders/lib/building_map.wgsl`, `shaders/lib/terrain.wgsl`).

use wgpu::TextureSampleType::{Sint, Uint};

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
    pub const TYPES: [wgpu::BindingType; 10] = [
        texture(Sint),
        RECORDS,
        texture_array(Uint),
        texture_array(Uint),
        RECORDS,
        RECORDS,
        RECORDS,
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
        let (maps, ground) = (&resident.maps, &resident.ground);
        let resources = [
            TextureView(&resident.tile_table),
            maps.slots.as_entire_binding(),
            TextureView(&maps.cells.view),
            TextureView(&maps.pyramid.view),
            maps.vertices.as_entire_binding(),
            maps.lists.as_entire_binding(),
            maps.along_outline.as_entire_binding(),
            ground.records.as_entire_binding(),
            TextureView(&ground.heights.view),
            TextureView(&ground.bounds.view),
        ];
        gpu.group("city", layout, &resources)
    }
}
