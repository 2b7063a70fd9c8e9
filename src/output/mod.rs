//! Pictures out: the ordered list of passes of a frame, and the files.

mod contact_sheet;
mod files;
mod frame;
mod renderer;

pub use contact_sheet::{ContactSheet, contact_sheet};
pub use files::{OutputError, write_depth, write_drawing, write_ids, write_png, write_radiance};
pub use frame::{LensRequest, Picture, PictureRequest, RenderError};
pub use renderer::Renderer;
