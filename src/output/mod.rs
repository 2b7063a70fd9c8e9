//! Pictures out: the ordered list of passes of a frame, and the files.

mod files;
mod flare;
mod frame;
mod renderer;

pub use files::{OutputError, write_depth, write_drawing, write_ids, write_png, write_radiance};
pub use flare::{FlarePicture, FlareRenderer, area_on_film, auto_exposure, film_half_mm, srgb, tone_mapped};
pub use frame::{LensRequest, Picture, PictureRequest, RenderError};
pub use renderer::Renderer;
