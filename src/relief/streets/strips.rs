//! Carriageways as strips of even width along the middles of ways. A way's middle lies halfway between the fronts on both sides, as they
//! are taken over a piece of it (`fronts`), so its kerbs run straight past gaps and corners of single houses. Of directions close to each
//! other the one counts along which the clearance fits best; ways that cross both do.

use std::f64::consts::PI;

use rayon::prelude::*;

use super::fronts::{FrontSums, Fronts};
use super::opening::{Opened, Raster};
use super::seen::BLOCK_CELLS;
use super::{CARRIAGEWAY_M, CARRIAGEWAY_PART, DIRECTIONS, WIDEST_M};

/// Clearances of a way's middle between which it comes to be a street, metres; parts of half the way between fronts that its middle is
/// clear by; how sure it is that it does not lead over open land.
const FROM_M: [f32; 2] = [1.7, 2.4];
const CLEAR_PART: [f32; 2] = [0.26, 0.40];
const CERTAIN: [f32; 2] = [0.2, 0.5];
/// Directions on each side that are near to one.
const NEAR_DIRECTIONS: usize = COUNT / 4;
/// How well a strip's way fits by the best of the near directions, and of all.
const OF_NEAR: [f32; 2] = [0.88, 0.97];
const OF_ALL: [f32; 2] = [0.65, 0.80];
/// Directions on each side over which a strip's place is evened out, those that fit by more than this part of the best.
const EVENED_DIRECTIONS: usize = COUNT / 8;
const EVENED_FROM: f32 = 0.6;
/// Only directions are looked at whose clearance is this part of the best.
const LOOKED_AT: f32 = 0.5;
/// Metres that are left for a pavement before a wall.
const BEFORE_WALL_M: f32 = 0.9;
/// Metres outside the kerb to which a strip fades where it is none.
const NO_STRIP_M: f32 = 12.0;
const COUNT: usize = DIRECTIONS as usize;

/// Places by the kerb count in steps of this, metres, from so far outside.
pub const KERB_STEP_M: f64 = 0.05;
pub const OUTSIDE_M: f64 = 7.0;
const _: () = assert!(255.0 * KERB_STEP_M - OUTSIDE_M > CARRIAGEWAY_M as f64);

/// What is known of a place.
#[derive(Clone, Copy, Debug, Default)]
pub struct StripPlace {
    /// Metres from the kerb, larger on the carriageway, in steps of [`KERB_STEP_M`] from [`OUTSIDE_M`] outside.
    pub from_kerb: u8,
    /// Half the way between the fronts of the street, tenths of a metre.
    pub half: u8,
}

/// A way through a place in one direction.
#[derive(Clone, Copy, Debug, Default)]
struct Way {
    /// As [`StripPlace`] has them, were it a street.
    from_kerb: u8,
    half: u8,
    /// How well the clearance fits the fronts, 0 where there is no way.
    fit: u8,
    /// How sure it is that it is a street, but for the other directions: of 255.
    certain: u8,
}

/// What a clearance counts that fits in full.
const FIT_STEPS: f32 = 200.0;

/// A level's ways.
pub struct Ways<'a> {
    /// How clear cells are of buildings, in steps of `step_m` metres; their openings by the directions.
    pub clear: &'a Raster,
    pub opened: &'a Opened,
    pub step_m: f32,
    /// How sure it is that a place lies on a street.
    pub certain: &'a Raster,
    /// The houses' fronts.
    pub fronts: &'a Fronts,
    /// Side of a cell, metres.
    pub cell_m: f64,
}

impl Ways<'_> {
    /// The strips, as far from the raster's border as ways are looked at, where cells (column, row) are asked for: a block of
    /// [`BLOCK_CELLS`] is or is not.
    pub fn strips(&self, is_asked: impl Fn([usize; 2]) -> bool + Sync) -> Vec<StripPlace> {
        let side = self.clear.side;
        // Along an axis its middle may be a square's diagonal away.
        let border = self
            .fronts
            .reach()
            .max((1.5 * f64::from(WIDEST_M[1]) / self.cell_m) as usize)
            + 2;
        let mut places = vec![StripPlace::default(); side * side];
        let inner = border..side.saturating_sub(border);
        let blocks = places.par_chunks_mut(BLOCK_CELLS * side).enumerate();
        blocks.for_each(|(block, places)| {
            let first = block * BLOCK_CELLS;
            let last = first + places.len() / side;
            let rows = first.max(inner.start)..last.min(inner.end);
            let columns: Vec<usize> = inner.clone().filter(|&x| is_asked([x, first])).collect();
            if !rows.is_empty() && !columns.is_empty() {
                let places = &mut places[(rows.start - first) * side..(rows.end - first) * side];
                self.fill(places, rows.start, &columns);
            }
        });
        places
    }

    /// The places of some rows, of their columns some.
    fn fill(&self, places: &mut [StripPlace], first_row: usize, columns: &[usize]) {
        let side = self.clear.side;
        let first = first_row * side;
        let is_looked_at = |place: &usize| {
            self.opened.highest[*place] > 0
                && self.certain.values[*place] > 0
                && f32::from(self.clear.values[*place]) * self.step_m < WIDEST_M[1]
        };
        let rows = (first..first + places.len()).step_by(side);
        let asked = rows.flat_map(|row| columns.iter().map(move |column| row + column));
        let looked_at: Vec<usize> = asked.filter(is_looked_at).collect();
        if looked_at.is_empty() {
            return;
        }
        let mut ways = vec![[Way::default(); COUNT]; looked_at.len()];
        for (number, opened) in &self.opened.by_direction {
            let angle = PI * f64::from(*number) / COUNT as f64;
            let sums = FrontSums::new(self.fronts, (first_row, first_row + places.len() / side), angle);
            for (ways, &place) in ways.iter_mut().zip(&looked_at) {
                if f32::from(opened[place]) >= LOOKED_AT * f32::from(self.opened.highest[place]) {
                    ways[*number as usize] = self.way(place, &sums, opened).unwrap_or_default();
                }
            }
        }
        for (ways, &place) in ways.iter().zip(&looked_at) {
            let clear = f32::from(self.clear.values[place]) * self.step_m;
            places[place - first] = strip(ways, clear - BEFORE_WALL_M);
        }
    }

    /// The way through a place in the sums' direction.
    fn way(&self, place: usize, sums: &FrontSums, opened: &[u8]) -> Option<Way> {
        let [ahead, behind] = sums.at(place);
        let half = 0.5 * (ahead + behind);
        let aside = 0.5 * (ahead - behind);
        if half > WIDEST_M[1] || aside.abs() > half {
            return None;
        }
        // Its middle, and the best of three cells there: a digital line wavers by one.
        let middle = place.wrapping_add_signed(sums.cells_across(aside) * sums.across);
        let at = |cells: isize| opened[middle.wrapping_add_signed(cells * sums.across)];
        let clear = f32::from(at(-1).max(at(0)).max(at(1))) * self.step_m;
        if clear <= FROM_M[0] {
            return None;
        }
        let certain = f32::from(self.certain.values[middle]) / 255.0;
        let is_way = smoothstep(FROM_M, clear) * (1.0 - smoothstep(WIDEST_M, half));
        let fit = clear / half.max(0.1);
        let certain = is_way * smoothstep(CLEAR_PART, fit) * smoothstep(CERTAIN, certain);
        Some(Way {
            from_kerb: kerb_steps((CARRIAGEWAY_PART * half).min(CARRIAGEWAY_M) - aside.abs()),
            half: (half / self.step_m) as u8,
            fit: (FIT_STEPS * fit * is_way) as u8,
            certain: (255.0 * certain) as u8,
        })
    }
}

