//! One frame of a film: a still whose samples may be spread over the time that the shutter is open.

use super::{Flight, FlightView};
use crate::camera::{Camera, Optics};
use crate::output::{FlareSettings, FrameRequest, RenderError, Renderer, Still};
use crate::relief::ReliefSettings;
use crate::space::Sun;

/// What all frames of a film share.
#[derive(Clone, Debug)]
pub struct FilmFrame<'a> {
    /// The flight.
    pub flight: &'a Flight,
    /// Frames a second.
    pub frames_per_s: f64,
    /// Pixels.
    pub size: [u32; 2],
    /// Samples a pixel.
    pub samples: u32,
    /// The part of a frame's time that the shutter is open, 0 to 1: motion blur.
    pub shutter: f64,
    /// Whether frames have linear radiance beside what is displayed.
    pub with_radiance: bool,
    /// How the city is drawn.
    pub relief: ReliefSettings,
    /// What makes the image, where the flight does not say.
    pub optics: &'a Optics,
    /// What the lens adds.
    pub flare: Option<&'a FlareSettings>,
    /// Factor on the light before tone mapping, where the flight does not say.
    pub exposure: f32,
}

impl FilmFrame<'_> {
    /// The view of a frame as its shutter opens.
    pub fn view(&self, frame: u32) -> FlightView {
        self.flight.at(self.flight.frame_time(frame, self.frames_per_s))
    }

    /// Draws a frame: every tile that it needs is waited for.
    ///
    /// # Errors
    /// When the device fails.
    pub fn draw(&self, renderer: &mut Renderer, frame: u32, sun: &Sun) -> Result<Still, RenderError> {
        let view = self.view(frame);
        let samples = self.samples.max(1);
        let opening = self.flight.frame_time(frame, self.frames_per_s);
        let cameras: Vec<Camera> = (0..samples)
            .map(|sample| {
                if self.shutter <= 0.0 {
                    return view.camera(self.optics);
                }
                let part = (f64::from(sample) + 0.5) / f64::from(samples);
                self.flight
                    .at(opening + self.shutter * part / self.frames_per_s)
                    .camera(self.optics)
            })
            .collect();
        let requests: Vec<FrameRequest<'_>> = cameras
            .iter()
            .map(|camera| FrameRequest {
                camera,
                sun,
                size: self.size,
                relief: self.relief,
                flare: self.flare,
                exposure: view.exposure_or(self.exposure),
            })
            .collect();
        renderer.still_of(&requests, self.with_radiance)
    }
}
