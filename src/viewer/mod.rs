//! The window: a city flown through, drawn by the same frame as a still.
//!
//! ```text
//! events ─▶ app ─▶ input ─┬▶ navigate, motion (pose) ─┐
//!                         ├▶ clicks ─▶ tools ─────────┼▶ scene_state (FrameRequest) ─▶ output::Renderer ─▶ screen (image, overlay)
//!                         └▶ panels ─▶ actions ───────┘
//!                                        └▶ editing (a thread) ─▶ city::Editor ─▶ the city folder, which the window follows
//! `start` is the window before a city is open, `running` the open one; `pace` its resolution while the camera moves and its samples while it rests.
//! ```

mod actions;
mod app;
mod blit;
mod clicks;
mod clock;
mod editing;
mod error;
mod glide;
mod input;
mod journal;
mod last_view;
mod motion;
mod navigate;
mod options;
mod overlay;
mod pace;
mod panels;
mod places;
mod pointer;
mod recorder;
mod running;
mod scene_state;
mod screen;
mod start;
mod tools;

pub use app::run;
pub use blit::{Blit, SCREEN};
pub use clock::Clock;
pub use error::ViewerError;
pub use navigate::{Cursor, Navigator};
pub use options::ViewerOptions;
pub use pace::Pace;
