//! Films: a flight through keyed views, drawn frame by frame, each complete.
//!
//! ```text
//! track_path (GPX, KML) ─▶ flight_path (JSON keys) ─▶ flight (the view at a time) ─▶ film_frame (a still) ─▶ frame_folder (PNG, resumable) ─▶ video (ffmpeg)
//! ```

mod film_frame;
mod flight;
mod flight_path;
mod frame_folder;
mod track_path;
mod video;

pub use film_frame::FilmFrame;
pub use flight::{Flight, FlightView};
pub use flight_path::{FlightPath, PathError, PathKey};
pub use frame_folder::{FrameFolder, FrameKind, FramePixels};
pub use video::{encode_video, require_encoder};
