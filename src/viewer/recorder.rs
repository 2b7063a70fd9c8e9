//! The flight of the window: keys set or recorded, and played.

use crate::output::{Flight, FlightPath, FlightView, PathKey};

/// A flight in the making.
#[derive(Clone, Debug, Default)]
pub struct Recorder {
    /// Its keys.
    pub path: FlightPath,
    /// Where the timeline stands, seconds.
    pub time_s: f64,
    /// Whether it is played.
    pub is_playing: bool,
    /// Seconds since the recording began; none while nothing is recorded.
    recording_s: Option<f64>,
    flight: Option<Flight>,
}

/// Seconds between the keys of a recording.
const RECORD_STEP_S: f64 = 0.5;

impl Recorder {
    /// With a path.
    pub fn new(path: FlightPath) -> Self {
        let mut recorder = Self {
            path,
            ..Self::default()
        };
        recorder.changed();
        recorder
    }

    /// Adds a view as a key: after the last by the usual time.
    pub fn add(&mut self, view: PathKey) {
        let last = self.span()[1];
        let t = if self.path.keys.is_empty() {
            0.0
        } else {
            last + PathKey::SPACING_S
        };
        self.put(view, t);
        self.time_s = t;
    }

    fn put(&mut self, view: PathKey, t: f64) {
        // Keys of a file without times get theirs, so that all have one.
        let times: Vec<f64> = self.path.times().collect();
        for (key, time) in self.path.keys.iter_mut().zip(times) {
            key.t = Some(time);
        }
        self.path.keys.push(PathKey { t: Some(t), ..view });
        self.changed();
    }

    /// Takes a key out.
    pub fn remove(&mut self, index: usize) {
        if index < self.path.keys.len() {
            self.path.keys.remove(index);
            self.changed();
        }
    }

    /// Forgets all keys.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// The keys changed.
    pub fn changed(&mut self) {
        self.flight = Flight::new(&self.path);
        let [first, last] = self.span();
        self.time_s = self.time_s.clamp(first, last);
        self.is_playing &= last > first;
    }

    /// Seconds of the first and the last key.
    pub fn span(&self) -> [f64; 2] {
        self.flight.as_ref().map_or([0.0; 2], Flight::span)
    }

    /// The view where the timeline stands; none without keys.
    pub fn view(&self) -> Option<FlightView> {
        Some(self.flight.as_ref()?.at(self.time_s))
    }

    /// Begins or ends a recording; a new one forgets the keys before.
    pub fn toggle_recording(&mut self) {
        if self.recording_s.take().is_none() {
            self.clear();
            self.recording_s = Some(0.0);
        }
    }

    /// Whether a recording runs.
    pub fn is_recording(&self) -> bool {
        self.recording_s.is_some()
    }

    /// Begins or ends playing; from the begin where it stands at the end.
    pub fn toggle_playing(&mut self) {
        let [first, last] = self.span();
        self.is_playing = !self.is_playing && last > first;
        if self.is_playing && self.time_s >= last {
            self.time_s = first;
        }
    }

    /// Time passes: the view to show where the flight is played. `view`: the camera's, which a recording takes.
    pub fn pass(&mut self, seconds: f64, view: impl FnOnce() -> PathKey) -> Option<FlightView> {
        if let Some(elapsed) = &mut self.recording_s {
            *elapsed += seconds;
            let elapsed = *elapsed;
            let is_due = self.path.keys.is_empty() || elapsed >= self.span()[1] + RECORD_STEP_S;
            if is_due {
                self.put(view(), elapsed);
            }
        }
        if !self.is_playing {
            return None;
        }
        let last = self.span()[1];
        self.time_s = (self.time_s + seconds).min(last);
        self.is_playing = self.time_s < last;
        self.view()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(x: f64) -> PathKey {
        PathKey {
            eye: [x, 0.0, 100.0],
            look: [x, 100.0, 0.0],
            ..PathKey::default()
        }
    }

    #[test]
    fn a_recording_plays_as_it_was_flown() {
        let mut recorder = Recorder::default();
        recorder.toggle_recording();
        for k in 0..=40 {
            let x = f64::from(k);
            let _ = recorder.pass(0.1, || key(x));
        }
        recorder.toggle_recording();
        let [first, last] = recorder.span();
        assert!(
            recorder.path.keys.len() >= 6 && last - first > 3.0,
            "{first} to {last}"
        );
        recorder.time_s = first;
        recorder.toggle_playing();
        let seen = recorder.pass(1.0, || key(0.0)).map(|view| view.eye.x);
        assert!(seen.is_some_and(|x| (x - 10.0).abs() < 1.0), "{seen:?}");
        while recorder.is_playing {
            let _ = recorder.pass(0.3, || key(0.0));
        }
        assert_eq!(recorder.time_s, last);
    }

    #[test]
    fn keys_that_are_set_follow_each_other() {
        let mut recorder = Recorder::default();
        recorder.toggle_playing();
        assert!(!recorder.is_playing, "nothing to play");
        for k in 0..3 {
            recorder.add(key(f64::from(k)));
        }
        assert_eq!(recorder.span(), [0.0, 2.0 * PathKey::SPACING_S]);
        recorder.remove(0);
        assert_eq!(recorder.path.keys.len(), 2);
        assert_eq!(recorder.span()[0], PathKey::SPACING_S);
    }
}
