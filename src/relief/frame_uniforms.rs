//! One frame's uniforms; layout of `Frame` in `shaders/lib/frame.wgsl` (a test compares the two).

use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Mat4, Vec4};

use super::GridPosition;
use super::light_pass::LightPass;
use super::relief_view::ReliefView;
use super::search_parameters::SearchParameters;
use crate::buildings::Pyramid;
use crate::scene::Resident;

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
    pub sun_irradiance: Vec4,
    pub search: SearchParameters,
    pub sun_grid: Vec4,
    pub sun_axes: Vec4,
    pub street_grid: Vec4,
    pub sky_light: [Vec4; 9],
    pub wall_light: Vec4,
    pub sunny_wall_light: Vec4,
    pub eye_in_tile: [f32; 2],
    pub eye_elevation: f32,
    pub tile_m: f32,
    pub eye_tile: [i32; 2],
    pub grid: [i32; 2],
    pub size: [f32; 2],
    pub jitter: [f32; 2],
    pub texel_m: f32,
    pub tile_texels_log2: u32,
    pub max_roof: f32,
    pub min_ground: f32,
    pub terrain_step_m: f32,
    pub terrain_side: u32,
    pub sample: u32,
    pub pixel_angle: f32,
    pub imagery_side: f32,
    pub pyramid_nodes: u32,
    pub max_ground: f32,
    pub mesh_parts: u32,
    pub hidden: u32,
    pub sun_levels: u32,
    pub street_layer: u32,
    pub padding_3: u32,
}

impl FrameUniforms {
    /// Uniforms of one sample of one view. All differences of large coordinates are taken in f64 here.
    pub fn new(resident: &Resident, view: &ReliefView<'_>, light: &LightPass) -> Self {
        let ReliefView {
            projection,
            sun,
            disc_fraction,
            sample,
            settings,
            ..
        } = *view;
        let grid = &resident.tiles.grid;
        let pose = &projection.pose;
        let eye = GridPosition::new(grid, pose.eye);
        let [forward, across, upward] = projection.window_rays();
        let pixel_angle = 2.0 * projection.tan_half_fov().y / f64::from(projection.size[1]);
        let sky = &light.sky;
        let [wall_light, sunny_wall_light] = sky.wall_light();
        let ([sun_grid, sun_axes], sun_levels) = light.sun_bounds.uniforms(pose.eye.truncate());
        let (street_grid, street_layer) = light.streets.uniforms(pose.eye.truncate());
        let vector = |v: DVec3, w: f64| v.as_vec3().extend(w as f32);
        Self {
            clip_from_eye_relative: projection.clip_from_eye_relative(),
            forward: vector(forward, 0.0),
            across: vector(across, 0.0),
            upward: vector(upward, 0.0),
            sun: vector(sun.to_sun, sun.angular_radius),
            sun_irradiance: vector(sun.irradiance, disc_fraction),
            search: settings.search,
            sun_grid,
            sun_axes,
            street_grid,
            sky_light: sky.coefficients(),
            wall_light: vector(wall_light, f64::from(u8::from(resident.has_orthophotos))),
            sunny_wall_light: vector(sunny_wall_light, 0.0),
            eye_in_tile: eye.in_tile.to_array(),
            eye_elevation: eye.elevation,
            tile_m: grid.tile_m as f32,
            eye_tile: eye.tile.to_array(),
            grid: [grid.columns as i32, grid.rows as i32],
            size: projection.window.size.map(|count| count as f32),
            jitter: projection.jitter.as_vec2().to_array(),
            texel_m: resident.texel_m as f32,
            tile_texels_log2: resident.tile_texels.ilog2(),
            max_roof: resident.tiles.bounds.max_roof - eye.elevation,
            min_ground: resident.tiles.bounds.min_ground - eye.elevation,
            terrain_step_m: resident.terrain_step_m as f32,
            terrain_side: resident.terrain_side,
            sample,
            pixel_angle: pixel_angle as f32,
            imagery_side: resident.imagery.side as f32,
            pyramid_nodes: Pyramid::node_count(resident.tile_texels as usize) as u32,
            max_ground: resident.tiles.bounds.max_ground - eye.elevation,
            mesh_parts: resident.mesh_parts,
            hidden: settings.layers.hidden(),
            sun_levels,
            street_layer,
            padding_3: 0,
        }
    }
}
