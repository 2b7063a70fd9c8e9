//! One frame's uniforms; layout of `Frame` in `shaders/lib/frame.wgsl` (a test compares the two).

use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Mat4, Vec4};

use crate::buildings::Pyramid;
use crate::scene::Resident;
use crate::space::{Projection, View};

/// What lights the scene.
#[derive(Clone, Copy, Debug)]
pub struct Light {
    /// Unit vector towards the sun.
    pub to_sun: DVec3,
}

/// See `shaders/lib/frame.wgsl`, where each field is explained.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
#[allow(missing_docs)]
pub struct FrameUniforms {
    pub clip_from_eye_relative: Mat4,
    pub forward: Vec4,
    pub across: Vec4,
    pub upward: Vec4,
    pub sun: Vec4,
    pub eye_in_tile: [f32; 2],
    pub eye_elevation: f32,
    pub tile_m: f32,
    pub eye_tile: [i32; 2],
    pub grid: [i32; 2],
    pub size: [f32; 2],
    pub jitter: [f32; 2],
    pub texel_m: f32,
    pub top_level: u32,
    pub highest_roof: f32,
    pub lowest_ground: f32,
    pub terrain_step_m: f32,
    pub terrain_side: u32,
    pub sample: u32,
    pub pixel_angle: f32,
    pub imagery_side: f32,
    pub pyramid_width: u32,
    pub more_padding: [u32; 2],
}

impl FrameUniforms {
    /// Uniforms of one sample of one view. All differences of large coordinates are taken in f64 here.
    pub fn new(
        resident: &Resident,
        view: &View,
        projection: &Projection,
        light: &Light,
        sample: u32,
    ) -> Self {
        let grid = &resident.grid;
        let place = grid.position(view.eye.truncate());
        let eye_tile = place.floor();
        let eye_in_tile = (place - eye_tile) * grid.tile_m;
        let tan = projection.tan_half_fov_y;
        let [width, height] = projection.size.map(f64::from);
        let vector = |v: DVec3| v.as_vec3().extend(0.0);
        Self {
            clip_from_eye_relative: projection.clip_from_eye_relative(),
            forward: vector(projection.forward),
            across: vector(projection.right * (tan * width / height)),
            upward: vector(projection.up * tan),
            sun: light.to_sun.as_vec3().extend(1.0),
            eye_in_tile: eye_in_tile.as_vec2().to_array(),
            eye_elevation: view.eye.z as f32,
            tile_m: grid.tile_m as f32,
            eye_tile: [eye_tile.x as i32, eye_tile.y as i32],
            grid: [grid.columns as i32, grid.rows as i32],
            size: projection.size.map(|count| count as f32),
            jitter: projection.jitter.as_vec2().to_array(),
            texel_m: resident.texel_m as f32,
            top_level: resident.tile_texels.ilog2(),
            highest_roof: resident.highest_roof - view.eye.z as f32,
            lowest_ground: resident.lowest_ground - view.eye.z as f32,
            terrain_step_m: resident.terrain_step_m as f32,
            terrain_side: resident.terrain_side,
            sample,
            pixel_angle: (2.0 * tan / height) as f32,
            imagery_side: resident.imagery_side as f32,
            pyramid_width: Pyramid::image_size(resident.tile_texels as usize)[0] as u32,
            more_padding: [0; 2],
        }
    }
}
