//! Where streets run, guessed from the gaps between buildings, for ground that no survey tells anything of: a street is a gap that a long
//! straight segment fits through. Of the clearance to the nearest building the openings by such segments are taken (`opening`); where
//! one is high, a strip of even width is laid along the middle between the fronts (`strips`). Ways that lead everywhere are open land.
//!
//! Levels of doubled cells lie round the eye, on a lattice that stays where it is as the eye moves.
//! The shader's part is `shaders/lib/streets.wgsl`.

mod clearance;
mod fronts;
mod opening;
mod seen;
mod strips;
mod texture;

use std::sync::Arc;

use glam::{DVec2, Vec4};
use rayon::prelude::*;

use self::clearance::{CLEARANCE_STEP_M, MAX_CLEARANCE_M, clearances};
use self::fronts::Fronts;
use self::opening::Raster;
use self::strips::{KERB_STEP_M, OUTSIDE_M, StripPlace, Ways};
use crate::buildings::FootprintMask;
use crate::space::{TileGrid, TileId};

pub use self::seen::SeenBlocks;
pub use self::texture::{StreetsRequest, StreetsTexture};

/// Cells along a level's side; shaders have it as `STREET_CELLS`.
pub const STREET_CELLS: usize = 640;
/// Levels.
pub const STREET_LEVELS: usize = 3;
/// Side of a cell of the finest level, metres.
const CELL_M: f64 = 2.0;
/// Metres at a level's border that belong to the next one: as far as what lies beyond it would change a cell. Shaders have it as
/// `STREET_BORDER_M`.
pub const STREET_BORDER_M: f64 = SEGMENT_M
    + MAX_CLEARANCE_M
    + WIDEST_M[1] as f64
    + EVEN_OPEN_M
    + CELL_M * (4 << (STREET_LEVELS - 1)) as f64;
/// Half a carriageway's width by half the way between the fronts, and at most, metres. Shaders have them.
pub const CARRIAGEWAY_PART: f32 = 0.80;
pub const CARRIAGEWAY_M: f32 = 5.6;
/// Directions of streets that are told apart.
const DIRECTIONS: u32 = 32;
/// Of them coarser levels look at every so many: their segments have fewer cells.
const COARSER_STEP: u32 = 2;
/// Halves of the way between fronts between which a street goes over to open land, metres.
const WIDEST_M: [f32; 2] = [19.0, 23.0];
/// The centre lies on a lattice of this width, metres: a multiple of the coarsest level's cells.
const LATTICE_M: f64 = 64.0;
/// Length of a segment that a street holds, metres.
const SEGMENT_M: f64 = 75.0;
/// By how much of their widest the ways of all directions are clear on average: between these a street goes over to open land.
const OPEN: [f64; 2] = [0.40, 0.62];
/// Metres over which that is evened out.
const EVEN_OPEN_M: f64 = 8.0;
/// Metres on each side over which corners are rounded: on the finest level only, others have larger cells.
const ROUND_M: f64 = 2.0;

/// The ground that buildings stand on round the eye, held apart from the tiles so that streets can be guessed beside the frames.
#[derive(Clone, Debug)]
pub struct Footprints {
    /// The tile grid.
    pub grid: TileGrid,
    /// By the tiles that stand in the table.
    pub masks: Vec<(TileId, Arc<FootprintMask>)>,
}

impl Footprints {
    /// Whether they are the same tiles' at the same state.
    fn is_same(&self, other: &Self) -> bool {
        self.grid == other.grid
            && self.masks.len() == other.masks.len()
            && (self.masks.iter().zip(&other.masks))
                .all(|((a, of_a), (b, of_b))| a == b && Arc::ptr_eq(of_a, of_b))
    }

    /// Only the tiles that reach into a square.
    fn within(mut self, centre: DVec2, half: f64) -> Self {
        let grid = self.grid;
        self.masks.retain(|(id, _)| {
            let side = grid.level_tile_m(id.level);
            let away = (grid.origin(*id) + 0.5 * side - centre).abs();
            away.max_element() < half + 0.5 * side
        });
        self
    }
}

/// Streets round a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Streets {
    centre: DVec2,
    /// Rows from the south; of each cell its place by the kerb and half the way between the street's fronts ([`strips::StripPlace`]), and
    /// the clearance in steps of [`clearance::CLEARANCE_STEP_M`].
    levels: Vec<Vec<[u8; 3]>>,
}

impl Streets {
    /// The centre for an eye in plan.
    pub fn centre_of(grid: &TileGrid, eye: DVec2) -> DVec2 {
        let corner = DVec2::new(grid.west, grid.south);
        corner + ((eye - corner) / LATTICE_M).round() * LATTICE_M
    }

