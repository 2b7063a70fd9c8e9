//! Pictures of a lens's flare alone.

use super::RenderError;
use crate::camera::flare::{
    Aperture, FlareMesh, FlareMode, FlareParameters, FlarePass, FlareSource, FlareVertex, ImageTable,
    LightImage, Pattern, Tracing, encode_images, flare_mesh,
};
use crate::camera::lens::Lens;
use crate::camera::{RayPass, single_crossing_ghosts};
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
    /// Milliseconds to make the triangles, tracing on either device included.
    pub mesh_ms: f64,
}

/// What draws flares on lenses' films, with one aperture.
pub struct FlareRenderer<'a> {
    gpu: &'a Gpu,
    pass: FlarePass,
    rays: RayPass,
}

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

impl<'a> FlareRenderer<'a> {
    /// Compiles the shaders.
    pub fn new(gpu: &'a Gpu, aperture: &Aperture) -> Self {
        Self {
            gpu,
            pass: FlarePass::new(gpu, FORMAT, aperture),
            rays: RayPass::new(gpu),
        }
    }

    /// Tracing on its device.
    pub fn tracing(&self) -> Tracing<'_> {
        Tracing::Gpu(self.gpu, &self.rays)
    }

    /// Draws a flare, the film's width over the picture's width, and the images of a table where one is given.
    pub fn picture(
        &self,
        parameters: &FlareParameters<'_>,
        images: Option<&ImageTable>,
        size: [u32; 2],
    ) -> Result<FlarePicture, RenderError> {
        self.part(parameters, images, size, film_half_mm(parameters.lens, size))
    }

    /// The same over a rectangle that spans `half_mm` to each side of the film's centre.
    fn part(
        &self,
        parameters: &FlareParameters<'_>,
        images: Option<&ImageTable>,
        size: [u32; 2],
        half_mm: [f64; 2],
    ) -> Result<FlarePicture, RenderError> {
        let gpu = self.gpu;
        let start = std::time::Instant::now();
        let mesh = match images {
            Some(images) if !images.with_linear => FlareMesh::default(),
            _ => flare_mesh(parameters)?,
        };
        let mesh_ms = start.elapsed().as_secs_f64() * 1e3;
        let target = Target::new(gpu, "flare", size, FORMAT);
        let timer = PassTimer::new(gpu, &["flare"]);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        self.pass
            .encode(gpu, &mut encoder, &target, &mesh, half_mm, 1.0, timer.pass(0));
        if let Some(images) = images {
            let FlareSource {
                angle,
                turn,
                irradiance,
                ..
            } = parameters.source;
            encode_images(
                gpu,
                &mut encoder,
                &target,
                images,
                [angle, turn],
                irradiance,
                half_mm,
            );
        }
        timer.resolve(&mut encoder);
        gpu.queue.submit([encoder.finish()]);
        gpu.wait()?;
        let halves = read_texture::<[half::f16; 4]>(gpu, &target.texture)?;
        let vertices = || mesh.added.iter().chain(&mesh.covers).chain(&mesh.above);
        let corners: Vec<&FlareVertex> = vertices().collect();
        Ok(FlarePicture {
            radiance: halves
                .iter()
                .map(|texel| [texel[0], texel[1], texel[2]].map(half::f16::to_f32))
                .collect(),
            triangles: corners.len() / 3,
            area_mm2: corners.chunks_exact(3).map(triangle_area).sum(),
            gpu_ms: timer.read(gpu)?.map(|spans| spans[0].1),
            mesh_ms,
        })
    }

    /// Every ghost alone in a cell of its own, row by row in the order of `single_crossing_ghosts`, each as bright as its own
    /// exposure makes it: what to look at when a flare looks wrong. 8-bit sRGB, and the number of columns.
    pub fn sheet(
        &self,
        parameters: &FlareParameters<'_>,
        size: [u32; 2],
    ) -> Result<(Vec<u8>, usize), RenderError> {
        let ghosts = single_crossing_ghosts(parameters.lens);
        let columns = (ghosts.len() as f64).sqrt().ceil().max(1.0) as u32;
        let rows = (ghosts.len() as u32).div_ceil(columns).max(1);
        let cell = [(size[0] / columns).max(4), (size[1] / rows).max(4)];
        let width = size[0] as usize;
        let mut sheet = [40, 40, 40, 255].repeat(width * size[1] as usize);
        for (k, &ghost) in (0_u32..).zip(&ghosts) {
            // A line is left between cells.
            let inner = cell.map(|side| side - 2);
            let only = FlareParameters {
                only: Some(ghost),
                ..*parameters
            };
            let picture = self.picture(&only, None, inner)?;
            let pixels = tone_mapped(&picture.radiance, auto_exposure(&picture.radiance));
            let corner = [k % columns * cell[0] + 1, k / columns * cell[1] + 1].map(|at| at as usize);
            for (row, line) in pixels.chunks_exact(4 * inner[0] as usize).enumerate() {
                let start = 4 * ((corner[1] + row) * width + corner[0]);
                if let Some(place) = sheet.get_mut(start..start + line.len()) {
                    place.copy_from_slice(line);
                }
            }
        }
        Ok((sheet, columns as usize))
    }

    /// A table of images of the nonlinear ghosts at angles up to `max_angle` radians, at turns all round: for apertures
    /// without symmetry, whose shape is in the images (KR 10-1658883's table over two parameters).
    pub fn bake_images(
        &self,
        parameters: &FlareParameters<'_>,
        max_angle: f64,
        [angles, turns]: [u32; 2],
        side: u32,
    ) -> Result<ImageTable, RenderError> {
        // A square that holds the film however it is turned.
        let [width, height] = parameters.lens.film_mm;
        let (size, half_mm) = ([side; 2], [0.5 * width.hypot(height); 2]);
        let mut images = Vec::new();
        for turn in (0..turns).map(|k| std::f64::consts::TAU * f64::from(k) / f64::from(turns)) {
            for angle in (0..angles).map(|k| max_angle * f64::from(k) / f64::from(angles.max(2) - 1)) {
                let source = FlareSource {
                    angle,
                    turn,
                    irradiance: [1.0; 3],
                    ..parameters.source
                };
                let nonlinear = FlareParameters {
                    source,
                    pattern: Pattern::Nonlinear,
                    mode: FlareMode::Blended,
                    ..*parameters
                };
                let picture = self.part(&nonlinear, None, size, half_mm)?;
                images.push(LightImage::new(angle, turn, &picture.radiance, size, half_mm));
            }
        }
        Ok(ImageTable::new(images, true, Some(parameters.source.f_number)))
    }
}

