//! The town as a whole.

use glam::DVec2;

use super::blocks::{Block, blocks};
use super::buildings::build;
use super::features::{SampleBuilding, Tree};
use super::landscape::{HEIGHT_M, WIDTH_M, density, river_distance, river_half_width, slope};
use super::noise::{Chance, value_noise};

/// Everything on the ground.
pub struct Town {
    /// Blocks between streets.
    pub blocks: Vec<Block>,
    /// Buildings.
    pub buildings: Vec<SampleBuilding>,
    /// Trees.
    pub trees: Vec<Tree>,
}

impl Town {
    /// The one town there is.
    pub fn new() -> Self {
        let blocks = blocks();
        let mut chance = Chance::new(2);
        let (mut buildings, mut trees) = (Vec::new(), Vec::new());
        for block in &blocks {
            build(block, &mut chance, &mut buildings, &mut trees);
        }
        super::buildings::bridges(&mut buildings);
        wild_trees(&mut chance, &mut trees);
        Self {
            blocks,
            buildings,
            trees,
        }
    }
}

impl Default for Town {
    fn default() -> Self {
        Self::new()
    }
}

/// How wooded open country is, 0 to 1.
pub fn woods(p: DVec2) -> f64 {
    let patches = value_noise(p.x / 240.0, p.y / 240.0, 41) + 0.5 * value_noise(p.x / 90.0, p.y / 90.0, 43);
    let steep = (slope(p) / 0.3).min(1.2);
    ((patches + 1.5 * steep - 0.75) * 2.0).clamp(0.0, 1.0) * f64::from(u8::from(density(p) < 0.05))
}

/// Trees of the open country and along the river.
fn wild_trees(chance: &mut Chance, trees: &mut Vec<Tree>) {
    const STEP: f64 = 8.0;
    let (columns, rows) = ((WIDTH_M / STEP) as usize, (HEIGHT_M / STEP) as usize);
    for row in 0..rows {
        for column in 0..columns {
            let at = DVec2::new(
                (column as f64 + chance.unit()) * STEP,
                (row as f64 + chance.unit()) * STEP,
            );
            let bank = river_distance(at).abs() - river_half_width(at);
            let chance_here = if (9.0..15.0).contains(&bank) {
                0.45
            } else if bank < 9.0 {
                0.0
            } else {
                0.95 * woods(at)
            };
            let radius = chance.between(2.2, 5.2);
            if chance.happens(chance_here) {
                trees.push(Tree { at, radius });
            }
        }
    }
}
