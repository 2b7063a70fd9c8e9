//! Flags of how a city is drawn, shared by `render` and `film`.

use super::search_flags::SearchFlags;
use crate::relief::{Layers, ReliefMode, ReliefSettings};

/// A layer of the city.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Hidden {
    /// Buildings, with their shadows.
    Buildings,
    /// Facades and roofs: plaster instead.
    Facades,
    /// Orthophotos, and what is drawn on the ground.
    Imagery,
    /// Streets guessed from the gaps between buildings.
    Streets,
}

/// How the city is drawn.
#[derive(Clone, Debug, clap::Args)]
pub struct ReliefFlags {
    /// How buildings are drawn.
    #[arg(long, value_enum, default_value = "exact")]
    pub relief: ReliefMode,
    #[command(flatten)]
    search: SearchFlags,
    /// Layers that are left out.
    #[arg(long, value_enum, value_delimiter = ',')]
    hide: Vec<Hidden>,
}

impl ReliefFlags {
    /// As the relief pass takes them.
    pub fn settings(&self) -> ReliefSettings {
        let shows = |layer: Hidden| !self.hide.contains(&layer);
        ReliefSettings {
            mode: self.relief,
            search: self.search.parameters(),
            layers: Layers {
                buildings: shows(Hidden::Buildings),
                facades: shows(Hidden::Facades),
                imagery: shows(Hidden::Imagery),
                streets: shows(Hidden::Streets),
            },
        }
    }
}
