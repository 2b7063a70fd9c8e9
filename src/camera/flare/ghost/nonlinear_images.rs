//! The nonlinear images of ghosts: grids of rays, traced for the light's angle or evaluated from a table.

use glam::DVec2;
use rayon::prelude::*;

use super::blend::{Blend, Fit, fitted};
use super::grid::{CLOSER_LOOKS, GridDrawing, MARGIN_STOP, RayGrid, SEARCH_RAYS, blocks};
use super::linear::{LinearGhost, MAX_SOFTNESS};
use super::parameters::{FlareMode, FlareParameters};
use super::patches::rays_needed;
use super::quad::Losses;
use super::softness::Softness;
use super::vertex::FlareVertex;
use crate::camera::flare::{FlareTable, Wavelength};
use crate::camera::lens::D_LINE_UM;
use crate::camera::paraxial::Paraxial;
use crate::camera::path::Ghost;
use crate::camera::ray_bundles::Bundle;
use crate::camera::trace::Tracer;
use crate::gpu::GpuError;

/// Rays traced and turned into triangles at a time.
const RAYS_AT_ONCE: usize = 1 << 18;

/// A ghost and the fractions of its linear and its nonlinear image.
pub struct Part {
    /// The ghost.
    pub ghost: Ghost,
    /// Of its linear image.
    pub linear: f64,
    /// Of its nonlinear one.
    pub nonlinear: f64,
}

/// The optics of one colour.
pub struct Optics {
    /// The colour.
    pub colour: Wavelength,
    /// First-order data, the sensor where all colours have it.
    pub paraxial: Paraxial,
}

/// What all images of a flare have in common.
pub struct Context<'a> {
    /// What is asked for.
    pub parameters: &'a FlareParameters<'a>,
    /// Every colour.
    pub optics: &'a [Optics],
    /// First-order data in the centre of the spectrum.
    pub d_line: &'a Paraxial,
    /// Radius of the iris, millimetres.
    pub stop_mm: f64,
}

/// Rays along an edge of the grid by which a table tells how many are needed.
const KNOWN_RAYS: usize = 10;

/// A grid to trace.
struct Job<'a> {
    image: usize,
    part: &'a Part,
    optics: &'a Optics,
    bundle: Bundle,
    /// Along an edge.
    rays: usize,
    /// Column and row of the first ray of each block that is traced.
    blocks: Vec<[usize; 2]>,
}

/// Rays along an edge of a block, at most.
const BLOCK: usize = 10;

impl Job<'_> {
    /// Rays along an edge of its blocks.
    fn block(&self) -> usize {
        BLOCK.min(self.rays)
    }

    /// The bundles of its blocks.
    fn bundles(&self) -> impl Iterator<Item = Bundle> {
        let spacing = (self.bundle.max - self.bundle.min) / (self.rays - 1) as f64;
        let extent = (self.block() - 1) as f64 * spacing;
        self.blocks.iter().map(move |&[column, row]| {
            let min = self.bundle.min + DVec2::new(column as f64, row as f64) * spacing;
            Bundle {
                min,
                max: min + extent,
                ..self.bundle
            }
        })
    }

    /// The whole grid, of the next traced blocks.
    fn grid(&self, traced: &mut impl Iterator<Item = RayGrid>) -> RayGrid {
        let mut grid = RayGrid::empty(&self.bundle, self.rays);
        for (&first, block) in self.blocks.iter().zip(traced) {
            grid.set_block(first, &block);
        }
        grid
    }
}

/// An image of a ghost.
pub struct GhostImage {
    /// How it is softened.
    pub softness: Softness,
    /// Its triangles.
    pub vertices: Vec<FlareVertex>,
    /// Area on the sensor of the part that iris and front let through, in one colour, square millimetres; none where its triangles tell.
    pub lit_mm2: Option<f64>,
}

