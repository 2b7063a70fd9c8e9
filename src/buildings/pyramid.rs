//! The pyramid of maxima over the roof elevations: what of a block a ray stays above is skipped in one read (maximum
//! mipmaps: Tevs, Ihrke & Seidel 2008).
//!
//! A node has 4 x 4 children and is one read of 16 bytes, a byte a child. The children of a node of level k are squares of 4^k texels
//! a side: level 1 has the building map's blocks for children and so one node for each group of them, every level above has nodes of
//! the level below.

use super::BuildingMap;
use super::map::BLOCK;

/// Highest roofs of a tile.
#[derive(Clone, Debug)]
pub struct Pyramid {
    /// Texels along the tile's side, a power of two.
    side: usize,
    /// Elevation that byte 1 stands for, metres.
    low: f32,
    /// Elevation that byte 255 stands for: the tile's highest roof, metres; negative infinity without buildings.
    high: f32,
    /// Nodes, level after level, row by row from the south: element r has row r of children from the south, its lowest byte the
    /// western one. 0 = no building.
    nodes: Vec<[u32; 4]>,
}

/// Children along a node's side.
const CHILDREN: usize = 4;
/// Steps between the lowest and the highest elevation that a byte stands for: 254, and so much less that rounding cannot bring
/// the last one under the highest roof. Shaders have it as `PYRAMID_STEPS`.
pub const STEPS: f32 = 253.99;

impl Pyramid {
    /// Builds all levels. `low` is the tile's lowest ground, metres; a roof under it counts as high as it.
    pub fn from_map(map: &BuildingMap, low: f32) -> Self {
        let children = Self::children_across(map.side, 1);
        let mut below = vec![f32::NEG_INFINITY; children * children];
        for ([column, row], block) in map.blocks() {
            let highest = map
                .stored_codes(&block)
                .iter()
                .map(|&code| map.highest_roof(code));
            below[row * children + column] = highest.fold(f32::NEG_INFINITY, f32::max);
        }
        let high = below.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        let mut pyramid = Self {
            side: map.side,
            low,
            high,
            nodes: vec![[0; 4]; Self::node_count(map.side)],
        };
        for level in 1..=Self::top_level(map.side) {
            let across = Self::nodes_across(map.side, level);
            let mut maxima = vec![f32::NEG_INFINITY; across * across];
            let children = Self::children_across(map.side, level);
            for (child, &highest) in below.iter().enumerate() {
                let (column, row) = (child % children, child / children);
                let [x, y] = [column / CHILDREN, row / CHILDREN];
                let byte = u32::from(pyramid.byte_of(highest)) << (8 * (column % CHILDREN));
                let place = pyramid.place(level, [x, y]);
                pyramid.nodes[place][row % CHILDREN] |= byte;
                let node = &mut maxima[y * across + x];
                *node = node.max(highest);
            }
            below = maxima;
        }
        pyramid
    }

    /// The level of which one child covers a tile of `side` texels, or four do.
    pub fn top_level(side: usize) -> u32 {
        (side.ilog2() / 2).max(1)
    }

    /// Children along a tile's side.
    fn children_across(side: usize, level: u32) -> usize {
        (side >> (2 * level)).max(1)
    }

    /// Nodes along a tile's side.
    fn nodes_across(side: usize, level: u32) -> usize {
        (side >> (2 * level + 2)).max(1)
    }

    /// Nodes of all levels below one: the sum of a geometric series.
    fn first_node(side: usize, level: u32) -> usize {
        let blocks = BLOCK * BuildingMap::groups_across(side);
        (blocks * blocks - (blocks >> (2 * level - 2)).pow(2)) / 15
    }

    /// Nodes of a tile of `side` texels: the top level has one.
    pub fn node_count(side: usize) -> usize {
        Self::first_node(side, Self::top_level(side)) + 1
    }

    /// Bytes of all nodes.
    pub fn bytes(side: usize) -> usize {
        size_of::<[u32; 4]>() * Self::node_count(side)
    }

    /// Place of a node.
    fn place(&self, level: u32, [column, row]: [usize; 2]) -> usize {
        Self::first_node(self.side, level) + row * Self::nodes_across(self.side, level) + column
    }

