//! The pointer: where it is, since when, and what is under it.

use std::time::{Duration, Instant};

use glam::DVec2;

use super::tools::Grab;
use crate::buildings::Building;

/// The pointer, and what is under it.
#[derive(Default)]
pub(super) struct Pointer {
    /// Pixels from the window's top left corner.
    pub(super) position: DVec2,
    /// When it moved last, unless what is under it was looked at since.
    pub(super) moved: Option<Instant>,
    last_move: Option<Instant>,
    step_s: f64,
    /// Where and when a button was pressed, and where and when the last click was.
    pub(super) pressed: Option<(DVec2, Instant)>,
    pub(super) clicked: Option<(DVec2, Instant)>,
    /// What the tool holds.
    pub(super) grab: Option<Grab>,
    /// The building under it.
    pub(super) hovered: Option<Building>,
    pub(super) label: String,
}

/// What is under the pointer is looked at when it has rested for so long.
const REST: Duration = Duration::from_millis(40);

impl Pointer {
    /// It moved.
    pub(super) fn move_to(&mut self, position: DVec2) {
        let now = Instant::now();
        self.step_s = self
            .last_move
            .map_or(0.0, |last| now.duration_since(last).as_secs_f64());
        self.position = position;
        (self.moved, self.last_move) = (Some(now), Some(now));
    }

    /// Seconds between its last two moves.
    pub(super) fn step_s(&self) -> f64 {
        self.step_s
    }

    /// Whether it moved and has not rested for long enough to look.
    pub(super) fn is_waiting(&self) -> bool {
        self.moved.is_some()
    }

    /// Whether what is under it is to be looked at.
    pub(super) fn is_due(&self) -> bool {
        self.moved.is_some_and(|moved| moved.elapsed() >= REST)
    }

    /// What is under it, in words.
    pub(super) fn label(&self) -> &str {
        &self.label
    }

    /// The city changed under it.
    pub(super) fn forget(&mut self) {
        self.hovered = None;
        self.moved = Some(Instant::now());
    }
}
