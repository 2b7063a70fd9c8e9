//! Flags of the search of KR 10-0738500.

use crate::relief::SearchParameters;

/// How `--relief search` searches.
#[derive(Clone, Copy, Debug, clap::Args)]
pub struct SearchFlags {
    /// Slices of the volume that the search goes down through.
    #[arg(long, default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..=4096))]
    slices: u32,
    /// Halvings between the last two slices.
    #[arg(long, default_value_t = 8, value_parser = clap::value_parser!(u32).range(0..=32))]
    refinements: u32,
    /// A surface that rises by more than this over the slice above it is a wall, metres.
    #[arg(long, default_value_t = 1.0, value_parser = delta)]
    delta: f32,
}

fn delta(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(metres) if (0.0..1e6).contains(&metres) => Ok(metres),
        _ => Err("give a number of metres, 0 or more".to_owned()),
    }
}

impl SearchFlags {
    /// As the relief pass takes them.
    pub fn parameters(self) -> SearchParameters {
        SearchParameters {
            slices: self.slices,
            refinements: self.refinements,
            delta: self.delta,
            padding: 0,
        }
    }
}