/// The widest of the strips along ways through a place. `room`: metres that a carriageway may take there.
fn strip(ways: &[Way; COUNT], room: f32) -> StripPlace {
    let fit = ways.map(|way| way.fit);
    let of_near = highest_beside(fit);
    let of_all = f32::from(fit.iter().copied().max().unwrap_or(0).max(1));
    let from_kerb = |k: usize| {
        let [own, near] = [fit[k], of_near[k].max(1)].map(f32::from);
        if ways[k].certain == 0 || own < OF_NEAR[0] * near || own < OF_ALL[0] * of_all {
            return -NO_STRIP_M;
        }
        let counts = smoothstep(OF_NEAR, own / near) * smoothstep(OF_ALL, own / of_all);
        let is_strip = smoothstep([0.2, 0.8], f32::from(ways[k].certain) / 255.0 * counts);
        let beside = COUNT + k - EVENED_DIRECTIONS..=COUNT + k + EVENED_DIRECTIONS;
        let evened = beside.fold([0.0, 1.0e-6], |[sum, all], k| {
            let way = &ways[k % COUNT];
            let weight = (f32::from(way.fit) / near - EVENED_FROM).max(0.0).powi(2);
            [sum + weight * kerb_metres(way.from_kerb), all + weight]
        });
        evened[0] / evened[1] - NO_STRIP_M * (1.0 - is_strip)
    };
    let strips: [f32; COUNT] = std::array::from_fn(from_kerb);
    let widest = (0..COUNT)
        .max_by(|&a, &b| strips[a].total_cmp(&strips[b]))
        .unwrap_or(0);
    if strips[widest] <= -NO_STRIP_M {
        return StripPlace::default();
    }
    StripPlace {
        from_kerb: kerb_steps(strips[widest].min(room)),
        half: ways[widest].half,
    }
}

/// Of each direction the highest of those at most [`NEAR_DIRECTIONS`] away.
fn highest_beside(fit: [u8; COUNT]) -> [u8; COUNT] {
    let mut round: [u8; 2 * COUNT] = std::array::from_fn(|k| fit[(k + COUNT - NEAR_DIRECTIONS) % COUNT]);
    // By doubling, up to 16 on; then the last.
    for far in [1, 2, 4, 8] {
        for k in 0..round.len() - far {
            round[k] = round[k].max(round[k + far]);
        }
    }
    std::array::from_fn(|k| round[k].max(round[k + 1]))
}

fn kerb_steps(metres: f32) -> u8 {
    // A cast rounds down, and what is below 0 up to it.
    ((metres + OUTSIDE_M as f32) / KERB_STEP_M as f32 + 0.5) as u8
}

fn kerb_metres(steps: u8) -> f32 {
    f32::from(steps) * KERB_STEP_M as f32 - OUTSIDE_M as f32
}

fn smoothstep([from, to]: [f32; 2], value: f32) -> f32 {
    let part = ((value - from) / (to - from)).clamp(0.0, 1.0);
    part * part * (3.0 - 2.0 * part)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_close_to_each_other_are_compared_round_the_half_turn() {
        let fit: [u8; COUNT] = std::array::from_fn(|k| (k * 37 % 101) as u8);
        let highest = highest_beside(fit);
        for (k, &found) in highest.iter().enumerate() {
            let apart = |other: usize| k.abs_diff(other).min(COUNT - k.abs_diff(other));
            let near = (0..COUNT).filter(|&other| apart(other) <= NEAR_DIRECTIONS);
            assert_eq!(Some(found), near.map(|other| fit[other]).max(), "{k}");
        }
    }
}
