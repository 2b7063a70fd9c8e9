//! Grids of rays on the GPU, f32: many at once, by the shader twin of `trace`.
//!
//! Shape: one `Bundle` is a square grid over a rectangle of the entrance, for one path, wavelength and angle.

use bytemuck::{Pod, Zeroable};
use glam::DVec2;

use super::lens::Lens;
use super::path::{Ghost, path};
use super::shaders::RAYS;
use super::trace::TracedRay;
use crate::gpu::{Gpu, GpuError, OUTPUT, RECORDS, empty_buffer, read_buffer, shader_module, storage_buffer};

/// A grid of rays to trace.
#[derive(Clone, Copy, Debug)]
pub struct Bundle {
    /// The path; none is the image's.
    pub ghost: Option<Ghost>,
    /// Micrometres.
    pub wavelength_um: f64,
    /// Angle of the beam from the axis, in the x-z plane, radians.
    pub angle: f64,
    /// Least coordinates on the plane of the first vertex, millimetres.
    pub min: DVec2,
    /// Greatest coordinates.
    pub max: DVec2,
}

/// Layout of `Interface` in `shaders/lib/trace.wgsl`, where each field is explained.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
#[allow(missing_docs)]
pub struct InterfaceRecord {
    pub gap_mm: f32,
    pub curvature: f32,
    pub conic: f32,
    pub clear_mm: f32,
    pub index_before: f32,
    pub index_after: f32,
    pub flags: u32,
    pub first_film: u32,
    pub film_count: u32,
    pub first_term: u32,
    pub term_count: u32,
    pub padding: u32,
}

/// Layout of `Bundle` in `shaders/camera/ray_bundles.wgsl`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
#[allow(missing_docs)]
pub struct BundleRecord {
    pub min_mm: [f32; 2],
    pub max_mm: [f32; 2],
    pub direction: [f32; 2],
    pub sensor_gap_mm: f32,
    pub wavelength_um: f32,
    pub first: u32,
    pub count: u32,
    pub size: u32,
    pub padding: u32,
}

/// Layout of `TracedRay` in `shaders/lib/trace.wgsl`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
#[allow(missing_docs)]
pub struct RayRecord {
    pub sensor_mm: [f32; 2],
    pub stop_mm: [f32; 2],
    pub relative_height: f32,
    pub relative_stop: f32,
    pub power: f32,
    pub padding: u32,
}

/// Flags of an interface: light is reflected there; it is the stop.
pub const REFLECTS: u32 = 1;
/// See `REFLECTS`.
pub const STOP: u32 = 2;
/// Power of a ray that does not arrive.
pub const LOST: f32 = -1.0;
/// Clear radius of a surface without one, millimetres.
const OPEN_MM: f32 = 1e30;
/// Rays of a workgroup.
pub const WORKGROUP: u32 = 64;
/// Most bytes of rays at a time.
const MAX_BYTES: u64 = 64 << 20;

/// The pipeline.
pub struct RayPass {
    pipeline: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
}

impl RayPass {
    /// Group 0: interfaces, films, terms of aspheres, bundles, rays.
    pub const TYPES: [wgpu::BindingType; 5] = [RECORDS, RECORDS, RECORDS, RECORDS, OUTPUT];

    /// Compiles the shader.
    pub fn new(gpu: &Gpu) -> Self {
        let module = shader_module(gpu, &RAYS);
        let layout = gpu.layout("rays", &Self::TYPES);
        Self {
            pipeline: gpu.compute_pipeline("rays", &module, &layout),
            layout,
        }
    }

    /// Traces every bundle on a grid of `size` x `size` rays; row by row, none for a lost ray.
    pub fn trace(
        &self,
        gpu: &Gpu,
        lens: &Lens,
        sensor_gap_mm: f64,
        bundles: &[Bundle],
        size: usize,
    ) -> Result<Vec<Vec<Option<TracedRay>>>, GpuError> {
        let size = size.max(2);
        let limits = gpu.device.limits();
        let max_bytes = MAX_BYTES.min(limits.max_storage_buffer_binding_size);
        let each = (size * size * size_of::<RayRecord>()) as u64;
        gpu.require("a grid of rays", each, max_bytes)?;
        let at_once = (max_bytes / each).min(u64::from(limits.max_compute_workgroups_per_dimension)) as usize;
        let mut grids = Vec::with_capacity(bundles.len());
        for part in bundles.chunks(at_once.max(1)) {
            let records = self.trace_part(gpu, lens, sensor_gap_mm, part, size)?;
            grids.extend(
                records
                    .chunks_exact(size * size)
                    .map(|grid| grid.iter().map(ray).collect()),
            );
        }
        Ok(grids)
    }