impl Context<'_> {
    fn linear(&self, ghost: Ghost, paraxial: &Paraxial) -> LinearGhost {
        let FlareParameters { lens, source, .. } = *self.parameters;
        LinearGhost::new(lens, paraxial, ghost, source.angle, self.stop_mm)
    }

    /// Softness of a ghost whose light comes in round a point of the entrance.
    fn softness(&self, ghost: Ghost, entry_mm: DVec2) -> Softness {
        let FlareParameters { lens, source, .. } = *self.parameters;
        let tracer = Tracer::new(lens, D_LINE_UM, self.d_line.sensor_gap_mm());
        let linear = self.linear(ghost, self.d_line);
        Softness::traced(&tracer, ghost, &linear, entry_mm, &source)
            .unwrap_or_else(|| Softness::linear(&linear, &source))
    }

    /// Rays along an edge of a ghost's grid: all that are asked for in the exact mode and where it hides others, else as many as it needs.
    fn rays_needed(&self, known: &RayGrid, window: [DVec2; 2], softness: &Softness, finer: usize) -> usize {
        let FlareParameters { lens, ghosts, .. } = *self.parameters;
        if ghosts.mode == FlareMode::Exact || ghosts.blend == Blend::Alpha {
            return ghosts.rays.max(2);
        }
        let half_diagonal_mm = 0.5 * lens.film_mm[0].hypot(lens.film_mm[1]);
        let sizes = (self.stop_mm, half_diagonal_mm);
        rays_needed(known, window, softness, sizes, finer * ghosts.rays)
    }

    fn triangles(&self, part: &Part, optics: &Optics, softness: Softness, grid: RayGrid) -> Vec<FlareVertex> {
        let FlareParameters {
            lens, source, ghosts, ..
        } = *self.parameters;
        let mut grid = grid;
        if ghosts.fit != Fit::default() {
            let tracer = Tracer::new(lens, optics.colour.um, self.d_line.sensor_gap_mm());
            let linear = self.linear(part.ghost, &optics.paraxial);
            if let Some(losses) = Losses::from_ray(&tracer, &linear, &source, part.ghost) {
                grid = fitted(grid, &linear, &losses, ghosts.fit);
            }
        }
        // One colour masks for all.
        let is_masking = std::ptr::eq(optics, &self.optics[self.optics.len() / 2]);
        let opacity = if is_masking { part.nonlinear } else { 0.0 };
        grid.triangles(&GridDrawing {
            source,
            colour: optics.colour,
            stop_mm: self.stop_mm,
            softness,
            fraction: part.nonlinear,
            opacity,
        })
    }

    /// Images evaluated from a table; those of ghosts without light are left out.
    pub fn tabled(&self, parts: &[&Part], table: &FlareTable) -> Vec<GhostImage> {
        let FlareParameters { source, .. } = *self.parameters;
        let image = |part: &&Part| {
            let evaluated = table.ghost(part.ghost)?.at(source.angle)?;
            let softness = self.softness(part.ghost, evaluated.centre_mm());
            let known = evaluated.grid(D_LINE_UM, KNOWN_RAYS);
            let rays = self.rays_needed(&known, [known.min, known.max], &softness, 1);
            let vertices = self.optics.iter().flat_map(|optics| {
                let grid = evaluated.grid(optics.colour.um, rays);
                self.triangles(part, optics, softness, grid)
            });
            Some(GhostImage {
                softness,
                vertices: vertices.collect(),
                lit_mm2: None,
            })
        };
        parts.par_iter().filter_map(image).collect()
    }

    /// Images by rays traced for this angle, `finer` times as many along an edge as are asked for at most.
    ///
    /// # Errors
    /// When the device fails while it traces.
    pub fn traced(&self, parts: &[&Part], finer: usize) -> Result<Vec<GhostImage>, GpuError> {
        let FlareParameters {
            lens,
            source,
            tracing,
            ..
        } = *self.parameters;
        let gap = self.d_line.sensor_gap_mm();
        // Where each ghost's light comes in, by a coarse grid over the whole front in the centre of the spectrum.
        let linears: Vec<LinearGhost> = parts
            .iter()
            .map(|part| self.linear(part.ghost, self.d_line))
            .collect();
        let whole = |(part, linear): (&&Part, &LinearGhost)| Bundle {
            ghost: Some(part.ghost),
            wavelength_um: D_LINE_UM,
            angle: source.angle,
            min: DVec2::splat(-linear.barrel_mm),
            max: DVec2::splat(linear.barrel_mm),
        };
        let searches: Vec<Bundle> = parts.iter().zip(&linears).map(whole).collect();
        let mut found = tracing.grids(lens, gap, &searches, SEARCH_RAYS)?;
        for _ in 0..CLOSER_LOOKS {
            let closer: Vec<(usize, Bundle)> = (0..found.len())
                .filter_map(|k| {
                    let [min, max] = found[k].closer(&linears[k])?;
                    Some((
                        k,
                        Bundle {
                            min,
                            max,
                            ..searches[k]
                        },
                    ))
                })
                .collect();
            let bundles: Vec<Bundle> = closer.iter().map(|(_, bundle)| *bundle).collect();
            let grids = tracing.grids(lens, gap, &bundles, SEARCH_RAYS)?;
            for ((k, _), grid) in closer.into_iter().zip(grids) {
                found[k] = grid;
            }
        }
        let max_stop =
            |linear: &LinearGhost| MARGIN_STOP + Softness::linear(linear, &source).stop.min(MAX_SOFTNESS);
        let windows: Vec<Option<[DVec2; 2]>> = found
            .iter()
            .zip(&linears)
            .map(|(search, linear)| search.window(linear, max_stop(linear)))
            .collect();
        // Once more within the windows: most of them are dark. The exact mode, by which others are judged, takes them as they are.
        let mut within: Vec<Option<RayGrid>> = vec![None; windows.len()];
        if self.parameters.ghosts.mode != FlareMode::Exact {
            let lit: Vec<(usize, Bundle)> = (0..windows.len())
                .filter_map(|k| {
                    let [min, max] = windows[k]?;
                    let bundle = Bundle {
                        min,
                        max,
                        ..searches[k]
                    };
                    Some((k, bundle))
                })
                .collect();
            let bundles: Vec<Bundle> = lit.iter().map(|(_, bundle)| *bundle).collect();
            let grids = tracing.grids(lens, gap, &bundles, SEARCH_RAYS)?;
            for ((k, _), grid) in lit.into_iter().zip(grids) {
                within[k] = Some(grid);
            }
        }
        let mut images: Vec<GhostImage> = Vec::new();
        let mut jobs = Vec::new();
        for (k, &part) in parts.iter().enumerate() {
            let Some([min, max]) = windows[k] else {
                continue;
            };
            let softness = self.softness(part.ghost, 0.5 * (min + max));
            let rays = self.rays_needed(&found[k], [min, max], &softness, finer);
            let block = BLOCK.min(rays);
            let traced: Vec<[usize; 2]> = match &within[k] {
                Some(grid) => grid.lit_blocks(&linears[k], (rays, block)),
                None => blocks(rays, block).collect(),
            };
            for optics in self.optics {
                let bundle = Bundle {
                    ghost: Some(part.ghost),
                    wavelength_um: optics.colour.um,
                    angle: source.angle,
                    min,
                    max,
                };
                jobs.push(Job {
                    image: images.len(),
                    part,
                    optics,
                    bundle,
                    rays,
                    blocks: traced.clone(),
                });
            }
            images.push(GhostImage {
                softness,
                vertices: Vec::new(),
                lit_mm2: None,
            });
        }
        // Blocks of one size are traced together.
        jobs.sort_by_key(Job::block);
        for jobs in jobs.chunk_by(|a, b| a.block() == b.block()) {
            let block = jobs[0].block();
            let most = (RAYS_AT_ONCE / block.pow(2)).max(1);
            let mut rest = jobs;
            while !rest.is_empty() {
                let mut count = 0;
                let taken = rest.iter().take_while(|job| {
                    count += job.blocks.len();
                    count <= most
                });
                let (jobs, later) = rest.split_at(taken.count().max(1));
                rest = later;
                let bundles: Vec<Bundle> = jobs.iter().flat_map(Job::bundles).collect();
                let mut traced = tracing.grids(lens, gap, &bundles, block)?.into_iter();
                let grids: Vec<RayGrid> = jobs.iter().map(|job| job.grid(&mut traced)).collect();
                let made: Vec<Vec<FlareVertex>> = jobs
                    .par_iter()
                    .zip(grids)
                    .map(|(job, mut grid)| {
                        grid.extend();
                        self.triangles(job.part, job.optics, images[job.image].softness, grid)
                    })
                    .collect();
                for (job, vertices) in jobs.iter().zip(made) {
                    images[job.image].vertices.extend(vertices);
                }
            }
        }
        Ok(images)
    }
}
