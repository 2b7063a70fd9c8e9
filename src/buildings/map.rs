//! What a building map holds and how its cell codes are read.
//!
//! One `u32` code per texel:
//!
//! | bits 31-30 | meaning | the rest |
//! |---|---|---|
//! | 0 | no building | 0 |
//! | 1 FULL | one roof covers the texel | bits 23-0: building |
//! | 2 RUN | outline vertices first..first+edges are edges that touch the texel | see [`Run`] |
//! | 3 LIST | several of the above | bits 23-0: offset into `lists`: a count, then that many codes |
//!
//! A texel's reference point ([`BuildingMap::REFERENCE`]) lies inside the run's building when its INSIDE bit is
//! set; any other point of the texel is inside when the segment to the reference crosses the run's edges an
//! even (inside) or odd (outside) number of times. That makes the test exact at any texel size.

/// A tile's building map. Local coordinates: metres from the tile's south-west corner.
#[derive(Clone, Debug, PartialEq)]
pub struct BuildingMap {
    /// Texels along a side, a power of two.
    pub side: usize,
    /// Side of a texel, metres.
    pub texel_m: f32,
    /// `side * side` codes, row by row from the south.
    pub cells: Vec<u32>,
    /// Outline vertices; edge e runs from vertex e to e+1.
    pub vertices: Vec<OutlineVertex>,
    /// Lists of codes for texels that need more than one.
    pub lists: Vec<u32>,
    /// Buildings that touch the tile, by ascending id.
    pub roofs: Vec<RoofRecord>,
}

/// A vertex of an outline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutlineVertex {
    /// Metres east of the tile's corner.
    pub x_m: f32,
    /// Metres north of the tile's corner.
    pub y_m: f32,
    /// Length along the outline from the ring's first vertex, metres (the facade coordinate).
    pub along_m: f32,
    /// Index of the building in `roofs`.
    pub building: u32,
}

/// A building's roof.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoofRecord {
    /// Elevation of the flat roof, metres.
    pub roof_m: f32,
    /// Lowest ground at the outline, metres.
    pub base_m: f32,
    /// Id in the footprint dataset of record.
    pub fid: u32,
}

/// A contiguous run of outline edges of one building.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Run {
    /// The texel's reference point is inside the building.
    pub inside: bool,
    /// The next code of the list belongs to the same building.
    pub more: bool,
    /// Number of edges, 1 to 16.
    pub edges: u32,
    /// First vertex.
    pub first: u32,
}

/// A decoded cell code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellKind {
    /// No building.
    Empty,
    /// One roof covers the texel.
    Full(u32),
    /// Outline edges of one building.
    Run(Run),
    /// Offset into `lists`.
    List(u32),
}

/// Where the fields of a cell code lie; shaders get them in their prelude.
pub struct CellFields {
    /// Bits below the kind.
    pub kind_shift: u32,
    /// Kind of a texel under one roof.
    pub full: u32,
    /// Kind of a texel with one run of edges.
    pub run: u32,
    /// Kind of a texel with a list.
    pub list: u32,
    /// The reference point lies inside.
    pub inside_bit: u32,
    /// The next code belongs to the same building.
    pub more_bit: u32,
    /// Bits below the number of edges less one.
    pub edges_shift: u32,
    /// That number's mask.
    pub edges_mask: u32,
    /// Mask of an index.
    pub index_mask: u32,
}

/// The fields.
pub const CELL: CellFields = CellFields {
    kind_shift: 30,
    full: 1,
    run: 2,
    list: 3,
    inside_bit: 1 << 29,
    more_bit: 1 << 28,
    edges_shift: 24,
    edges_mask: 15,
    index_mask: (1 << 24) - 1,
};
/// Indices in a code have 24 bits.
pub const INDEX_LIMIT: usize = CELL.index_mask as usize + 1;

impl CellKind {
    /// Reads a code.
    pub fn from_code(code: u32) -> Self {
        let index = code & CELL.index_mask;
        match code >> CELL.kind_shift {
            0 => Self::Empty,
            kind if kind == CELL.full => Self::Full(index),
            kind if kind == CELL.run => Self::Run(Run {
                inside: code & CELL.inside_bit != 0,
                more: code & CELL.more_bit != 0,
                edges: ((code >> CELL.edges_shift) & CELL.edges_mask) + 1,
                first: index,
            }),
            _ => Self::List(index),
        }
    }

    /// Writes a code.
    pub fn code(self) -> u32 {
        match self {
            Self::Empty => 0,
            Self::Full(building) => (CELL.full << CELL.kind_shift) | building,
            Self::Run(run) => {
                (CELL.run << CELL.kind_shift)
                    | if run.inside { CELL.inside_bit } else { 0 }
                    | if run.more { CELL.more_bit } else { 0 }
                    | ((run.edges - 1) << CELL.edges_shift)
                    | run.first
            }
            Self::List(offset) => (CELL.list << CELL.kind_shift) | offset,
        }
    }
}

impl BuildingMap {
    /// Where in a texel the parity of its outline is known, in texels from its south-west corner. Off the centre
    /// and off the diagonals, because real outlines like to run through those.
    pub const REFERENCE: [f32; 2] = [0.4387, 0.5719];

