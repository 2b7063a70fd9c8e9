//! `rilievo relief`: a textured rectangle with a displacement map, raised by the method of KR 10-0738500; and the patent's figures.

use std::io::BufReader;
use std::path::{Path, PathBuf};

use glam::{DVec2, DVec3};

use super::CommandError;
use super::relief_figures;
use super::search_flags::SearchFlags;
use super::values::{require_other, require_place};
use crate::gpu::Gpu;
use crate::output::{RenderError, write_png};
use crate::relief::extrusion::{
    Extrusion, ExtrusionMethod, HeightImage, Overflow, TextureImage, draw_extrusion,
};
use crate::source::open_regular;
use crate::space::{Pose, Projection};

/// Flags of `relief`.
#[derive(Debug, clap::Args)]
pub struct ReliefArgs {
    /// The rectangle's texture (PNG, JPEG).
    #[arg(long, required_unless_present = "figures", requires = "height")]
    texture: Option<PathBuf>,
    /// Its displacement map: black lies on the plane, white is highest (8 or 16 bits).
    #[arg(long, requires = "texture")]
    height: Option<PathBuf>,
    /// A tile for steep slopes [default: the texture's own colours].
    #[arg(long)]
    facade: Option<PathBuf>,
    /// Draw the patent's figures 7 (a) to (f) and 2 (b), (c) instead, on one sheet.
    #[arg(long, conflicts_with_all = ["texture", "height", "facade"])]
    figures: bool,
    /// With --figures, a city folder for figure 17: its terrain, and that with its buildings.
    #[arg(long, requires = "figures")]
    city: Option<PathBuf>,
    /// Width of the rectangle, metres; its depth follows from the texture.
    #[arg(long, default_value_t = 30.0, value_parser = metres)]
    width_m: f64,
    /// Height of white, metres.
    #[arg(long, default_value_t = 9.0, value_parser = metres)]
    height_m: f64,
    /// Width of the facade's tile, metres.
    #[arg(long, default_value_t = 6.0, value_parser = metres)]
    facade_m: f64,
    /// How the map is shown [default: facades with --facade, raised without].
    #[arg(long, value_enum)]
    method: Option<ExtrusionMethod>,
    /// How what rises beyond the rectangle is shown.
    #[arg(long, value_enum, default_value = "faces")]
    overflow: Overflow,
    #[command(flatten)]
    search: SearchFlags,
    /// Eye: metres east, north and above the rectangle's south-west corner [default: before that corner].
    #[arg(long, value_parser = super::values::point, allow_hyphen_values = true)]
    eye: Option<DVec3>,
    /// A point to look at [default: the rectangle's centre].
    #[arg(long, value_parser = super::values::point, allow_hyphen_values = true)]
    look: Option<DVec3>,
    /// Vertical field of view, degrees.
    #[arg(long, default_value_t = 40.0, value_parser = super::values::field_of_view)]
    fov: f64,
    /// Image size, pixels; with --figures that of one.
    #[arg(long, default_value = "640x480", value_parser = super::values::size)]
    size: [u32; 2],
    /// The image to write.
    #[arg(long)]
    out: PathBuf,
}

fn metres(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(metres) if (0.001..1e6).contains(&metres) => Ok(metres),
        _ => Err("give a number of metres, 0.001 or more".to_owned()),
    }
}

/// Draws and writes.
pub fn run(args: &ReliefArgs) -> Result<(), CommandError> {
    require_place(&args.out)?;
    let read = [&args.texture, &args.height, &args.facade];
    require_other(
        &args.out,
        &read
            .into_iter()
            .flatten()
            .map(PathBuf::as_path)
            .collect::<Vec<_>>(),
    )?;
    let (Some(texture), Some(height)) = (&args.texture, &args.height) else {
        return relief_figures::run(args.city.as_deref(), args.size, &args.out);
    };
    let texture = read_texture(texture)?;
    let height = read_height(height)?;
    let facade = args.facade.as_deref().map(read_texture).transpose()?;
    let depth_m = args.width_m * f64::from(texture.size[1]) / f64::from(texture.size[0]);
    let size_m = DVec2::new(args.width_m, depth_m);
    let usual = match facade {
        Some(_) => ExtrusionMethod::Facades,
        None => ExtrusionMethod::Raised,
    };
    let extrusion = Extrusion {
        facade: facade.as_ref().unwrap_or(&texture),
        texture: &texture,
        height: &height,
        size_m,
        height_m: args.height_m,
        facade_m: args.facade_m,
        method: args.method.unwrap_or(usual),
        overflow: args.overflow,
        search: args.search.parameters(),
    };
    let centre = (0.5 * size_m).extend(0.0);
    let before = (size_m * DVec2::new(-0.45, -1.1)).extend(0.9 * size_m.max_element() + args.height_m);
    let pose = Pose::looking_at(args.eye.unwrap_or(before), args.look.unwrap_or(centre));
    let projection = Projection::new(pose, args.size, args.fov.to_radians());
    let gpu = Gpu::open().map_err(RenderError::from)?;
    let image = draw_extrusion(&gpu, &extrusion, &projection).map_err(RenderError::from)?;
    Ok(write_png(&args.out, args.size, &image)?)
}

fn open(path: &Path) -> Result<image::DynamicImage, CommandError> {
    let refused = |why: String| CommandError::File {
        path: path.display().to_string(),
        why,
    };
    let file = open_regular(path).map_err(|error| refused(error.to_string()))?;
    let reader = image::ImageReader::new(BufReader::new(file))
        .with_guessed_format()
        .map_err(|error| refused(error.to_string()))?;
    let image = reader
        .decode()
        .map_err(|error| refused(format!("is no PNG or JPEG that can be read ({error})")))?;
    match image.width().max(image.height()) > MAX_SIDE {
        true => Err(refused(format!(
            "is wider or higher than the {MAX_SIDE} pixels that graphics cards take; make it smaller"
        ))),
        false => Ok(image),
    }
}

/// What every device of the kind that the program asks for takes, pixels.
const MAX_SIDE: u32 = 8192;

fn read_texture(path: &Path) -> Result<TextureImage, CommandError> {
    let image = open(path)?.into_rgba8();
    Ok(TextureImage {
        size: [image.width(), image.height()],
        rgba: image.pixels().map(|pixel| pixel.0).collect(),
    })
}

fn read_height(path: &Path) -> Result<HeightImage, CommandError> {
    let image = open(path)?.into_luma16();
    Ok(HeightImage {
        size: [image.width(), image.height()],
        values: image
            .pixels()
            .map(|pixel| f32::from(pixel.0[0]) / f32::from(u16::MAX))
            .collect(),
    })
}
