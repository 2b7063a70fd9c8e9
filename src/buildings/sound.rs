//! Whether a building map from a file may go to a shader.

use super::BuildingMap;
use super::cell::{CellKind, MAX_EDGES, MAX_LIST, MAX_LIST_EDGES};
use super::map::{TEXEL_EMPTY, TEXEL_MAIN, TEXEL_OWN, TEXELS};
use crate::material::BuildingMaterial;

/// Farther from sea level than any ground or roof that an import lets in, metres.
const MAX_ELEVATION_M: f32 = 100_000.0;

impl BuildingMap {
    /// True when every index in the map points inside it: a damaged tile must not reach the shader.
    pub fn is_sound(&self) -> bool {
        self.side.is_power_of_two()
            && self.side <= Self::MAX_SIDE
            && self.has_sound_index()
            && self.has_lists_of_its_size()
            && self.blocks().all(|(_, block)| {
                self.stored_codes(&block)
                    .iter()
                    .all(|&code| self.is_sound_cell(code))
            })
            && self.vertices.iter().all(|vertex| {
                (vertex.building as usize) < self.roofs.len()
                    && vertex.bays.is_finite()
                    && vertex.x_m.is_finite()
                    && vertex.y_m.is_finite()
            })
            && self
                .roofs
                .iter()
                .all(|roof| BuildingMaterial::is_code(roof.material))
            && self
                .roofs
                .iter()
                .all(|roof| roof.roof_m.abs() < MAX_ELEVATION_M && roof.base_m.abs() < MAX_ELEVATION_M)
            && Self::is_sound_range(self.height_range)
            && (self.roofs.iter()).all(|roof| roof.roof_m <= self.height_range[1])
    }

    /// Whether a lowest ground and a highest roof are of this planet.
    pub fn is_sound_range([lowest, highest]: [f32; 2]) -> bool {
        lowest.abs() < MAX_ELEVATION_M && highest.abs() < MAX_ELEVATION_M
    }

    /// The entries follow one another and each is a FULL code or a record inside the words.
    fn has_sound_index(&self) -> bool {
        let groups = Self::groups_across(self.side).pow(2);
        let Some(index) = self.words.get(..groups) else {
            return false;
        };
        let mut entries = 0_usize;
        for word in index {
            if (word >> 16) as usize != entries & 0xffff {
                return false;
            }
            entries += (word & 0xffff).count_ones() as usize;
        }
        let entries = groups..groups + entries;
        let is_full = |code: u32| matches!(CellKind::from_code(code), CellKind::Full(_));
        let is_sound_entry = |&entry: &u32| match CellKind::from_code(entry) {
            CellKind::Full(full) => (full.building as usize) < self.roofs.len(),
            CellKind::List(place) => {
                let header = self.word(place as usize);
                let count = |kind: u32| (0..TEXELS).filter(move |texel| (header >> (2 * texel)) & 3 == kind);
                let length = 1 + count(TEXEL_MAIN).count().min(1) + count(TEXEL_OWN).count();
                place as usize >= entries.end
                    && place as usize + length <= self.words.len()
                    && count(3).count() == 0
                    && (count(TEXEL_MAIN).count() == 0 || is_full(self.word(place as usize + 1)))
                    && count(TEXEL_EMPTY).count() < TEXELS
            }
            _ => false,
        };
        self.words
            .get(entries.clone())
            .is_some_and(|entries| entries.iter().all(is_sound_entry))
    }

    /// Whether the lists that cells name are together no longer than the words: each is named once. Many cells that name one long list
    /// would cost a reader and a ray their product, and so would codes that all name one outline.
    fn has_lists_of_its_size(&self) -> bool {
        let (mut left, mut edges_left) = (self.words.len(), MAX_EDGES);
        for (_, block) in self.blocks() {
            for &code in self.stored_codes(&block) {
                let CellKind::List(place) = CellKind::from_code(code) else {
                    continue;
                };
                let length = 1 + self.word(place as usize) as usize;
                match left.checked_sub(length) {
                    Some(rest) if length <= 1 + MAX_LIST => left = rest,
                    _ => return false,
                }
                let edges = self
                    .codes(code)
                    .iter()
                    .map(|&code| match CellKind::from_code(code) {
                        CellKind::Run(run) => run.edges as usize,
                        _ => 0,
                    });
                let edges = edges.sum::<usize>();
                match edges_left.checked_sub(edges) {
                    Some(rest) if edges <= MAX_LIST_EDGES => edges_left = rest,
                    _ => return false,
                }
            }
        }
        true
    }

    fn is_sound_cell(&self, code: u32) -> bool {
        let sound_code = |code: u32| match CellKind::from_code(code) {
            CellKind::Full(full) => (full.building as usize) < self.roofs.len(),
            CellKind::Run(run) => ((run.first + run.edges) as usize) < self.vertices.len(),
            CellKind::Empty | CellKind::List(_) => false,
        };
        match CellKind::from_code(code) {
            CellKind::Empty => code == 0,
            CellKind::List(place) => {
                let codes = self.codes(code);
                let continues =
                    |pair: &[u32]| match (CellKind::from_code(pair[0]), CellKind::from_code(pair[1])) {
                        (CellKind::Run(run), next) if run.more => {
                            matches!(next, CellKind::Run(_))
                                && self.building_of(pair[0]) == self.building_of(pair[1])
                        }
                        _ => true,
                    };
                !codes.is_empty()
                    && codes.len() == self.word(place as usize) as usize
                    && codes.iter().all(|&code| sound_code(code))
                    && codes.windows(2).all(continues)
            }
            _ => sound_code(code),
        }
    }
}