    /// Metres of a byte's step.
    fn step_m(&self) -> f32 {
        ((self.high - self.low) / STEPS).max(0.0)
    }

    fn byte_of(&self, highest: f32) -> u8 {
        match highest {
            f32::NEG_INFINITY => 0,
            _ => {
                let byte =
                    (1.0 + ((highest - self.low) / self.step_m().max(1e-9)).ceil()).clamp(1.0, 255.0) as u8;
                // Rounding may have brought it a step too low.
                byte.saturating_add(u8::from(self.bound_of(byte) < highest))
            }
        }
    }

    /// Children along the tile's side of the nodes of a level.
    pub fn children(&self, level: u32) -> usize {
        Self::children_across(self.side, level)
    }

    /// The level of its one top node.
    pub fn top(&self) -> u32 {
        Self::top_level(self.side)
    }

    /// The tile's lowest ground, metres.
    pub fn min_height(&self) -> f32 {
        self.low
    }

    /// The part of each of `across` x `across` squares of the tile that buildings cover, by blocks that hold any, 0 to 255, row by row from
    /// the south; where squares are finer than nodes, that of the node.
    pub fn coverage(&self, across: usize) -> Vec<u8> {
        let nodes = Self::nodes_across(self.side, 1);
        // Squares a node, or nodes a square, along a side.
        let (finer, coarser) = ((across / nodes).max(1), (nodes / across).max(1));
        let mut counts = vec![0_u32; across * across];
        for (k, node) in self.nodes[..nodes * nodes].iter().enumerate() {
            let occupied: u32 = node.iter().map(|&row| occupied_bytes(row)).sum();
            let first = [k % nodes, k / nodes].map(|place| place * finer / coarser);
            for y in first[1]..(first[1] + finer).min(across) {
                for count in &mut counts[y * across..][first[0]..(first[0] + finer).min(across)] {
                    *count += occupied;
                }
            }
        }
        let all = (CHILDREN * CHILDREN * coarser * coarser) as u32;
        counts
            .into_iter()
            .map(|count| (255 * count / all) as u8)
            .collect()
    }

    /// Highest roof of the tile, metres; negative infinity without buildings.
    pub fn max_height(&self) -> f32 {
        self.high
    }

    /// All nodes, level after level.
    pub fn nodes(&self) -> &[[u32; 4]] {
        &self.nodes
    }

    fn bound_of(&self, byte: u8) -> f32 {
        match byte {
            0 => f32::NEG_INFINITY,
            _ => self.low + (f32::from(byte) - 1.0) * self.step_m(),
        }
    }

    /// The children of a level that hold buildings: column and row, and the bound on their roofs, metres.
    pub fn standing(&self, level: u32) -> impl Iterator<Item = ([usize; 2], f32)> {
        let across = Self::nodes_across(self.side, level);
        let first = Self::first_node(self.side, level);
        let nodes = self.nodes[first..][..across * across].iter().enumerate();
        nodes
            .filter(|(_, node)| **node != [0; 4])
            .flat_map(move |(k, node)| {
                let [x, y] = [k % across, k / across].map(|place| CHILDREN * place);
                (0..CHILDREN * CHILDREN).filter_map(move |child| {
                    let [column, row] = [child % CHILDREN, child / CHILDREN];
                    let byte = (node[row] >> (8 * column)) as u8;
                    (byte != 0).then(|| ([x + column, y + row], self.bound_of(byte)))
                })
            })
    }

    /// A bound on the roofs of one child (level 1: a block), metres: no lower than the highest, and at most a step above it; negative
    /// infinity where no building is.
    pub fn bound(&self, level: u32, column: usize, row: usize) -> f32 {
        let node = self.nodes[self.place(level, [column / CHILDREN, row / CHILDREN])];
        let byte = (node[row % CHILDREN] >> (8 * (column % CHILDREN))) & 255;
        self.bound_of(byte as u8)
    }
}