    /// Half the side of the coarsest level, metres.
    fn extent_m() -> f64 {
        0.5 * STREET_CELLS as f64 * level_cell_m(STREET_LEVELS - 1)
    }

    /// Round a centre, as far as it is seen.
    pub fn new(footprints: &Footprints, centre: DVec2, seen: &SeenBlocks) -> Self {
        let level = |level: usize| {
            let cell_m = level_cell_m(level);
            let covered = covered(footprints, centre, cell_m);
            let clear = clearances(&covered, cell_m);
            let unknown = StripPlace::default();
            if !seen.any(level) {
                let texel = |&clear: &u8| [unknown.from_kerb, unknown.half, clear];
                return clear.values.iter().map(texel).collect();
            }
            let opened = clear.opened_by_lines(SEGMENT_M / cell_m, DIRECTIONS, COARSER_STEP.min(1 << level));
            let certain = (opened.highest.iter().zip(&opened.sum))
                .map(|(&highest, &sum)| street_certainty(highest, sum, opened.by_direction.len()))
                .collect();
            let raster = |values: Vec<u8>| Raster {
                side: STREET_CELLS,
                values,
            };
            let is_seen = |cell| seen.has(level, cell);
            let strips = Ways {
                clear: &clear,
                opened: &opened,
                certain: &raster(certain).mean_within((EVEN_OPEN_M / cell_m).round() as usize),
                fronts: &Fronts::new(&covered, cell_m),
                cell_m,
                step_m: CLEARANCE_STEP_M as f32,
            }
            .strips(is_seen);
            let from_kerb = raster(strips.iter().map(|place| place.from_kerb).collect());
            let from_kerb = from_kerb.mean_within((ROUND_M / cell_m) as usize);
            let texel = |k: usize| [from_kerb.values[k], strips[k].half, clear.values[k]];
            (0..STREET_CELLS * STREET_CELLS).map(texel).collect()
        };
        Self {
            centre,
            levels: (0..STREET_LEVELS).into_par_iter().map(level).collect(),
        }
    }

    /// The cell that a point lies in, of the finest level that reaches there.
    pub fn cell_at(&self, point: DVec2) -> Option<[u8; 3]> {
        let offset = point - self.centre;
        let half = 0.5 * STREET_CELLS as f64;
        let reaches =
            |&level: &usize| offset.abs().max_element() + STREET_BORDER_M < half * level_cell_m(level);
        let level = (0..self.levels.len()).find(reaches)?;
        let cell = (offset / level_cell_m(level) + half).floor();
        self.levels[level]
            .get(cell.y as usize * STREET_CELLS + cell.x as usize)
            .copied()
    }

    /// Metres from the kerb at a point, as its cell tells, larger on the carriageway, and half the way between the street's fronts.
    pub fn kerb_at(&self, point: DVec2) -> Option<[f64; 2]> {
        let [from_kerb, half, ..] = self.cell_at(point)?.map(f64::from);
        Some([from_kerb * KERB_STEP_M - OUTSIDE_M, half * CLEARANCE_STEP_M])
    }

    /// What shaders take, for an eye in plan: the centre from the eye, the side of a cell, the number of levels.
    pub fn uniform(&self, eye: DVec2) -> Vec4 {
        let from_eye = (self.centre - eye).as_vec2();
        Vec4::new(from_eye.x, from_eye.y, CELL_M as f32, self.levels.len() as f32)
    }

    /// The cells of the levels, the finest first.
    pub fn levels(&self) -> &[Vec<[u8; 3]>] {
        &self.levels
    }
}

fn level_cell_m(level: usize) -> f64 {
    CELL_M * f64::from(1_u32 << level)
}

/// How sure it is that the widest way through a place is a street's, 0 to 255, by the ways of all directions.
fn street_certainty(highest: u8, sum: u16, directions: usize) -> u8 {
    let mean = f64::from(sum) / directions as f64;
    let part = (mean / f64::from(highest.max(1)) - OPEN[0]) / (OPEN[1] - OPEN[0]);
    (255.0 * (1.0 - part.clamp(0.0, 1.0))) as u8
}

