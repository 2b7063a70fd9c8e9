//! How finely the next frame is drawn: while the camera moves, so coarsely that frames keep coming; while it rests, in full and
//! sample upon sample.

use std::time::{Duration, Instant};

use crate::gpu::Band;

/// Resolution and samples.
#[derive(Clone, Debug)]
pub struct Pace {
    /// Index into [`SCALES`] while the camera moves.
    coarse: usize,
    /// What the screen takes beside the frame.
    screen: Duration,
    last_motion: Option<Instant>,
    /// Whether the camera moved when the last frame was begun.
    is_moving: bool,
    /// Samples of the image shown.
    samples: u32,
    /// Whether that image is one of a moving camera's.
    is_of_motion: bool,
    /// The band of the resting image's next sample, and what the bands before it took.
    band: Band,
    spent: Duration,
    /// What a sample in full takes, about, and what the last one took.
    full: Duration,
    measured: Duration,
    /// The same by the pixels of the last frame in motion, and by how many times too much that was: such frames are so small that
    /// most of their time goes elsewhere than into pixels.
    in_motion: Duration,
    excess: f64,
    /// Whether an image of a lower resolution is to bridge the time until the first whole one.
    is_bridge_due: bool,
    /// Samples that a resting image gets.
    pub max_samples: u32,
    /// Frames a second to hold while the camera moves.
    pub frames_per_s: f64,
}

/// What to draw next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Pixels of the frame, by those of the window.
    pub scale: f64,
    /// Number of its sample.
    pub sample: u32,
    /// Rows of it.
    pub band: Band,
    /// Whether it is one of a moving camera's, which keep what the ones before showed.
    pub in_motion: bool,
}

/// Scales in use. A few, so that targets are not made anew all the time.
pub const SCALES: [f64; 8] = [1.0, 0.75, 0.5, 0.375, 0.25, 0.1875, 0.15, 0.125];
/// Index of the scale to begin with.
const FIRST: usize = 4;
/// Most samples that a resting image gets.
pub const MAX_SAMPLES: u32 = 64;
/// Frames a second while the camera moves, unless it is told otherwise; and the part of a frame's time that it may take: something is
/// to spare.
pub const FRAMES_PER_S: f64 = 15.0;
const USED: f64 = 0.9;
/// A whole image that takes longer than this is bridged by one at this scale.
const SLOW: Duration = Duration::from_millis(1200);
const BRIDGE: f64 = 0.75;
/// Frames in motion are taken for no more times too long than this.
const MAX_EXCESS: f64 = 8.0;
/// A view whose samples seem to take so many times as long as the last measured one is like it.
const ALIKE: std::ops::RangeInclusive<f64> = 0.6..=1.6;
/// A band takes about so long, so that the window answers in between; and how many there are at most.
const BAND: Duration = Duration::from_millis(80);
const MAX_BANDS: u32 = 16;
/// The camera rests when it has not moved for so long.
const REST: Duration = Duration::from_millis(50);

impl Pace {
    /// The window opens: as in motion, so that there is something to see at once.
    pub fn new(now: Instant) -> Self {
        Self {
            coarse: FIRST,
            screen: Duration::ZERO,
            last_motion: Some(now),
            is_moving: true,
            samples: 0,
            is_of_motion: false,
            band: Band::WHOLE,
            spent: Duration::ZERO,
            full: Duration::ZERO,
            measured: Duration::ZERO,
            in_motion: Duration::ZERO,
            excess: 1.0,
            is_bridge_due: false,
            max_samples: MAX_SAMPLES,
            frames_per_s: FRAMES_PER_S,
        }
    }

    /// The camera, the sun or a setting changed.
    pub fn moved(&mut self, now: Instant) {
        self.begin_anew();
        self.last_motion = Some(now);
        self.is_bridge_due = false;
    }

    /// What is drawn became another, of which the image shown tells most.
    pub fn begin_anew(&mut self) {
        self.samples = 0;
        self.band = Band::WHOLE;
        self.spent = Duration::ZERO;
    }

    /// Whether bands of a resting image are still to come.
    pub fn is_amid_image(&self) -> bool {
        !self.band.is_first()
    }

    /// What to draw next; none when the image is as good as it gets.
    pub fn next(&mut self, now: Instant) -> Option<Step> {
        self.is_moving = self
            .last_motion
            .is_some_and(|last| now.duration_since(last) < REST);
        if self.is_moving {
            let step = Step {
                scale: SCALES[self.coarse],
                sample: if self.is_of_motion { self.samples } else { 0 },
                band: Band::WHOLE,
                in_motion: true,
            };
            self.is_of_motion = true;
            return Some(step);
        }
        if self.is_of_motion {
            self.is_of_motion = false;
            self.samples = 0;
            self.is_bridge_due = self.full > SLOW;
        }
        if self.is_bridge_due {
            return Some(Step {
                scale: BRIDGE,
                sample: 0,
                band: Band::WHOLE,
                in_motion: false,
            });
        }
        if self.band.is_first() {
            let count = (self.full.as_secs_f64() / BAND.as_secs_f64()).ceil() as u32;
            self.band.count = count.clamp(1, MAX_BANDS);
        }
        (self.samples < self.max_samples).then_some(Step {
            scale: 1.0,
            sample: self.samples,
            band: self.band,
            in_motion: false,
        })
    }

