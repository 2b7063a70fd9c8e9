//! Pictures out: the ordered list of passes of a frame, and the files.

mod files;
mod frame;
mod renderer;

pub use files::{OutputError, write_depth, write_drawing, write_ids, write_png};
pub use frame::{Picture, PictureRequest, RenderError};
pub use renderer::Renderer;