    fn trace_part(
        &self,
        gpu: &Gpu,
        lens: &Lens,
        sensor_gap_mm: f64,
        bundles: &[Bundle],
        size: usize,
    ) -> Result<Vec<RayRecord>, GpuError> {
        let mut paths = Paths::default();
        let records: Vec<BundleRecord> = bundles
            .iter()
            .map(|bundle| {
                let (first, count) = paths.of(lens, bundle);
                BundleRecord {
                    min_mm: bundle.min.as_vec2().to_array(),
                    max_mm: bundle.max.as_vec2().to_array(),
                    direction: [bundle.angle.sin() as f32, bundle.angle.cos() as f32],
                    sensor_gap_mm: sensor_gap_mm as f32,
                    wavelength_um: bundle.wavelength_um as f32,
                    first,
                    count,
                    size: size as u32,
                    padding: 0,
                }
            })
            .collect();
        let bytes = (bundles.len() * size * size * size_of::<RayRecord>()) as u64;
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
        let rays = empty_buffer(gpu, "rays", bytes, usage);
        let buffers = [
            storage_buffer(gpu, "interfaces", &paths.interfaces)?,
            storage_buffer(gpu, "films", &paths.films)?,
            storage_buffer(gpu, "aspheric terms", &paths.terms)?,
            storage_buffer(gpu, "bundles", &records)?,
            rays,
        ];
        let resources = buffers.each_ref().map(wgpu::Buffer::as_entire_binding);
        let group = gpu.group("rays", &self.layout, &resources);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &group, &[]);
        let groups = ((size * size) as u32).div_ceil(WORKGROUP);
        pass.dispatch_workgroups(groups, bundles.len() as u32, 1);
        drop(pass);
        gpu.queue.submit([encoder.finish()]);
        read_buffer(gpu, &buffers[4])
    }
}

/// The paths of all bundles, one after the other.
#[derive(Default)]
struct Paths {
    interfaces: Vec<InterfaceRecord>,
    films: Vec<[f32; 2]>,
    terms: Vec<f32>,
    /// Path and wavelength of the last one, with its first interface and their number.
    last: Option<(PathKey, (u32, u32))>,
}

/// What a path of interfaces follows from.
type PathKey = (Option<Ghost>, f64);

impl Paths {
    /// A bundle's path: the last one where it is the same; its first interface and their number.
    fn of(&mut self, lens: &Lens, bundle: &Bundle) -> (u32, u32) {
        let key = (bundle.ghost, bundle.wavelength_um);
        match self.last {
            Some((known, interfaces)) if known == key => interfaces,
            _ => {
                let interfaces = self.add(lens, bundle);
                self.last = Some((key, interfaces));
                interfaces
            }
        }
    }

    /// Adds a bundle's path; its first interface and their number.
    fn add(&mut self, lens: &Lens, bundle: &Bundle) -> (u32, u32) {
        let indices = lens.indices(bundle.wavelength_um);
        let first = self.interfaces.len();
        let mut before: Option<usize> = None;
        for step in path(lens.surfaces.len(), bundle.ghost) {
            let surface = &lens.surfaces[step.surface];
            let gap = before.map_or(0.0, |before| {
                if step.surface > before {
                    -lens.surfaces[before].thickness_mm
                } else {
                    surface.thickness_mm
                }
            });
            before = Some(step.surface);
            let media = [indices[step.surface], indices[step.surface + 1]];
            let [index_before, index_after] = if step.forward { media } else { [media[1], media[0]] };
            let (first_film, first_term) = (self.films.len(), self.terms.len());
            let layers = surface.coating.iter().flat_map(|coating| &coating.layers);
            let mut films: Vec<[f32; 2]> = layers
                .map(|layer| [layer.index as f32, layer.thickness_um as f32])
                .collect();
            if !step.forward {
                films.reverse();
            }
            self.films.extend(&films);
            self.terms
                .extend(surface.aspheric.iter().map(|term| *term as f32));
            let clear = lens.clear_radius(step.surface) as f32;
            let is_stop = step.surface == lens.stop;
            self.interfaces.push(InterfaceRecord {
                gap_mm: gap as f32,
                curvature: if surface.radius_mm == 0.0 {
                    0.0
                } else {
                    surface.radius_mm.recip() as f32
                },
                conic: surface.conic as f32,
                clear_mm: if clear.is_finite() { clear } else { OPEN_MM },
                index_before: index_before as f32,
                index_after: index_after as f32,
                flags: u32::from(step.reflects) * REFLECTS + u32::from(is_stop) * STOP,
                first_film: first_film as u32,
                film_count: films.len() as u32,
                first_term: first_term as u32,
                term_count: surface.aspheric.len() as u32,
                padding: 0,
            });
        }
        (first as u32, (self.interfaces.len() - first) as u32)
    }
}

fn ray(record: &RayRecord) -> Option<TracedRay> {
    let [sensor, stop] = [record.sensor_mm, record.stop_mm].map(|at| glam::Vec2::from_array(at).as_dvec2());
    (record.power >= 0.0 && sensor.is_finite()).then(|| TracedRay {
        stop_mm: stop,
        sensor_mm: sensor,
        relative_height: f64::from(record.relative_height),
        relative_stop: f64::from(record.relative_stop),
        power: f64::from(record.power),
    })
}
