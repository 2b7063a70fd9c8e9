//! Flags of a flare, shared by `render` and `lens flare`.

use std::path::PathBuf;

use crate::camera::flare::{Blend, Fit, FlareMode, Preset, Quality};

/// What of a nonlinear ghost is fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Fitted {
    /// Its size on the sensor.
    Size,
    /// Its light.
    Brightness,
}

/// How ghosts are made and blended.
#[derive(Debug, clap::Args)]
pub struct FlareFlags {
    /// What the flare may cost: a row of the table of presets.
    #[arg(long, value_enum, requires = "lens")]
    quality: Option<Quality>,
    /// How ghosts are made, instead of the quality's way.
    #[arg(long = "flare", visible_alias = "mode", value_enum, requires = "lens")]
    mode: Option<FlareMode>,
    /// How linear and nonlinear ghosts come together in the blended mode.
    #[arg(long, value_enum, default_value = "add", requires = "lens")]
    pub blend: Blend,
    /// What of the nonlinear ghosts is fitted to the linear ones.
    #[arg(long, value_enum, value_delimiter = ',', requires = "lens")]
    fit: Vec<Fitted>,
    /// Play a table that `rilievo lens bake` made.
    #[arg(long, requires = "lens")]
    pub flare_table: Option<PathBuf>,
}

impl FlareFlags {
    /// The asked quality's row, or the one of `default`, in the asked mode.
    pub fn preset(&self, default: Quality) -> Preset {
        let row = self.quality.unwrap_or(default).preset();
        Preset {
            mode: self.mode.unwrap_or(row.mode),
            ..row
        }
    }

    /// The asked fits.
    pub fn fit(&self) -> Fit {
        Fit {
            size: self.fit.contains(&Fitted::Size),
            brightness: self.fit.contains(&Fitted::Brightness),
        }
    }
}
