//! What the window shows: pose, optics and sun, and the frame request that follows.

use std::sync::Arc;

use glam::DVec3;

use super::pace::{FRAMES_PER_S, MAX_SAMPLES};
use super::{Clock, Navigator};
use crate::camera::flare::{Aperture, Quality};
use crate::camera::lens::{BUILT_IN, Lens, built_in};
use crate::camera::{Camera, FULL_FRAME_MM, LensOptics, Optics};
use crate::output::{FlareSettings, FlightView, PathKey};
use crate::relief::ReliefSettings;
use crate::scene::TileSet;
use crate::space::{Place, Pose, Projection, Sun, SunError};

/// State of the view.
pub struct SceneState {
    /// Where the camera is.
    pub navigator: Navigator,
    /// What makes its image.
    pub optics: Optics,
    /// What the lens adds.
    pub flare: Option<FlareSettings>,
    /// Date and time.
    pub clock: Clock,
    /// The sun at that time.
    pub sun: Sun,
    /// Factor on radiance, in stops.
    pub exposure_stops: f32,
    /// How the city is drawn.
    pub relief: ReliefSettings,
    /// Whether the lens's flare is drawn.
    pub shows_flare: bool,
    /// Whether time flies.
    pub is_time_lapse: bool,
    /// Samples that a resting image gets.
    pub max_samples: u32,
    /// Frames a second to hold while the camera moves.
    pub frames_per_s: f64,
}

/// Field of view of the pinhole, radians.
const PINHOLE_FOV_Y: f64 = 0.8727;
/// The first view: how far from the city's centre by its smaller extent, and how steep (tangent).
const FIRST_DISTANCE: f64 = 0.35;
const FIRST_SLOPE: f64 = 0.45;

impl SceneState {
    /// A view with what flies through the city by itself.
    pub fn new(
        navigator: Navigator,
        optics: Optics,
        flare: Option<FlareSettings>,
        clock: Clock,
    ) -> Result<Self, SunError> {
        Ok(Self {
            navigator,
            optics,
            flare,
            sun: clock.sun()?,
            clock,
            exposure_stops: 0.0,
            relief: ReliefSettings::default(),
            shows_flare: true,
            is_time_lapse: false,
            max_samples: MAX_SAMPLES,
            frames_per_s: FRAMES_PER_S,
        })
    }

    /// The view as a key of a flight.
    pub fn key(&self, size: [u32; 2]) -> PathKey {
        let (camera, pose) = (self.camera(), self.navigator.pose);
        PathKey {
            eye: pose.eye.to_array(),
            look: (pose.eye + 100.0 * pose.forward).to_array(),
            fov: Some(camera.fov_y(size).to_degrees()),
            time: Some(self.clock.rfc3339()),
            f_number: camera.lens().map(|lens| lens.f_number),
            exposure: Some(f64::from(self.exposure_stops.exp2())),
            ..PathKey::default()
        }
    }

    /// Shows a view of a flight.
    pub fn set_view(&mut self, view: &FlightView, place: Place) -> Result<(), SunError> {
        self.navigator.pose = view.pose();
        self.optics = view.camera(&self.optics).optics;
        self.exposure_stops = view.exposure_or(self.exposure_stops.exp2()).log2();
        self.sun = view.sun_or(self.sun, place)?;
        if let Some(instant) = view.instant {
            self.clock.set(instant);
        }
        Ok(())
    }

    /// The camera.
    pub fn camera(&self) -> Camera {
        Camera {
            pose: self.navigator.pose,
            optics: self.optics.clone(),
        }
    }

    /// The camera's projection on an image.
    pub fn projection(&self, size: [u32; 2]) -> Projection {
        self.camera().projection(size)
    }

    /// The name of the lens, none for the pinhole.
    pub fn lens_name(&self) -> Option<&str> {
        match &self.optics {
            Optics::Pinhole { .. } => None,
            Optics::Lens(lens) => Some(&lens.lens.name),
        }
    }

    /// Puts the pinhole in.
    pub fn use_pinhole(&mut self) {
        self.optics = Optics::Pinhole { fov_y: PINHOLE_FOV_Y };
        self.flare = None;
    }

    /// Puts a lens in at an f-number.
    pub fn use_lens(&mut self, lens: Arc<Lens>, f_number: f64) {
        self.optics = Optics::Lens(LensOptics::new(lens, f_number, FULL_FRAME_MM));
        self.flare = Some(FlareSettings::from_preset(
            Quality::Low.preset(),
            Aperture::default(),
        ));
    }
}

/// The lenses to choose from.
pub fn lenses() -> Vec<Arc<Lens>> {
    let lenses = BUILT_IN.iter().filter_map(|(name, _)| built_in(name)?.ok());
    lenses.map(Arc::new).collect()
}

/// A first view of a city: from the south-west, down on its centre.
pub fn first_pose(tiles: &TileSet) -> Pose {
    let bounds = tiles.grid.bounds();
    let centre = bounds.centre();
    let distance = FIRST_DISTANCE * bounds.width().min(bounds.height());
    let ground = tiles.ground_at(centre).unwrap_or(0.0);
    let offset = DVec3::new(-0.6, -0.8, FIRST_SLOPE) * distance;
    let target = centre.extend(ground);
    Pose::looking_at(target + offset, target)
}
