//! Images out: the ordered list of passes of a frame, stills, debug views, and files.

mod error;
mod files;
mod flare;
mod flare_pass;
mod frame;
mod intermediate;
mod renderer;
mod still;

pub use error::RenderError;
pub use files::{OutputError, write_depth, write_drawing, write_ids, write_png, write_radiance};
pub use flare::{FlarePicture, FlareRenderer, area_on_film, auto_exposure, film_half_mm, srgb, tone_mapped};
pub use flare_pass::FlareSettings;
pub use frame::FrameRequest;
pub use intermediate::{DEBUG_VIEW, DebugFrame, DebugView, Intermediate};
pub use renderer::Renderer;
pub use still::Still;
