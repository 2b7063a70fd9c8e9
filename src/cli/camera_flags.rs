//! Flags of the camera and its light, shared by the commands that draw a city.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::CommandError;
use super::flare_flags::FlareFlags;
use crate::camera::flare::Aperture;
use crate::camera::lens::open;
use crate::camera::{Camera, FULL_FRAME_MM, LensOptics, Optics, require_f_number};
use crate::output::FlareSettings;
use crate::space::{Place, Pose, Sun};

/// The camera's optics.
#[derive(Debug, clap::Args)]
pub struct CameraFlags {
    /// Vertical field of view, degrees [default: 60, or what the lens gives]. Behind a lens it crops the image.
    #[arg(long, value_parser = super::values::field_of_view)]
    fov: Option<f64>,
    /// Take the image through a lens, with the sun's flare: a built-in name (`rilievo lens list`) or a file.
    #[arg(long)]
    lens: Option<String>,
    /// Width and height of the sensor behind the lens, millimetres [default: 36x24].
    #[arg(long, value_parser = super::values::sensor, requires = "lens")]
    sensor: Option<[f64; 2]>,
    /// The lens's f-number.
    #[arg(long, default_value_t = 8.0, value_parser = super::lens_flags::f_number, requires = "lens")]
    f_number: f64,
    /// Blades of its iris; fewer than 3 are a circle.
    #[arg(long, default_value_t = 8, requires = "lens")]
    blades: u32,
    /// Specks and scratches on its glass.
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=1000), requires = "lens")]
    dirt: u32,
    #[command(flatten)]
    flare: FlareFlags,
    /// Ghosts: --ghosts false leaves the sun's image and its starburst alone.
    #[arg(long, default_value_t = true, action = clap::ArgAction::Set, requires = "lens")]
    ghosts: bool,
}

/// Field of view of a pinhole where nothing else is said, degrees.
const DEFAULT_FOV_DEG: f64 = 60.0;

impl CameraFlags {
    /// The camera at a pose, for images of `size` pixels.
    ///
    /// # Errors
    /// When the lens cannot be read, or cannot give the field of view.
    pub fn camera(&self, pose: Pose, size: [u32; 2]) -> Result<Camera, CommandError> {
        let Some(name) = &self.lens else {
            let fov_deg = self.fov.unwrap_or(DEFAULT_FOV_DEG);
            return Ok(Camera::pinhole(pose, fov_deg.to_radians()));
        };
        let sensor_mm = self.sensor.unwrap_or(FULL_FRAME_MM);
        let lens = Arc::new(open(name)?);
        require_f_number(&lens, self.f_number)?;
        let mut optics = LensOptics::new(lens, self.f_number, sensor_mm);
        let max_fov = optics.max_fov_y(size);
        // A thousandth of a degree is how the largest is written.
        if let Some(fov) = self.fov
            && fov.to_radians() > max_fov + 1e-3_f64.to_radians()
        {
            let [width, height] = sensor_mm;
            return Err(CommandError::Argument(format!(
                "--fov {fov}: {} ({:.1} mm) on a {width} x {height} mm sensor gives {:.3} degrees at most; leave out --fov, \
                 or name a larger --sensor",
                optics.lens.name,
                optics.focal_mm,
                max_fov.to_degrees()
            )));
        }
        optics.crop_fov_y = self.fov.map(f64::to_radians);
        Ok(Camera {
            pose,
            optics: Optics::Lens(optics),
        })
    }

    /// Files that the image depends on: the lens's, where it is none of the built-in ones, and the flare's table.
    pub fn files(&self) -> Vec<PathBuf> {
        let lens = self.lens.iter().map(PathBuf::from).filter(|path| path.is_file());
        lens.chain(self.flare.table_file().map(Path::to_owned)).collect()
    }

    /// What the camera's lens adds; none without a lens.
    ///
    /// # Errors
    /// When the flare's table does not fit.
    pub fn flare(&self, camera: &Camera) -> Result<Option<FlareSettings>, CommandError> {
        let Some(optics) = camera.lens() else {
            return Ok(None);
        };
        let aperture = Aperture {
            blades: self.blades,
            dirt: self.dirt,
            ..Aperture::default()
        };
        self.flare
            .settings(&optics.lens, self.f_number, aperture, self.ghosts)
            .map(Some)
    }
}

/// The sun at an RFC 3339 time over a place, or a pleasant one.
///
/// # Errors
/// When the text is no time.
pub fn sun(time: Option<&str>, place: Place) -> Result<Sun, CommandError> {
    match time {
        Some(time) => {
            Sun::at_time(time, place).map_err(|error| CommandError::Argument(format!("--time: {error}")))
        }
        None => Ok(Sun::from_azimuth_altitude(225.0, 42.0)),
    }
}
