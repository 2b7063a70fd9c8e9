//! `rilievo render`: one view of a city to a PNG, with depth and ids where asked.

use std::path::PathBuf;

use glam::DVec3;

use super::CommandError;
use super::flare_flags::FlareFlags;
use crate::camera::flare::{Aperture, Quality};
use crate::city::City;
use crate::output::{LensRequest, PictureRequest, Renderer, write_depth, write_ids, write_png};
use crate::relief::{CpuMap, Light, ReliefMode, sun_visibility};
use crate::scene::TerrainMesh;
use crate::space::{Place, View, sun_direction_in_world, sun_from_azimuth_altitude};

/// Flags of `render`.
#[derive(Debug, clap::Args)]
pub struct RenderArgs {
    /// The city folder.
    city: PathBuf,
    /// Eye: easting, northing, height in the city's CRS, metres.
    #[arg(long, value_parser = point, allow_hyphen_values = true)]
    eye: DVec3,
    /// A point to look at: easting, northing, height.
    #[arg(long, value_parser = point, allow_hyphen_values = true)]
    look: DVec3,
    /// Vertical field of view, degrees.
    #[arg(long, default_value_t = 60.0, value_parser = field_of_view)]
    fov: f64,
    /// Picture size, pixels.
    #[arg(long, default_value = "1280x720", value_parser = size)]
    size: [u32; 2],
    /// Date and time for the sun, like 2026-06-21T19:40:00+02:00 [default: a sun in the south-west, 42 degrees high].
    #[arg(long)]
    time: Option<String>,
    /// How buildings are drawn.
    #[arg(long, value_enum, default_value = "exact")]
    relief: ReliefMode,
    /// Draw every terrain sample instead of the TIN.
    #[arg(long)]
    terrain_grid: bool,
    /// Samples a pixel: anti-aliasing, soft shadows and sky light.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=4096))]
    samples: u32,
    /// Take the picture through a lens, with the sun's flare: a built-in name (`rilievo lens list`) or a file.
    #[arg(long)]
    lens: Option<String>,
    /// The lens's f-number.
    #[arg(long, default_value_t = 8.0, value_parser = super::lens_flags::f_number, requires = "lens")]
    f_number: f64,
    /// Blades of its iris; fewer than 3 are a circle.
    #[arg(long, default_value_t = 8, requires = "lens")]
    blades: u32,
    /// Specks and scratches on its glass.
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=1000), requires = "lens")]
    dirt: u32,
    #[command(flatten)]
    flare: FlareFlags,
    /// Ghosts: --ghosts false leaves the sun's image and its starburst alone.
    #[arg(long, default_value_t = true, action = clap::ArgAction::Set, requires = "lens")]
    ghosts: bool,
    /// The picture to write.
    #[arg(long)]
    out: PathBuf,
    /// Metres along the view ray, NaN = sky (f32 TIFF).
    #[arg(long)]
    depth: Option<PathBuf>,
    /// Building ids, 0 = ground or sky (u32 TIFF).
    #[arg(long)]
    ids: Option<PathBuf>,
}

/// `E,N,H`.
pub fn point(text: &str) -> Result<DVec3, String> {
    let numbers: Vec<f64> = text
        .split(',')
        .map(|part| part.trim().parse::<f64>().ok().filter(|value| value.is_finite()))
        .collect::<Option<_>>()
        .unwrap_or_default();
    match numbers[..] {
        [east, north, height] => Ok(DVec3::new(east, north, height)),
        _ => Err("give three numbers: easting,northing,height".to_owned()),
    }
}

fn field_of_view(text: &str) -> Result<f64, String> {
    let degrees: f64 = text.parse().map_err(|_| "give degrees".to_owned())?;
    if (0.1..=170.0).contains(&degrees) {
        Ok(degrees)
    } else {
        Err("give 0.1 to 170 degrees".to_owned())
    }
}

/// `WxH`.
pub fn size(text: &str) -> Result<[u32; 2], String> {
    let sides: Option<Vec<u32>> = text.split('x').map(|side| side.parse().ok()).collect();
    match sides.as_deref() {
        Some(&[width, height]) if (1..=8192).contains(&width) && (1..=8192).contains(&height) => {
            Ok([width, height])
        }
        _ => Err("give a size like 1280x720, each side 1 to 8192".to_owned()),
    }
}

/// The sun at a time, or a pleasant default.
pub fn light(time: Option<&str>, place: Place) -> Result<Light, CommandError> {
    let to_sun = match time {
        Some(time) => sun_direction_in_world(time, place)?,
        None => sun_from_azimuth_altitude(225.0, 42.0),
    };
    Ok(Light { to_sun })
}

/// Draws and writes.
pub fn run(args: &RenderArgs) -> Result<(), CommandError> {
    for path in [Some(&args.out), args.depth.as_ref(), args.ids.as_ref()]
        .into_iter()
        .flatten()
    {
        require_folder(path)?;
    }
    let city = City::open(&args.city)?;
    let light = light(args.time.as_deref(), city.manifest().place)?;
    let mesh = if args.terrain_grid {
        TerrainMesh::Grid
    } else {
        TerrainMesh::Tin
    };
    let renderer = Renderer::open(&city, args.relief, mesh)?;
    let lens = args.lens.as_deref().map(crate::camera::lens::open).transpose()?;
    let table = match &lens {
        Some(lens) => args.flare.table(lens, args.f_number)?,
        None => None,
    };
    let sun_visibility = match &lens {
        Some(_) => {
            let map = CpuMap::new(&city, renderer.resident.highest_roof);
            sun_visibility(&city, &map, args.eye, light.to_sun)?
        }
        None => 0.0,
    };
    let through = lens.as_ref().map(|lens| LensRequest {
        lens,
        f_number: args.f_number,
        aperture: Aperture {
            blades: args.blades,
            dirt: args.dirt,
            ..Aperture::default()
        },
        preset: args.flare.preset(Quality::High),
        ghosts: args.ghosts,
        table: table.as_ref(),
        blend: args.flare.blend,
        fit: args.flare.fit(),
        sun_visibility,
    });
    let request = PictureRequest {
        view: View {
            eye: args.eye,
            look: args.look,
            fov_y: args.fov.to_radians(),
        },
        size: args.size,
        light,
        mode: args.relief,
        samples: args.samples,
    };
    let picture = renderer.picture_through(&request, through.as_ref())?;
    write_png(&args.out, args.size, &picture.rgba)?;
    if let Some(path) = &args.depth {
        write_depth(path, args.size, &picture.depth)?;
    }
    if let Some(path) = &args.ids {
        write_ids(path, args.size, &picture.ids)?;
    }
    Ok(())
}

/// Fails before the long work when the result could not be written after it.
pub fn require_folder(path: &std::path::Path) -> Result<(), CommandError> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    if folder.is_none_or(std::path::Path::is_dir) {
        return Ok(());
    }
    Err(CommandError::File {
        path: path.display().to_string(),
        why: "its folder does not exist; make it first".to_owned(),
    })
}
