//! The pyramid of maxima over the roof elevations: what of a block a ray stays above is skipped in one read (maximum
//! mipmaps: Tevs, Ihrke & Seidel 2008).
//!
//! A node has 4 x 4 children and is one read of 16 bytes, a byte a child: the image takes 1.25 bytes a texel (a seventh of it is
//! empty), and a ray meets half as many nodes as in a pyramid of 2 x 2. Level 0 has texels for children, every level above nodes of the
//! level below.

use super::BuildingMap;

/// Highest roofs of a tile.
#[derive(Clone, Debug)]
pub struct Pyramid {
    /// Texels along the tile's side, a power of two.
    side: usize,
    /// Elevation that byte 1 stands for, metres.
    low: f32,
    /// Elevation that byte 255 stands for: the tile's highest roof, metres; negative infinity without buildings.
    high: f32,
    /// Nodes as an image of [`Pyramid::image_size`]: element r has row r of children from the south, its lowest byte the
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
        let mut below: Vec<f32> = (0..map.cells.len()).map(|cell| map.highest_roof(cell)).collect();
        let high = below.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        let mut pyramid = Self {
            side: map.side,
            low,
            high,
            nodes: Vec::new(),
        };
        let [width, height] = Self::image_size(map.side);
        pyramid.nodes.resize(width * height, [0; 4]);
        for level in 0..=Self::top_level(map.side) {
            let across = Self::nodes_across(map.side, level);
            let mut maxima = vec![f32::NEG_INFINITY; across * across];
            let children = map.side >> (2 * level);
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
        side.ilog2() / 2
    }

    /// Nodes along a tile's side.
    fn nodes_across(side: usize, level: u32) -> usize {
        (side >> (2 * level + 2)).max(1)
    }

    /// Width and height of the image of all nodes: level 0 below, the levels above it side by side on top.
    pub fn image_size(side: usize) -> [usize; 2] {
        let width = Self::nodes_across(side, 0);
        [width, width + (width / CHILDREN).max(1)]
    }

    /// Bytes of the image.
    pub fn bytes(side: usize) -> usize {
        let [width, height] = Self::image_size(side);
        size_of::<[u32; 4]>() * width * height
    }

    /// Place of a node in the image.
    fn place(&self, level: u32, [column, row]: [usize; 2]) -> usize {
        let width = Self::nodes_across(self.side, 0);
        let [x, y] = match level {
            0 => [0, 0],
            // width / 4 + width / 16 + .. of the levels between.
            _ => [(width - (width >> (2 * level - 2))) / 3, width],
        };
        (y + row) * width + x + column
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

    /// The tile's lowest ground, metres.
    pub fn min_height(&self) -> f32 {
        self.low
    }

    /// Highest roof of the tile, metres; negative infinity without buildings.
    pub fn max_height(&self) -> f32 {
        self.high
    }

    /// The image of all nodes, row by row.
    pub fn nodes(&self) -> &[[u32; 4]] {
        &self.nodes
    }

    fn bound_of(&self, byte: u8) -> f32 {
        match byte {
            0 => f32::NEG_INFINITY,
            _ => self.low + (f32::from(byte) - 1.0) * self.step_m(),
        }
    }

    /// A bound on the roofs of one child (level 0: a texel), metres: no lower than the highest, and at most a step above it; negative
    /// infinity where no building is.
    pub fn bound(&self, level: u32, column: usize, row: usize) -> f32 {
        let node = self.nodes[self.place(level, [column / CHILDREN, row / CHILDREN])];
        let byte = (node[row % CHILDREN] >> (8 * (column % CHILDREN))) & 255;
        self.bound_of(byte as u8)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::buildings::{CellKind, RoofRecord};

    /// A third of the texels has a roof of one of 17 elevations.
    fn scattered(side: usize) -> BuildingMap {
        let roofs = (0..17).map(|k| RoofRecord {
            roof_m: 40.0 + 3.7 * k as f32,
            base_m: 31.0,
            fid: k + 1,
        });
        let code = |cell: usize| match cell.wrapping_mul(2_654_435_761) >> 7 {
            scattered if scattered % 3 == 0 => CellKind::Full(scattered as u32 % 17).code(),
            _ => 0,
        };
        BuildingMap {
            side,
            texel_m: 1.0,
            cells: (0..side * side).map(code).collect(),
            vertices: Vec::new(),
            lists: Vec::new(),
            roofs: roofs.collect(),
        }
    }

    #[test]
    fn bounds_hold_on_all_levels_of_tiles_of_any_size() {
        for side in (1..=9).map(|k| 1_usize << k) {
            let map = scattered(side);
            let low = map.lowest_base();
            let pyramid = Pyramid::from_map(&map, low);
            let step = (pyramid.max_height() - low) / STEPS;
            for level in 0..=Pyramid::top_level(side) {
                let children = side >> (2 * level);
                assert!(children >= 1, "side {side}, level {level}");
                let mut highest = vec![f32::NEG_INFINITY; children * children];
                for cell in 0..map.cells.len() {
                    let (column, row) = ((cell % side) >> (2 * level), (cell / side) >> (2 * level));
                    let of_child = &mut highest[row * children + column];
                    *of_child = of_child.max(map.highest_roof(cell));
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
}
