//! Flags of a flare, shared by `render` and `lens flare`.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::CommandError;
use crate::camera::flare::{
    Aperture, Blend, Fit, FlareMode, GhostParameters, GhostTable, Preset, Quality, open_table,
};
use crate::camera::lens::Lens;
use crate::output::FlareSettings;

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
    /// How ghosts are made, instead of as the quality has it.
    #[arg(long = "flare", visible_alias = "mode", value_enum, requires = "lens")]
    mode: Option<FlareMode>,
    /// How linear and nonlinear ghosts come together in the blended mode.
    #[arg(long, value_enum, default_value = "add", requires = "lens")]
    pub blend: Blend,
    /// What of the nonlinear ghosts is fitted to the linear ones.
    #[arg(long, value_enum, value_delimiter = ',', requires = "lens")]
    fit: Vec<Fitted>,
    /// Draw from a table that `rilievo lens bake` made.
    #[arg(long, requires = "lens")]
    flare_table: Option<PathBuf>,
    /// Of a table that holds traced and photographed ghosts, draw the photographed ones.
    #[arg(long, requires = "flare_table")]
    pub photographed: bool,
}

impl FlareFlags {
    /// The asked quality's row, or the one of `default`, in the asked mode.
    pub fn preset(&self, default: Quality) -> Preset {
        let row = self.quality.unwrap_or(default).preset();
        // A table is what the blended mode draws from.
        let own = if self.flare_table.is_some() {
            FlareMode::Blended
        } else {
            row.mode
        };
        Preset {
            mode: self.mode.unwrap_or(own),
            ..row
        }
    }

    /// The file of the asked table.
    pub fn table_file(&self) -> Option<&Path> {
        self.flare_table.as_deref()
    }

    /// Whether a quality was asked for.
    pub fn has_quality(&self) -> bool {
        self.quality.is_some()
    }

    /// The asked table of a lens at an f-number.
    ///
    /// # Errors
    /// When it does not fit the lens or the other flags.
    pub fn table(
        &self,
        lens: &Lens,
        f_number: f64,
        aperture: Aperture,
    ) -> Result<Option<GhostTable>, CommandError> {
        let Some(path) = &self.flare_table else {
            return Ok(None);
        };
        if self.mode.is_some_and(|mode| mode != FlareMode::Blended) {
            return Err(CommandError::Argument(
                "--flare-table is for the blended mode; leave out --flare (--mode)".to_owned(),
            ));
        }
        let table = open_table(path, lens, f_number)?;
        if self.photographed && table.photographed.is_none() {
            return Err(CommandError::Argument(format!(
                "{}: holds no photographed ghosts; leave out --photographed",
                path.display()
            )));
        }
        if let Some(drawn) = table
            .aperture()
            .filter(|drawn| !drawn.has_shape_of(&aperture) && !self.photographed)
        {
            return Err(CommandError::Argument(format!(
                "{}: its images show an iris of {} blades; give --blades {}",
                path.display(),
                drawn.blades,
                drawn.blades
            )));
        }
        if table.plays_images(self.photographed) && (self.blend != Blend::Add || !self.fit.is_empty()) {
            return Err(CommandError::Argument(format!(
                "{}: holds images, which can only be added; leave out --blend and --fit",
                path.display()
            )));
        }
        Ok(Some(table))
    }

    /// What a lens at an f-number adds to an image; without `ghosts` its starburst alone.
    ///
    /// # Errors
    /// When the asked table does not fit.
    pub fn settings(
        &self,
        lens: &Lens,
        f_number: f64,
        aperture: Aperture,
        ghosts: bool,
    ) -> Result<FlareSettings, CommandError> {
        let preset = self.preset(Quality::High);
        Ok(FlareSettings {
            aperture,
            ghosts: ghosts.then(|| GhostParameters {
                blend: self.blend,
                fit: self.fit(),
                photographed: self.photographed,
                ..preset.ghosts()
            }),
            starburst: preset.starburst(),
            table: self.table(lens, f_number, aperture)?.map(Arc::new),
        })
    }

    /// The asked fits.
    pub fn fit(&self) -> Fit {
        Fit {
            size: self.fit.contains(&Fitted::Size),
            brightness: self.fit.contains(&Fitted::Brightness),
        }
    }
}
