//! The code of one texel of a building map, 32 bits:
//!
//! | bits 31-30 | meaning | the rest |
//! |---|---|---|
//! | 0 | no building | 0 |
//! | 1 FULL | one roof covers the texel, or on coarse levels a part of it | bits 29-24: the part, 63 for all; bits 23-0: building |
//! | 2 RUN | outline vertices first..first+edges are edges that touch the texel | see [`Run`] |
//! | 3 LIST | several of the above | bits 23-0: where the list begins in the map's words: a count, then that many codes |
//!
//! A roof that covers less than half of a texel does not show (bit 29 is not set); the next coarser level counts it.
//!
//! A texel's reference point ([`BuildingMap::REFERENCE`](super::BuildingMap::REFERENCE)) lies inside the run's building when its
//! INSIDE bit is set; any other point of the texel is inside when the segment to the reference crosses the run's edges an even
//! (inside) or odd (outside) number of times. That makes the test exact at any texel size.

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

/// A roof on a texel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Full {
    /// The building.
    pub building: u32,
    /// The part of the texel that buildings cover, 1 to [`Full::WHOLE`].
    pub coverage: u32,
}

impl Full {
    /// The coverage of a whole texel.
    pub const WHOLE: u32 = 63;

    /// A building that covers the texel.
    pub fn whole(building: u32) -> Self {
        Self {
            building,
            coverage: Self::WHOLE,
        }
    }

    /// True when the roof shows: it covers half the texel or more.
    pub fn is_shown(self) -> bool {
        2 * self.coverage > Self::WHOLE
    }
}

/// A decoded cell code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellKind {
    /// No building.
    Empty,
    /// A roof covers the texel, or a part of it.
    Full(Full),
    /// Outline edges of one building.
    Run(Run),
    /// Where the list begins in the map's words.
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
    /// The reference point lies inside; a FULL code's roof shows.
    pub inside_bit: u32,
    /// Bits below a FULL code's coverage.
    pub coverage_shift: u32,
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
    coverage_shift: 24,
    more_bit: 1 << 28,
    edges_shift: 24,
    edges_mask: 15,
    index_mask: (1 << 24) - 1,
};
/// Fewer vertices, roofs and words than these a map has: ten times those of the densest tile that was met, and few enough to be
/// held. (Indices in a code have 24 bits.)
pub const INDEX_LIMIT: usize = 1 << 21;
/// Most codes in a texel's list: a ray through it tests them all.
pub const MAX_LIST: usize = 1 << 9;
/// Most edges in a texel's list.
pub const MAX_LIST_EDGES: usize = 1 << 10;
/// Most edges in all lists of a map: two for each texel that there is on most tiles.
pub const MAX_EDGES: usize = 1 << 19;

impl CellKind {
    /// Reads a code.
    pub fn from_code(code: u32) -> Self {
        let index = code & CELL.index_mask;
        match code >> CELL.kind_shift {
            0 => Self::Empty,
            kind if kind == CELL.full => Self::Full(Full {
                building: index,
                coverage: (code >> CELL.coverage_shift) & Full::WHOLE,
            }),
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
            Self::Full(full) => {
                (CELL.full << CELL.kind_shift) | (full.coverage << CELL.coverage_shift) | full.building
            }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_read_back_as_written() {
        for kind in [
            CellKind::Empty,
            CellKind::Full(Full::whole(77)),
            CellKind::Full(Full {
                building: 3,
                coverage: 31,
            }),
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
