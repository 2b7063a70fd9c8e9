//! The window: a city flown through, drawn by the same frame as a still.
//!
//! ```text
//! events ─▶ input, app ─┬▶ navigate (pose) ─┐
//!                       ├▶ clock (sun) ─────┼▶ scene_state (FrameRequest) ─▶ output::Renderer ─▶ screen (image, overlay)
//!                       └▶ panel (lens, ..) ┘
//!                           pace (resolution while the camera moves, samples while it rests)
//! ```

mod app;
mod blit;
mod clock;
mod error;
mod input;
mod journal;
mod navigate;
mod overlay;
mod pace;
mod panel;
mod scene_state;
mod screen;

pub use app::{ViewerOptions, run};
pub use blit::{Blit, SCREEN};
pub use clock::Clock;
pub use error::ViewerError;
pub use navigate::{Cursor, Navigator};
pub use pace::Pace;