/// Half the film that a picture shows, millimetres.
pub fn film_half_mm(lens: &Lens, size: [u32; 2]) -> [f64; 2] {
    let half_width = 0.5 * lens.film_mm[0];
    [half_width, half_width * f64::from(size[1]) / f64::from(size[0])]
}

fn triangle_area(corners: &[&FlareVertex]) -> f64 {
    let [a, b, c] = [0, 1, 2].map(|k: usize| glam::Vec2::from_array(corners[k].sensor_mm).as_dvec2());
    0.5 * (b - a).perp_dot(c - a).abs()
}

/// Area of triangles on a film that spans `half_mm` to each side, overlaps counted, square millimetres: the raster work.
pub fn area_on_film(vertices: &[FlareVertex], half_mm: [f64; 2]) -> f64 {
    use geo::{Area, BooleanOps, BoundingRect, Rect, Triangle, coord};
    let [x, y] = half_mm;
    let film = Rect::new(coord! { x: -x, y: -y }, coord! { x: x, y: y });
    vertices
        .chunks_exact(3)
        .map(|corners| {
            let at = |k: usize| {
                let [x, y] = corners[k].sensor_mm.map(f64::from);
                coord! { x: x, y: y }
            };
            let triangle = Triangle::new(at(0), at(1), at(2));
            let bounds = triangle.bounding_rect();
            let is_apart =
                bounds.min().x > x || bounds.max().x < -x || bounds.min().y > y || bounds.max().y < -y;
            if is_apart {
                return 0.0;
            }
            triangle
                .to_polygon()
                .intersection(&film.to_polygon())
                .unsigned_area()
        })
        .sum()
}

/// Factor that brings all but the brightest 0.5 % of the lit pixels below 1.5, which [`tone_mapped`] shows at 0.6 of the
/// display's white.
pub fn auto_exposure(radiance: &[[f32; 3]]) -> f32 {
    let mut lit: Vec<f32> = radiance
        .iter()
        .map(brightest)
        .filter(|&value| value > 0.0)
        .collect();
    if lit.is_empty() {
        return 1.0;
    }
    lit.sort_by(f32::total_cmp);
    1.5 / lit[(lit.len() - 1) * 995 / 1000].max(f32::MIN_POSITIVE)
}

/// The brightest channel, no more than a half float holds: a sum may have run over.
fn brightest(rgb: &[f32; 3]) -> f32 {
    rgb.iter()
        .fold(0.0_f32, |most, &value| most.max(value))
        .min(65504.0)
}

/// 8-bit sRGB code of a linear value (IEC 61966-2-1); what is brighter than 1 is white.
pub fn srgb(linear: f32) -> u8 {
    let value = linear.clamp(0.0, 1.0);
    let encoded = if value <= 0.003_130_8 {
        12.92 * value
    } else {
        1.055 * value.powf(1.0 / 2.4) - 0.055
    };
    (255.0 * encoded).round() as u8
}

/// 8-bit sRGB of linear radiance times an exposure. The ghosts of one flare differ a hundredfold: the brightest channel is
/// brought to x / (1 + x) and the others in proportion, so that none is cut off at white and all keep their hue
/// (Reinhard et al. 2002, "Photographic Tone Reproduction for Digital Images", equation 3).
pub fn tone_mapped(radiance: &[[f32; 3]], exposure: f32) -> Vec<u8> {
    radiance
        .iter()
        .flat_map(|rgb| {
            let share = exposure / (1.0 + exposure * brightest(rgb));
            let [r, g, b] = rgb.map(|value| srgb(value.min(65504.0) * share));
            [r, g, b, 255]
        })
        .collect()
}