/// Which cells round a centre buildings cover, 1 where they do.
fn covered(footprints: &Footprints, centre: DVec2, cell_m: f64) -> Raster {
    /// Looks a cell's side at a mask that is finer.
    const MAX_LOOKS: usize = 2;
    let mut values = vec![0; STREET_CELLS * STREET_CELLS];
    let corner = centre - 0.5 * STREET_CELLS as f64 * cell_m;
    for (id, mask) in &footprints.masks {
        let tile_m = footprints.grid.level_tile_m(id.level);
        let from = footprints.grid.origin(*id) - corner;
        let per_m = mask.side() as f64 / tile_m;
        let looks = ((cell_m * per_m).round() as usize).clamp(1, MAX_LOOKS);
        // Cells whose centres lie in the tile; of those the mask's columns or rows that they look at.
        let looked_at = |from: f64| -> (usize, Vec<Vec<usize>>) {
            let cells = |metres: f64| ((metres / cell_m - 0.5).ceil().max(0.0) as usize).min(STREET_CELLS);
            let (first, end) = (cells(from), cells(from + tile_m));
            let look = |cell: usize, k: usize| {
                let metres = (cell as f64 + (k as f64 + 0.5) / looks as f64) * cell_m - from;
                ((metres * per_m).max(0.0) as usize).min(mask.side() - 1)
            };
            let of_cell = |cell: usize| (0..looks).map(|k| look(cell, k)).collect();
            (first, (first..end).map(of_cell).collect())
        };
        let ((first_x, columns), (first_y, rows)) = (looked_at(from.x), looked_at(from.y));
        for (y, rows) in (first_y..).zip(&rows) {
            for (x, columns) in (first_x..).zip(&columns) {
                let hits = rows
                    .iter()
                    .flat_map(|&row| columns.iter().map(move |&column| [column, row]));
                let count = hits.filter(|&[column, row]| mask.is_covered(column, row)).count();
                if 2 * count >= looks * looks {
                    values[y * STREET_CELLS + x] = 1;
                }
            }
        }
    }
    Raster {
        side: STREET_CELLS,
        values,
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::scene::Frustum;
    use crate::space::{Pose, Projection};

    const GRID: TileGrid = TileGrid {
        west: 1000.0,
        south: 5000.0,
        tile_m: 512.0,
        columns: 3,
        rows: 3,
    };
    /// Width of a street between house fronts, and of a block between streets, metres.
    const STREET_M: f64 = 18.0;
    const BLOCK_M: f64 = 62.0;

    /// A town of blocks within a rectangle turned by an angle about the grid's middle: houses of 14 m, gaps of 2 m between them, round a
    /// yard.
    fn town(angle: f64, has_gap: bool) -> Footprints {
        let middle = DVec2::new(GRID.west, GRID.south) + 1.5 * GRID.tile_m;
        let mask = |id: TileId| {
            FootprintMask::from_cells(256, |x, y| {
                let at = GRID.origin(id) + 2.0 * DVec2::new(x as f64 + 0.5, y as f64 + 0.5) - middle;
                let local = DVec2::from_angle(-angle).rotate(at);
                let period = BLOCK_M + STREET_M;
                let in_block = DVec2::new(local.x.rem_euclid(period), local.y.rem_euclid(period)) - STREET_M;
                let is_house = in_block.min_element() >= 0.0
                    && in_block.x.rem_euclid(16.0) < 14.0
                    && (!(20.0..BLOCK_M - 20.0).contains(&in_block.y)
                        || !(14.0..BLOCK_M - 14.0).contains(&in_block.x));
                let is_gap = has_gap && local.x.abs() < 60.0 && local.y.abs() < 60.0;
                local.abs().max_element() < 400.0 && is_house && !is_gap
            })
        };
        let masks = GRID.tiles().map(|id| (id, Arc::new(mask(id)))).collect();
        Footprints { grid: GRID, masks }
    }

    fn streets(footprints: &Footprints, eye: DVec2) -> Streets {
        Streets::new(footprints, Streets::centre_of(&GRID, eye), &SeenBlocks::ALL)
    }

    fn middle() -> DVec2 {
        DVec2::new(GRID.west, GRID.south) + 1.5 * GRID.tile_m
    }

    #[test]
    fn kerbs_run_straight_along_streets_and_yards_and_open_land_have_none() {
        for angle in [0.0, 0.17, 0.5, 0.8, 1.3] {
            let found = streets(&town(angle, false), middle());
            let at = |x: f64, y: f64| {
                found
                    .kerb_at(middle() + DVec2::from_angle(angle).rotate(DVec2::new(x, y)))
                    .unwrap()
            };
            let period = BLOCK_M + STREET_M;
            let widest = f64::from(CARRIAGEWAY_M);
            let (mut places, mut straight) = (0, 0);
            for k in 0..360 {
                // Along both of the streets that cross in the middle, past gaps and the mouths of others.
                let along = f64::from(k) - 180.0;
                for aside in [-6.0, -3.0, 0.0, 3.0, 6.0] {
                    let in_mouth = (along - 0.5 * STREET_M).rem_euclid(period);
                    let is_mouth = in_mouth.min(period - in_mouth) < 0.5 * STREET_M + 4.0;
                    for [x, y] in [[along, 0.5 * STREET_M + aside], [0.5 * STREET_M + aside, along]] {
                        let [from_kerb, half] = at(x, y);
                        if is_mouth {
                            assert!(
                                from_kerb > widest - aside.abs() - 2.0,
                                "{angle} {x} {y}: {from_kerb}"
                            );
                            continue;
                        }
                        places += 1;
                        // The place is its cell's, up to 1.4 m away.
                        straight += i32::from((from_kerb - (widest - aside.abs())).abs() < 1.8);
                        // Mouths and gaps count as fronts farther away.
                        assert!(
                            (0.5 * STREET_M - 1.5..0.5 * STREET_M + 3.5).contains(&half),
                            "{angle} {x} {y}: {half}"
                        );
                    }
                }
            }
            assert!(
                places > 2000 && f64::from(straight) > 0.99 * f64::from(places),
                "{angle}: {straight} of {places}"
            );
            // In a yard no long way leads, and open land leads everywhere.
            for k in -3..3 {
                let yard = STREET_M + 0.5 * BLOCK_M;
                let [from_kerb, _] = at(f64::from(k) * period + yard, period + yard);
                assert!(from_kerb < -1.0, "{angle} {k}: {from_kerb}");
            }
            for [x, y] in [[0.0, 460.0], [470.0, -120.0], [-455.0, 455.0]] {
                let [from_kerb, _] = at(x, y);
                assert!(from_kerb < -1.0, "{angle} {x} {y}: {from_kerb}");
            }
        }
    }

    #[test]
    fn a_place_looks_the_same_from_wherever_it_is_seen() {
        let footprints = town(0.3, false);
        let [one, other] =
            [DVec2::ZERO, DVec2::new(200.0, -150.0)].map(|from| streets(&footprints, middle() + from));
        assert_ne!(one.centre, other.centre);
        let mut compared = 0;
        // As far as the finest level reaches round both.
        let extent = 0.5 * STREET_CELLS as f64 * CELL_M - STREET_BORDER_M;
        for k in 0..120 * 120 {
            let at = middle() + 8.0 * (DVec2::new(f64::from(k % 120), f64::from(k / 120)) - 59.5);
            let is_near = |streets: &Streets| (at - streets.centre).abs().max_element() < extent;
            if is_near(&one) && is_near(&other) {
                assert_eq!(one.cell_at(at), other.cell_at(at), "{at}");
                compared += 1;
            }
        }
        assert!(compared > 5000, "{compared}");
    }

    #[test]
    fn houses_that_go_change_what_lies_round_them_only() {
        let [with, without] = [false, true].map(|has_gap| streets(&town(0.0, has_gap), middle()));
        let cell = |found: &Streets, x: f64, y: f64| found.cell_at(middle() + DVec2::new(x, y)).unwrap();
        assert_ne!(cell(&with, 5.0, 40.0), cell(&without, 5.0, 40.0));
        // Farther away than a segment and what a clearance and its means reach.
        let far = 60.0 + SEGMENT_M + 60.0;
        for [x, y] in [[far, 9.0], [-far, 49.0], [89.0, far], [9.0, -far]] {
            assert_eq!(cell(&with, x, y), cell(&without, x, y), "{x} {y}");
        }
    }

    #[test]
    fn what_a_view_sees_is_as_where_everything_is_asked_for() {
        let footprints = town(0.3, false);
        for (eye_m, ahead, down) in [
            (12.0, [0.6, 0.8], 0.15),
            (90.0, [-1.0, 0.1], 0.4),
            (700.0, [0.2, -1.0], 1.1),
        ] {
            let eye = middle().extend(eye_m);
            let pose = Pose::looking_at(eye, eye + DVec3::new(ahead[0], ahead[1], -down));
            let view = Projection::new(pose, [64, 36], 0.9);
            let centre = Streets::centre_of(&GRID, middle());
            let seen = SeenBlocks::from_view(&Frustum::new(&view), centre, [0.0, 30.0]);
            let [part, all] = [seen, SeenBlocks::ALL].map(|seen| Streets::new(&footprints, centre, &seen));
            let mut places = 0;
            for k in 0..64 * 36 {
                let ray = view.ray_direction(k % 64, k / 64);
                let at = eye + ray * (-eye.z / ray.z);
                if ray.z < 0.0
                    && let Some(cell) = all.cell_at(at.truncate())
                {
                    assert_eq!(part.cell_at(at.truncate()), Some(cell), "{eye_m} {at}");
                    places += usize::from(cell[0] > 0);
                }
            }
            assert!(places > 100, "{eye_m}: {places}");
            assert_ne!(part, all);
        }
    }
}
