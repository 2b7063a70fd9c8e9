//! What moves by itself between two frames: flight by keys, a glide, a pan that runs out, a played flight, time that flies.

use glam::DVec3;
use winit::keyboard::KeyCode;

use super::ViewerError;
use super::running::Running;

/// Longest time between two frames that moves anything: a pause is no flight. Seconds.
pub(super) const MAX_STEP_S: f64 = 0.25;
/// Hours of the day that pass in a second of a time lapse.
const LAPSE_HOURS_PER_S: f64 = 0.5;
/// Height that the eye counts as having where there is no ground, metres.
const NO_GROUND_M: f64 = 100.0;

impl Running {
    /// Whether something moves by itself.
    pub(super) fn is_in_motion(&self) -> bool {
        !self.keys.is_empty()
            || self.glide.is_some()
            || self.momentum.is_moving()
            || self.interface.recorder.is_playing
            || self.interface.recorder.is_recording()
            || self.state.is_time_lapse
    }

    /// Seconds pass.
    pub(super) fn animate(&mut self, seconds: f64) -> Result<(), ViewerError> {
        let step = seconds.min(MAX_STEP_S);
        self.fly(step);
        if self.state.navigator.is_dragging() {
            self.momentum.held(step);
        } else {
            self.run_out(step);
        }
        if let Some(glide) = &mut self.glide {
            let (pose, is_last) = glide.pass(step);
            self.state.navigator.go_to(&self.renderer.resident.tiles, pose);
            self.glide = self.glide.filter(|_| !is_last);
            self.moved();
        }
        let (state, size) = (&self.state, self.screen.size());
        let played = self.interface.recorder.pass(seconds, || state.key(size));
        if let Some(view) = played {
            self.state.set_view(&view, self.city.manifest().place)?;
            self.moved();
        }
        if self.state.is_time_lapse {
            self.state.clock.hours = (self.state.clock.hours + LAPSE_HOURS_PER_S * step) % 24.0;
            self.state.sun = self.state.clock.sun()?;
            self.moved();
        }
        Ok(())
    }

    /// A pan that was let go in motion.
    fn run_out(&mut self, seconds: f64) {
        let tiles = &self.renderer.resident.tiles;
        let navigator = &mut self.state.navigator;
        let eye = navigator.pose.eye;
        let height_m = tiles
            .ground_at(eye.truncate())
            .map_or(NO_GROUND_M, |ground| eye.z - ground);
        if let Some(step) = self.momentum.pass(seconds, height_m) {
            let mut pose = navigator.pose;
            pose.eye += step.extend(0.0);
            navigator.go_to(tiles, pose);
            self.moved();
        }
    }

    /// Moves by the keys held since the last frame.
    pub(super) fn fly(&mut self, seconds: f64) {
        let held = |key: KeyCode| f64::from(u8::from(self.keys.contains(&key)));
        let wish = DVec3::new(
            held(KeyCode::KeyD) - held(KeyCode::KeyA),
            held(KeyCode::KeyE) - held(KeyCode::KeyQ),
            held(KeyCode::KeyW) - held(KeyCode::KeyS),
        );
        let is_fast = self.keys.contains(&KeyCode::ShiftLeft) || self.keys.contains(&KeyCode::ShiftRight);
        let tiles = &self.renderer.resident.tiles;
        if self.state.navigator.fly(tiles, wish, is_fast, seconds) {
            self.stop();
            self.moved();
        }
    }

    /// Stops what moves by itself: the user took over.
    pub(super) fn stop(&mut self) {
        self.glide = None;
        self.momentum.stop();
        self.interface.recorder.is_playing = false;
    }
}