    /// Farther from sea level than any ground or roof that an import lets in, metres.
    const MAX_ELEVATION_M: f32 = 100_000.0;

    /// Bytes that the map takes on the GPU without its pyramid: a code a texel and a list; a record of 16 bytes and a length
    /// along the outline for every vertex and roof.
    pub fn bytes(&self) -> usize {
        4 * (self.cells.len() + self.lists.len()) + 20 * (self.vertices.len() + self.roofs.len())
    }

    /// Lowest ground under the tile's buildings, metres; infinity without buildings.
    pub fn lowest_base(&self) -> f32 {
        self.roofs
            .iter()
            .map(|roof| roof.base_m)
            .fold(f32::INFINITY, f32::min)
    }

    /// The codes of a cell: itself, or its list.
    pub fn codes(&self, code: u32) -> &[u32] {
        match CellKind::from_code(code) {
            CellKind::List(offset) => {
                let offset = offset as usize;
                let count = self.lists.get(offset).map_or(0, |&count| count as usize);
                self.lists.get(offset + 1..offset + 1 + count).unwrap_or(&[])
            }
            _ => &[],
        }
    }

    /// Building of a code that is a run or full.
    pub fn building_of(&self, code: u32) -> Option<u32> {
        match CellKind::from_code(code) {
            CellKind::Full(building) => Some(building),
            CellKind::Run(run) => Some(self.vertices.get(run.first as usize)?.building),
            _ => None,
        }
    }

    /// The building whose roof shows at a texel's reference point, the highest first; none on open ground.
    pub fn roof_at_reference(&self, cell: usize) -> Option<u32> {
        let code = self.cells[cell];
        let single = [code];
        let codes = match CellKind::from_code(code) {
            CellKind::List(_) => self.codes(code),
            _ => &single[..],
        };
        let mut best: Option<u32> = None;
        let mut continued = false;
        for &code in codes {
            let covers = match CellKind::from_code(code) {
                CellKind::Full(_) => true,
                CellKind::Run(run) => run.inside && !continued,
                _ => false,
            };
            continued = matches!(CellKind::from_code(code), CellKind::Run(run) if run.more);
            let Some(building) = self.building_of(code).filter(|_| covers) else {
                continue;
            };
            let roof = |index: u32| self.roofs[index as usize].roof_m;
            if best.is_none_or(|best| roof(building) > roof(best)) {
                best = Some(building);
            }
        }
        best
    }

    /// Highest roof that touches a texel, metres; negative infinity on open ground.
    pub fn highest_roof(&self, cell: usize) -> f32 {
        let code = self.cells[cell];
        let roof = |code: u32| {
            self.building_of(code)
                .and_then(|building| self.roofs.get(building as usize))
                .map_or(f32::NEG_INFINITY, |record| record.roof_m)
        };
        match CellKind::from_code(code) {
            CellKind::List(_) => self
                .codes(code)
                .iter()
                .map(|&code| roof(code))
                .fold(f32::NEG_INFINITY, f32::max),
            _ => roof(code),
        }
    }

    /// True when every index in the map points inside it: a damaged tile must not reach the shader.
    pub fn is_sound(&self) -> bool {
        let sound_code = |code: u32| match CellKind::from_code(code) {
            CellKind::Empty => false,
            CellKind::Full(building) => (building as usize) < self.roofs.len(),
            CellKind::Run(run) => ((run.first + run.edges) as usize) < self.vertices.len(),
            CellKind::List(_) => false,
        };
        let sound_cell = |code: u32| match CellKind::from_code(code) {
            CellKind::Empty => code == 0,
            CellKind::List(offset) => {
                let count = self.lists.get(offset as usize).copied().unwrap_or(u32::MAX);
                let codes = self.codes(code);
                let ends = |pair: &[u32]| match (CellKind::from_code(pair[0]), CellKind::from_code(pair[1])) {
                    (CellKind::Run(run), next) if run.more => {
                        matches!(next, CellKind::Run(_))
                            && self.building_of(pair[0]) == self.building_of(pair[1])
                    }
                    _ => true,
                };
                !codes.is_empty()
                    && codes.len() == count as usize
                    && codes.iter().all(|&code| sound_code(code))
                    && codes.windows(2).all(ends)
            }
            _ => sound_code(code),
        };
        self.side.is_power_of_two()
            && self.cells.len() == self.side * self.side
            && self.cells.iter().all(|&code| sound_cell(code))
            && self
                .vertices
                .iter()
                .all(|vertex| (vertex.building as usize) < self.roofs.len())
            && self.roofs.iter().all(|roof| {
                roof.roof_m.abs() < Self::MAX_ELEVATION_M && roof.base_m.abs() < Self::MAX_ELEVATION_M
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_read_back_as_written() {
        for kind in [
            CellKind::Empty,
            CellKind::Full(77),
            CellKind::Run(Run {
                inside: true,
                more: false,
                edges: 16,
                first: 123_456,
            }),
            CellKind::Run(Run {
                inside: false,
                more: true,
                edges: 1,
                first: 0,
            }),
            CellKind::List(9_999_999),
        ] {
            assert_eq!(CellKind::from_code(kind.code()), kind);
        }
    }
}
