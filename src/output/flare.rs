//! Pictures of a lens's flare alone.

use super::RenderError;
use crate::camera::Ghost;
use crate::camera::flare::{
    Aperture, FlareMode, FlarePass, FlareSource, FlareTable, FlareVertex, flare_mesh,
};
use crate::camera::lens::Lens;
use crate::gpu::{Gpu, PassTimer, Target, read_texture};

/// A flare in memory.
pub struct FlarePicture {
    /// Linear radiance, RGB, rows from the top.
    pub radiance: Vec<[f32; 3]>,
    /// Triangles drawn.
    pub triangles: usize,
    /// Area of all triangles that lies on the film's plane, square millimetres: the raster work, the film's edge apart.
    pub area_mm2: f64,
    /// GPU milliseconds, where the device can time.
    pub gpu_ms: Option<f64>,
    /// Milliseconds to make the triangles on the CPU.
    pub mesh_ms: f64,
}

/// Draws a flare on the lens's film, its width over the picture's width.
pub fn flare_picture(
    gpu: &Gpu,
    lens: &Lens,
    source: &FlareSource,
    mode: FlareMode,
    only: Option<Ghost>,
    table: Option<&FlareTable>,
    aperture: &Aperture,
    size: [u32; 2],
) -> Result<FlarePicture, RenderError> {
    const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
    let start = std::time::Instant::now();
    let vertices = flare_mesh(lens, source, mode, only, table);
    let mesh_ms = start.elapsed().as_secs_f64() * 1e3;
    let target = Target::new(gpu, "flare", size, FORMAT);
    let pass = FlarePass::new(gpu, FORMAT, aperture);
    let timer = PassTimer::new(gpu, 1);
    let half_width = 0.5 * lens.film_mm[0];
    let half_mm = [half_width, half_width * f64::from(size[1]) / f64::from(size[0])];
    // A buffer holds so many at a time.
    let most = (gpu.device.limits().max_buffer_size / 36).min(3_000_000) as usize / 3 * 3;
    let mut chunks = vertices.chunks(most).peekable();
    let mut gpu_ms = Some(0.0);
    loop {
        let chunk = chunks.next().unwrap_or_default();
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        pass.encode(gpu, &mut encoder, &target, chunk, half_mm, 1.0, timer.of_pass(0));
        timer.resolve(&mut encoder);
        gpu.queue.submit([encoder.finish()]);
        gpu.wait()?;
        let spent = timer.milliseconds(gpu)?.map(|spans| spans[0]);
        gpu_ms = gpu_ms.zip(spent).map(|(before, more)| before + more);
        if chunks.peek().is_none() {
            break;
        }
    }
    let halves = read_texture::<[half::f16; 4]>(gpu, &target.texture)?;
    Ok(FlarePicture {
        radiance: halves
            .iter()
            .map(|texel| [texel[0], texel[1], texel[2]].map(half::f16::to_f32))
            .collect(),
        triangles: vertices.len() / 3,
        area_mm2: vertices.chunks_exact(3).map(triangle_area).sum(),
        gpu_ms,
        mesh_ms,
    })
}

fn triangle_area(corners: &[FlareVertex]) -> f64 {
    let [a, b, c] = [0, 1, 2].map(|k: usize| glam::Vec2::from_array(corners[k].sensor_mm).as_dvec2());
    0.5 * (b - a).perp_dot(c - a).abs()
}

/// Factor that brings all but the brightest 0.5 % of the lit pixels below the display's white.
pub fn auto_exposure(radiance: &[[f32; 3]]) -> f32 {
    let mut lit: Vec<f32> = radiance
        .iter()
        .map(|rgb| rgb.iter().fold(0.0_f32, |most, &value| most.max(value)))
        .filter(|&value| value > 0.0)
        .collect();
    if lit.is_empty() {
        return 1.0;
    }
    lit.sort_by(f32::total_cmp);
    0.9 / lit[(lit.len() - 1) * 995 / 1000].max(f32::MIN_POSITIVE)
}

/// 8-bit sRGB of linear radiance times an exposure; what is brighter than white is white.
pub fn developed(radiance: &[[f32; 3]], exposure: f32) -> Vec<u8> {
    let srgb = |linear: f32| {
        let value = (linear * exposure).clamp(0.0, 1.0);
        let encoded = if value <= 0.003_130_8 {
            12.92 * value
        } else {
            1.055 * value.powf(1.0 / 2.4) - 0.055
        };
        (255.0 * encoded).round() as u8
    };
    radiance
        .iter()
        .flat_map(|rgb| [srgb(rgb[0]), srgb(rgb[1]), srgb(rgb[2]), 255])
        .collect()
}
