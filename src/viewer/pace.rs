//! How finely the next frame is drawn: while the camera moves, so coarsely that frames keep coming; while it rests, in full and
//! sample upon sample.

use std::time::{Duration, Instant};

/// Resolution and samples.
#[derive(Clone, Debug, Default)]
pub struct Pace {
    /// Index into [`SCALES`] while the camera moves.
    coarse: usize,
    last_motion: Option<Instant>,
    /// Whether the camera moved when the frame now in the making was begun.
    is_moving: bool,
    /// Samples of the image shown.
    samples: u32,
    /// Whether that image is a coarse one.
    is_coarse: bool,
}

/// What to draw next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Pixels of the frame, by those of the window.
    pub scale: f64,
    /// Number of its sample.
    pub sample: u32,
}

/// Scales in use. A few, so that targets are not made anew all the time.
pub const SCALES: [f64; 6] = [1.0, 0.75, 0.5, 0.375, 0.25, 0.1875];
/// Samples that a resting image gets.
pub const MAX_SAMPLES: u32 = 64;
/// Frames are to take no longer while the camera moves: 15 a second, with something to spare.
const BUDGET: Duration = Duration::from_millis(58);
/// The camera rests when it has not moved for so long.
const REST: Duration = Duration::from_millis(120);

impl Pace {
    /// The camera, the sun or a setting changed.
    pub fn moved(&mut self, now: Instant) {
        self.last_motion = Some(now);
        self.samples = 0;
    }

    /// What to draw next; none when the image is as good as it gets.
    pub fn next(&mut self, now: Instant) -> Option<Step> {
        self.is_moving = self
            .last_motion
            .is_some_and(|last| now.duration_since(last) < REST);
        if self.is_moving && self.coarse > 0 {
            // A coarse image that has been drawn stays until something moves again or rests.
            let step = Step {
                scale: SCALES[self.coarse],
                sample: if self.is_coarse { self.samples } else { 0 },
            };
            self.is_coarse = true;
            return Some(step);
        }
        if self.is_coarse {
            self.is_coarse = false;
            self.samples = 0;
        }
        (self.samples < MAX_SAMPLES).then_some(Step {
            scale: 1.0,
            sample: self.samples,
        })
    }

    /// A frame was drawn in so long. The scale of moving frames follows from it: time goes with the pixels.
    pub fn drawn(&mut self, step: Step, took: Duration) {
        self.samples = step.sample + 1;
        let seconds = took.as_secs_f64().max(1e-4);
        let fits = |scale: f64| seconds * (scale / step.scale).powi(2) <= BUDGET.as_secs_f64();
        let wanted = SCALES
            .iter()
            .position(|&scale| fits(scale))
            .unwrap_or(SCALES.len() - 1);
        if !self.is_moving {
            // What the first frames took tells where to begin.
            if self.last_motion.is_none() {
                self.coarse = wanted;
            }
            return;
        }
        // Coarser at once, finer a step at a time: what sticks is what holds.
        self.coarse = if wanted < self.coarse {
            let finer = self.coarse - 1;
            let has_room = seconds * (SCALES[finer] / step.scale).powi(2) <= 0.8 * BUDGET.as_secs_f64();
            if has_room { finer } else { self.coarse }
        } else {
            wanted
        };
    }

    /// Samples of the image shown.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// Whether the image shown is one of full resolution.
    pub fn is_full(&self) -> bool {
        !self.is_coarse && self.samples > 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A device on which a full frame takes 450 ms: while it moves frames come down to the budget, and at rest the samples add up.
    #[test]
    fn frames_keep_coming_while_the_camera_moves_and_samples_add_up_at_rest() {
        let mut pace = Pace::default();
        let mut now = Instant::now();
        let cost = |scale: f64| Duration::from_secs_f64(0.45 * scale * scale);
        let mut times = Vec::new();
        for _ in 0..30 {
            pace.moved(now);
            let step = pace.next(now).unwrap_or(Step {
                scale: 1.0,
                sample: 0,
            });
            assert_eq!(step.sample, 0, "what moved is drawn anew");
            now += cost(step.scale);
            pace.drawn(step, cost(step.scale));
            times.push(cost(step.scale));
        }
        assert!(
            times[3..].iter().all(|time| time.as_secs_f64() < 1.0 / 15.0),
            "{times:?}"
        );
        now += REST;
        let mut drawn = 0;
        while let Some(step) = pace.next(now) {
            assert_eq!(
                step,
                Step {
                    scale: 1.0,
                    sample: drawn
                }
            );
            now += cost(1.0);
            pace.drawn(step, cost(1.0));
            drawn += 1;
        }
        assert_eq!(drawn, MAX_SAMPLES);
        assert!(pace.is_full());
    }
}