    /// A step was drawn in so long; what the whole frame took when that was the last of it. The scale of moving frames follows
    /// from it: its time goes with the pixels.
    pub fn drawn(&mut self, step: Step, took: Duration) -> Option<Duration> {
        let took = self.spent + took;
        if !step.band.is_last() {
            self.spent = took;
            self.band.index += 1;
            return None;
        }
        (self.spent, self.band) = (Duration::ZERO, Band::WHOLE);
        // What stands in for the first whole image is none of its samples.
        let stands_in = !self.is_moving && step.scale < 1.0;
        self.samples = if stands_in { 0 } else { step.sample + 1 };
        self.is_bridge_due &= !stands_in;
        let by_pixels = took.div_f64(step.scale * step.scale);
        if self.is_moving {
            self.in_motion = by_pixels;
            let expected = by_pixels.div_f64(self.excess);
            // The estimate is rough: what was measured counts as long as the view is like the one it was measured in.
            let ratio = expected.as_secs_f64() / self.measured.as_secs_f64().max(1e-4);
            self.full = if ALIKE.contains(&ratio) {
                self.measured
            } else {
                expected
            };
        } else {
            (self.full, self.measured) = (by_pixels, by_pixels);
            self.excess =
                (self.in_motion.as_secs_f64() / by_pixels.as_secs_f64().max(1e-4)).clamp(1.0, MAX_EXCESS);
        }
        if !self.is_moving {
            return Some(took);
        }
        let budget = (USED / self.frames_per_s - self.screen.as_secs_f64()).max(0.0);
        let seconds = took.as_secs_f64().max(1e-4);
        let takes = |scale: f64| seconds * (scale / step.scale).powi(2);
        let wanted = SCALES
            .iter()
            .position(|&scale| takes(scale) <= budget)
            .unwrap_or(SCALES.len() - 1);
        // Coarser at once, finer a step at a time: what sticks is what holds.
        self.coarse = if wanted < self.coarse {
            let finer = self.coarse - 1;
            let has_room = takes(SCALES[finer]) <= 0.95 * budget;
            if has_room { finer } else { self.coarse }
        } else {
            wanted
        };
        Some(took)
    }

    /// An image was brought to the screen in so long.
    pub fn shown(&mut self, took: Duration) {
        self.screen = took;
    }

    /// Whether the image shown was drawn in motion.
    pub fn is_moving(&self) -> bool {
        self.is_moving
    }

    /// Samples of the image shown.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// Whether the image shown is one of full resolution.
    pub fn is_full(&self) -> bool {
        !self.is_of_motion && self.samples > 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A device on which a full frame takes 960 ms and the screen 18: while it moves frames come down to the budget, and at rest the samples add up.
    #[test]
    fn frames_keep_coming_while_the_camera_moves_and_samples_add_up_at_rest() {
        let mut now = Instant::now();
        let mut pace = Pace::new(now);
        let screen = Duration::from_millis(18);
        let cost = |scale: f64| Duration::from_secs_f64(0.01 + 0.95 * scale * scale);
        let mut times = Vec::new();
        for _ in 0..30 {
            pace.moved(now);
            let Some(step) = pace.next(now) else { break };
            assert_eq!(step.sample, 0, "what moved is drawn anew");
            now += cost(step.scale) + screen;
            pace.drawn(step, cost(step.scale));
            pace.shown(screen);
            times.push(cost(step.scale) + screen);
        }
        assert!(
            times[2..].iter().all(|time| time.as_secs_f64() < 1.0 / 15.0),
            "{times:?}"
        );
        now += REST;
        let mut drawn = 0;
        let mut longest = Duration::ZERO;
        // The first whole image takes long: one of a lower resolution comes before it, and is none of the samples.
        let bridge = pace.next(now);
        assert_eq!(bridge.map(|step| (step.scale, step.sample)), Some((BRIDGE, 0)));
        if let Some(step) = bridge {
            now += cost(step.scale);
            assert!(pace.drawn(step, cost(step.scale)).is_some() && !pace.is_full());
        }
        while let Some(step) = pace.next(now) {
            assert_eq!((step.scale, step.sample), (1.0, drawn));
            let took = cost(1.0).div_f64(f64::from(step.band.count));
            longest = longest.max(took);
            now += took;
            let whole = pace.drawn(step, took);
            assert_eq!(whole.is_some(), step.band.is_last());
            drawn += u32::from(whole.is_some());
        }
        assert!(longest < 2 * BAND, "the window waits {longest:?}");
        assert_eq!(drawn, MAX_SAMPLES);
        assert!(pace.is_full());
    }
}
