//! How a city is drawn: the way of its buildings, and which of its layers.

use super::search_parameters::SearchParameters;

/// How buildings are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum ReliefMode {
    /// Out of the building map, by an exact walk.
    Exact,
    /// Out of the building map, by the search of KR 10-0738500 in slices.
    Search,
    /// As triangles of the footprint dataset: ground truth and yardstick.
    Polygons,
}

/// What of a city is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layers {
    /// Buildings, with their shadows.
    pub buildings: bool,
    /// Facades and roofs; without them plain walls.
    pub facades: bool,
    /// Orthophotos, and what is drawn on the ground.
    pub imagery: bool,
    /// Streets guessed from the gaps between buildings, where the ground is bare.
    pub streets: bool,
}

impl Default for Layers {
    fn default() -> Self {
        Self {
            buildings: true,
            facades: true,
            imagery: true,
            streets: true,
        }
    }
}

impl Layers {
    /// Bits of the layers that shaders hide; they have them as `HIDES_BUILDINGS` and so on.
    pub const HIDDEN_BITS: [u32; 3] = [1, 2, 4];

    /// The bits of those that are hidden.
    pub fn hidden(self) -> u32 {
        let shown = [self.buildings, self.facades, self.imagery];
        let bits = shown.into_iter().zip(Self::HIDDEN_BITS);
        bits.filter(|(is_shown, _)| !is_shown).map(|(_, bit)| bit).sum()
    }
}

/// How a city is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReliefSettings {
    /// How buildings are drawn.
    pub mode: ReliefMode,
    /// How `ReliefMode::Search` searches.
    pub search: SearchParameters,
    /// What is drawn.
    pub layers: Layers,
}

impl Default for ReliefSettings {
    fn default() -> Self {
        Self {
            mode: ReliefMode::Exact,
            search: SearchParameters::default(),
            layers: Layers::default(),
        }
    }
}