/// How many of a word's bytes are not 0.
fn occupied_bytes(word: u32) -> u32 {
    const LOW: u32 = 0x7f7f_7f7f;
    ((((word & LOW) + LOW) | word) & !LOW).count_ones()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::buildings::rasterise::CellRaster;
    use crate::buildings::{CellKind, Full, RoofRecord};

    /// One of so many texels has a roof of one of 17 elevations.
    fn scattered(side: usize, one_of: usize) -> (Option<BuildingMap>, Vec<u32>) {
        let roofs = (0..17).map(|k| RoofRecord {
            material: 0,
            roof_m: 40.0 + 3.7 * k as f32,
            base_m: 31.0,
            fid: k + 1,
        });
        let code = |cell: usize| match cell.wrapping_mul(2_654_435_761) >> 7 {
            scattered if scattered % one_of == 0 => CellKind::Full(Full::whole(scattered as u32 % 17)).code(),
            _ => 0,
        };
        let cells: Vec<u32> = (0..side * side).map(code).collect();
        let map = BuildingMap::from_raster(CellRaster {
            side,
            texel_m: 1.0,
            cells: cells.clone(),
            vertices: Vec::new(),
            lists: Vec::new(),
            roofs: roofs.collect(),
        });
        (map.ok(), cells)
    }

    #[test]
    fn bounds_hold_on_all_levels_of_tiles_of_any_size() {
        for side in (1..=9).map(|k| 1_usize << k) {
            let (map, cells) = scattered(side, 3);
            let sound = map.filter(BuildingMap::is_sound);
            assert!(sound.is_some(), "side {side}");
            let Some(map) = sound else { continue };
            let low = map.height_range[0];
            let pyramid = Pyramid::from_map(&map, low);
            let step = (pyramid.max_height() - low) / STEPS;
            for level in 1..=Pyramid::top_level(side) {
                let children = Pyramid::children_across(side, level);
                let mut highest = vec![f32::NEG_INFINITY; children * children];
                for (cell, &code) in cells.iter().enumerate() {
                    assert_eq!(
                        map.code(cell % side, cell / side),
                        code,
                        "side {side}, texel {cell}"
                    );
                    let (column, row) = ((cell % side) >> (2 * level), (cell / side) >> (2 * level));
                    let of_child = &mut highest[row * children + column];
                    *of_child = of_child.max(map.highest_roof(code));
                }
                let standing: Vec<_> = pyramid.standing(level).collect();
                let told = highest.iter().filter(|highest| highest.is_finite()).count();
                assert_eq!(standing.len(), told, "side {side}, level {level}");
                for ([column, row], bound) in standing {
                    assert_eq!(pyramid.bound(level, column, row), bound);
                }
                for (child, &highest) in highest.iter().enumerate() {
                    let bound = pyramid.bound(level, child % children, child / children);
                    let holds = highest == bound || (bound >= highest && bound <= highest + step + 1e-3);
                    assert!(
                        holds,
                        "side {side}, level {level}, child {child}: {bound} for {highest}"
                    );
                }
            }
        }
    }

    #[test]
    fn the_part_of_a_square_that_is_built_on_is_that_of_its_blocks() {
        for side in [256, 512] {
            let (map, cells) = scattered(side, 101);
            assert!(map.is_some(), "side {side}");
            let Some(map) = map else { continue };
            let pyramid = Pyramid::from_map(&map, map.height_range[0]);
            let blocks = side / BLOCK;
            let mut is_built = vec![false; blocks * blocks];
            for (cell, &code) in cells.iter().enumerate() {
                is_built[cell / side / BLOCK * blocks + cell % side / BLOCK] |= code != 0;
            }
            let per = blocks / 16;
            let in_square = |k: usize| {
                let block = |b: &usize| (k / 16 * per + b / per) * blocks + k % 16 * per + b % per;
                let built = (0..per * per).filter(|b| is_built[block(b)]).count();
                (255 * built / (per * per)) as u8
            };
            let expected: Vec<u8> = (0..256).map(in_square).collect();
            assert_eq!(pyramid.coverage(16), expected, "side {side}");
            assert!(
                expected.iter().any(|part| *part < 100),
                "the map is too full to tell"
            );
        }
    }
}
