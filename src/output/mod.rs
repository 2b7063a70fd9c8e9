//! Images out: the ordered list of passes of a frame, stills, debug views, and files.

mod contact_sheet;
mod error;
mod film;
mod image_files;
mod flare_pass;
mod flare_window;
mod frame;
mod debug_view;
mod renderer;
mod still;
mod windows;

pub use contact_sheet::{ContactSheet, contact_sheet};
pub use debug_view::{DEBUG_VIEW, DebugFrame, DebugView, Intermediate};
pub use error::RenderError;
pub use film::{
    FilmFrame, Flight, FlightPath, FlightView, FrameFolder, FrameKind, FramePixels, PathError, PathKey,
    encode_video, require_encoder,
};
pub use flare_pass::FlareSettings;
pub use flare_window::{FLARE_WINDOW, FlareWindow, FlareWindowFrame};
pub use frame::FrameRequest;
pub use image_files::{
    ImageKind, OutputError, image_kind, write_depth, write_drawing, write_exr, write_ids, write_png,
    write_radiance,
};
pub use renderer::Renderer;
pub use still::Still;
pub use windows::MAX_WINDOW_PX;
