//! `rilievo lens bake`: a lens's ghosts recorded beforehand: traced or drawn, photographed, or both in one table.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::CommandError;
use super::lens_flags::{aperture, max_angle};
use super::values::{require_other, require_place};
use crate::camera::flare::{
    FlareImager, FlareLight, FlareRequest, FlareTable, GhostParameters, GhostTable, ImageKnots, ImageTable,
    Quality, bake_images, table_from_photos, write_table,
};
use crate::camera::lens::{Lens, open};
use crate::camera::require_f_number;
use crate::gpu::Gpu;
use crate::output::RenderError;

/// Flags of `lens bake`.
#[derive(Debug, clap::Args)]
pub struct BakeArgs {
    /// A built-in name or a file.
    lens: String,
    /// The f-number.
    #[arg(long, value_parser = super::lens_flags::f_number, required_unless_present = "photos")]
    f_number: Option<f64>,
    /// Images over two angles instead of rays over one: ANGLESxAZIMUTHS, such as 16x8; for irises without symmetry.
    #[arg(long, value_parser = knots, requires = "f_number")]
    two_angles: Option<[u32; 2]>,
    /// Blades of the iris in those images.
    #[arg(long, default_value_t = 8, requires = "two_angles")]
    blades: u32,
    /// Photos and videos of a small light: a CSV file with the columns file, theta_deg (from the axis), phi_deg if it was turned too,
    /// and at_s for the times in a video. With --f-number they lie in one table with the traced ghosts.
    #[arg(long)]
    photos: Option<PathBuf>,
    /// A photo with the light off, taken away from the others.
    #[arg(long, requires = "photos")]
    dark: Option<PathBuf>,
    /// Width of the sensor that took the photos, millimetres [default: the lens's film].
    #[arg(long, requires = "photos")]
    film_mm: Option<f64>,
    /// Radiance of the photos' white under a light of irradiance 1, per steradian.
    #[arg(long, default_value_t = 1.0, requires = "photos")]
    white: f32,
    /// Draw the linear ghosts beside the photos: they show the nonlinear ones alone.
    #[arg(long, requires = "photos")]
    with_linear: bool,
    /// The table to write.
    #[arg(long)]
    out: PathBuf,
}

/// `ANGLESxAZIMUTHS`.
fn knots(text: &str) -> Result<[u32; 2], String> {
    let counts: Option<Vec<u32>> = text.split('x').map(|count| count.parse().ok()).collect();
    match counts.as_deref() {
        Some(&[angles, azimuths])
            if angles >= 2 && azimuths >= 1 && angles.saturating_mul(azimuths) <= MAX_IMAGES =>
        {
            Ok([angles, azimuths])
        }
        _ => Err(format!(
            "give at least 2 angles and 1 azimuth, {MAX_IMAGES} images at most, such as 16x8"
        )),
    }
}

/// Most images in a table.
const MAX_IMAGES: u32 = 600;

/// Pixels along a baked image's side.
const IMAGE_SIZE: u32 = 240;
/// Rays along a side of a ghost's grid in it.
const IMAGE_RAYS: usize = 32;

/// Bakes and writes.
pub fn run(args: &BakeArgs) -> Result<(), CommandError> {
    require_place(&args.out)?;
    let read = [
        Some(Path::new(&args.lens)),
        args.photos.as_deref(),
        args.dark.as_deref(),
    ];
    require_other(&args.out, &read.into_iter().flatten().collect::<Vec<_>>())?;
    let lens = Arc::new(open(&args.lens)?);
    if let Some(f_number) = args.f_number {
        require_f_number(&lens, f_number)?;
    }
    let photos = args
        .photos
        .as_ref()
        .map(|list| photographed(args, &lens, list))
        .transpose()?;
    let table = match (args.f_number, photos) {
        (Some(f_number), photos) => traced(args, &lens, f_number)?.with_photos(photos),
        (None, Some(photos)) => GhostTable::of_photos(photos),
        (None, None) => return Err(CommandError::Argument("--f-number is missing".to_owned())),
    };
    let bytes = write_table(&args.out, &lens, table)?;
    say!("{}: {:.2} MB", args.out.display(), bytes as f64 * 1e-6);
    Ok(())
}

fn photographed(args: &BakeArgs, lens: &Lens, list: &Path) -> Result<ImageTable, CommandError> {
    let film_mm = args.film_mm.unwrap_or(lens.film_mm[0]);
    if !(film_mm > 0.0 && args.white > 0.0 && args.white.is_finite()) {
        return Err(CommandError::Argument(
            "--film-mm and --white: give numbers above 0".to_owned(),
        ));
    }
    let table = table_from_photos(list, args.dark.as_deref(), film_mm, args.white, args.with_linear)?;
    say!("{} photos", table.len());
    Ok(table)
}

fn traced(args: &BakeArgs, lens: &Arc<Lens>, f_number: f64) -> Result<GhostTable, CommandError> {
    let Some([angles, azimuths]) = args.two_angles else {
        return Ok(GhostTable::of_rays(bake_rays(lens, f_number)?));
    };
    let gpu = Gpu::open().map_err(RenderError::from)?;
    let request = FlareRequest {
        lens: Arc::clone(lens),
        f_number,
        aperture: aperture(args.blades),
        ghosts: Some(GhostParameters {
            rays: IMAGE_RAYS,
            ..Quality::Medium.preset().ghosts()
        }),
        starburst: None,
        table: None,
        light: FlareLight::point(0.0, 0.0),
        image_half_mm: [0.0; 2],
    };
    let knots = ImageKnots {
        max_angle: max_angle(lens),
        angles,
        azimuths,
        size: IMAGE_SIZE,
    };
    let table = bake_images(&mut FlareImager::new(&gpu), &request, knots).map_err(RenderError::from)?;
    say!("{} images", table.len());
    Ok(GhostTable::of_images(table))
}

/// Bakes a lens's rays to beyond the corner of its film, and says how large they are.
pub fn bake_rays(lens: &Lens, f_number: f64) -> Result<FlareTable, CommandError> {
    let start = std::time::Instant::now();
    let table = FlareTable::bake(lens, f_number, max_angle(lens));
    say!(
        "table: {} ghosts, {} left to be traced, {} angles in all, {:.2} MB, {:.0} ms to bake",
        table.len(),
        table.traced(),
        table.knots(),
        table.bytes() as f64 * 1e-6,
        start.elapsed().as_secs_f64() * 1e3
    );
    Ok(table)
}
