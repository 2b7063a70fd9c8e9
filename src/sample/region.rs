//! A made-up region of any size: towns in rolling country, as many buildings as asked for. For measuring how things grow.
//!
//! The ground is divided into squares; each becomes streets and houses by itself, the most urban ones first, until there are
//! enough. The same numbers give the same region.

use glam::DVec2;
use rayon::prelude::*;

use super::blocks::{Block, BlockKind, split};
use super::buildings::build;
use super::features::SampleBuilding;
use super::noise::{Chance, fractal_noise, lattice, value_noise};
use super::shapes::{area, centre, rectangle};

/// A square of country with towns. Local metres from its south-west corner.
#[derive(Clone, Copy, Debug)]
pub struct Region {
    /// Side, metres.
    pub side_m: f64,
}

/// Side of a square that becomes streets, and of the part of it that has any: the rest is the road between squares. Metres.
const CELL_M: f64 = 480.0;
const BUILT_M: f64 = 462.0;
/// Towns lie about so far from each other, metres.
const TOWN_SPACING_M: f64 = 6500.0;
/// Squares worked on at a time.
const BATCH: usize = 512;
/// Buildings of built-up country, a square metre.
const USUAL_DENSITY: f64 = 1800e-6;
/// Fraction of the ground that is built up, from which on nothing is left of the towns' ragged edges, and up to which they are
/// whole.
const PACKED: f64 = 0.8;
const OPEN: f64 = 0.4;

impl Region {
    /// Of so many square kilometres.
    pub fn from_km2(km2: f64) -> Self {
        Self {
            side_m: 1000.0 * km2.sqrt(),
        }
    }

    /// Bare ground, metres.
    pub fn ground(p: DVec2) -> f64 {
        let country = 150.0 * fractal_noise(p.x / 5200.0, p.y / 5200.0, 101);
        let hills = 22.0 * fractal_noise(p.x / 900.0, p.y / 900.0, 103);
        let knolls = 1.5 * value_noise(p.x / 120.0, p.y / 120.0, 107);
        320.0 + country + hills + knolls
    }

    /// How urban a place is: 1 in the centre of a town, below 0 far from any.
    fn urban(&self, p: DVec2) -> f64 {
        let spacing = TOWN_SPACING_M.min(self.side_m);
        let cell = (p / spacing).floor();
        let mut urban = f64::NEG_INFINITY;
        for dy in -1..=1 {
            for dx in -1..=1 {
                let (i, j) = (cell.x as i64 + dx, cell.y as i64 + dy);
                let at = DVec2::new(lattice(i, j, 211), lattice(i, j, 223)) * 0.3 + 0.5;
                let town = (DVec2::new(i as f64, j as f64) + at) * spacing;
                let radius = spacing * (0.30 + 0.16 * lattice(i, j, 227));
                urban = urban.max(1.0 - p.distance(town) / radius);
            }
        }
        urban + 0.12 * value_noise(p.x / 700.0, p.y / 700.0, 229)
    }

    /// The squares, the most urban first.
    fn cells(&self) -> Vec<(DVec2, f64)> {
        let count = (self.side_m / CELL_M).floor() as usize;
        let margin = 0.5 * (self.side_m - count as f64 * CELL_M);
        let mut cells: Vec<(DVec2, f64)> = (0..count * count)
            .into_par_iter()
            .map(|k| {
                let index = DVec2::new((k % count) as f64, (k / count) as f64);
                let at = (index + 0.5) * CELL_M + margin;
                (at, self.urban(at))
            })
            .collect();
        cells.sort_by(|a, b| b.1.total_cmp(&a.1));
        cells
    }

    /// Gives the first `count` buildings to `each`, in batches. How many there were: fewer where they do not fit.
    ///
    /// # Errors
    /// What `each` says.
    pub fn buildings<E>(
        &self,
        count: usize,
        mut each: impl FnMut(&[SampleBuilding]) -> Result<(), E>,
    ) -> Result<usize, E> {
        let cells = self.cells();
        let built_up = count as f64 / (USUAL_DENSITY * self.side_m * self.side_m);
        let edge = ((cells.len() as f64 * built_up) as usize).min(cells.len().saturating_sub(1));
        let urban_at = |k: usize| cells.get(k).map_or(0.0, |&(_, urban)| urban);
        let town = Town {
            region: self,
            range: [urban_at(edge), urban_at(0).max(urban_at(edge) + 1e-6)],
            ragged: ((PACKED - built_up) / (PACKED - OPEN)).clamp(0.0, 1.0),
        };
        let mut done = 0;
        for batch in cells.chunks(BATCH) {
            let made: Vec<Vec<SampleBuilding>> =
                batch.par_iter().map(|&(at, _)| town.cell_buildings(at)).collect();
            for buildings in made {
                let some = &buildings[..buildings.len().min(count - done)];
                each(some)?;
                done += some.len();
            }
            if done == count {
                break;
            }
        }
        Ok(done)
    }
}

/// What the towns of a region look like.
struct Town<'a> {
    region: &'a Region,
    /// How urban the edges and the most urban centre are.
    range: [f64; 2],
    /// How ragged the edges are, 0 to 1.
    ragged: f64,
}

impl Town<'_> {
    /// 1 in a centre, 0 at an edge and beyond.
    fn urban(&self, p: DVec2) -> f64 {
        let [edge, centre] = self.range;
        ((self.region.urban(p) - edge) / (centre - edge)).clamp(0.0, 1.0)
    }

    /// Whether a block is built on: less and less likely towards an edge.
    fn is_built(&self, urban: f64, chance: &mut Chance) -> bool {
        let t = (urban / 0.30).min(1.0);
        let likely = 0.10 + 0.90 * t * t * (3.0 - 2.0 * t);
        chance.happens(1.0 - self.ragged * (1.0 - likely))
    }

    /// What stands on a square.
    fn cell_buildings(&self, at: DVec2) -> Vec<SampleBuilding> {
        let seed = (at.x as u64).wrapping_mul(1_000_003) ^ at.y as u64;
        let mut chance = Chance::new(seed);
        let whole = rectangle(at, DVec2::X, BUILT_M, BUILT_M);
        let mut rings = Vec::new();
        // Below the first cuts of a town, whose streets are the widest.
        split(whole, 3, &|p| self.urban(p), (&mut chance, &mut rings));
        let is_works = value_noise(at.x / 2300.0, at.y / 2300.0, 233) > 0.4;
        let (mut buildings, mut trees) = (Vec::new(), Vec::new());
        for ring in rings {
            let urban = self.urban(centre(&ring));
            if ring.len() < 3 || area(&ring) < 350.0 || !self.is_built(urban, &mut chance) {
                continue;
            }
            let kind = match urban + chance.between(-0.1, 0.1) {
                _ if chance.happens(0.05) => BlockKind::Park,
                u if u < 0.5 && is_works && chance.happens(0.6) => BlockKind::Works,
                u if u > 0.55 => BlockKind::Perimeter,
                u if u > 0.35 && chance.happens(0.7) => BlockKind::Terraces,
                u if u < 0.5 && chance.happens(0.05) => BlockKind::Towers,
                _ => BlockKind::Villas,
            };
            let block = Block { ring, kind, urban };
            build(&block, &mut chance, &mut buildings, &mut trees);
        }
        buildings
    }
}
