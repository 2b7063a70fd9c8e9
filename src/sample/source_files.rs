//! Writes the sample's source files with GDAL, as a survey office would deliver them.

use std::path::{Path, PathBuf};

use gdal::DriverManager;
use gdal::raster::{Buffer, RasterCreationOptions};
use gdal::vector::{
    Feature, FieldDefn, Geometry, LayerAccess, LayerOptions, OGRFieldType, OGRwkbGeometryType,
};
use glam::DVec2;
use rayon::prelude::*;

use super::features::SampleBuilding;
use super::landscape::{HEIGHT_M, WIDTH_M, ground};
use super::orthophoto::paint;
use super::region::Region;
use super::town::Town;
use crate::source::{SourceError, gdal_reference, gdal_says};
use crate::space::Crs;

/// The files written.
#[derive(Clone, Debug)]
pub struct SampleFiles {
    /// Bare-earth terrain, 2 m.
    pub terrain: PathBuf,
    /// Footprints; the field `height_m` has heights.
    pub buildings: PathBuf,
    /// Aerial orthophoto tiles, 0.5 m.
    pub imagery: Vec<PathBuf>,
}

/// CRS of the sample: UTM zone 33 north.
const CRS: &str = "EPSG:32633";
/// South-west corner in that CRS, metres.
const ORIGIN: DVec2 = DVec2::new(288_000.0, 4_772_000.0);
const TERRAIN_PIXEL_M: f64 = 2.0;
const REGION_PIXEL_M: f64 = 10.0;
const IMAGERY_PIXEL_M: f64 = 0.5;
/// Imagery tiles east-west and north-south.
const IMAGERY_TILES: [usize; 2] = [2, 2];

/// The folder, made, and dates in its files fixed.
fn prepare(folder: &Path) -> Result<(), SourceError> {
    let unwritable = |why: String| SourceError::Write {
        path: folder.to_owned(),
        why,
    };
    std::fs::create_dir_all(folder).map_err(|error| unwritable(error.to_string()))?;
    gdal::config::set_config_option("OGR_CURRENT_DATE", "2000-01-01T00:00:00.000Z")
        .map_err(|error| unwritable(error.to_string()))
}

/// Writes terrain, 10 m, and `count` footprints of a made-up region of `km2` square kilometres into a folder; how many
/// footprints there were beside it: fewer where they do not fit.
pub fn write_region(folder: &Path, count: usize, km2: f64) -> Result<(SampleFiles, usize), SourceError> {
    prepare(folder)?;
    let region = Region::from_km2(km2);
    let files = SampleFiles {
        terrain: folder.join("terrain.tif"),
        buildings: folder.join("buildings.gpkg"),
        imagery: Vec::new(),
    };
    write_terrain(
        &files.terrain,
        DVec2::splat(region.side_m),
        REGION_PIXEL_M,
        Region::ground,
    )?;
    let mut written = 0;
    write_building_batches(&files.buildings, |write| {
        written = region.buildings(count, write)?;
        Ok(())
    })?;
    Ok((files, written))
}

/// Writes terrain, footprints and orthophotos into a folder.
pub fn write_sample(folder: &Path) -> Result<SampleFiles, SourceError> {
    prepare(folder)?;
    let town = Town::new();
    let files = SampleFiles {
        terrain: folder.join("terrain.tif"),
        buildings: folder.join("buildings.gpkg"),
        imagery: (0..IMAGERY_TILES[0] * IMAGERY_TILES[1])
            .map(|k| {
                folder.join(format!(
                    "photo_{}_{}.tif",
                    k % IMAGERY_TILES[0],
                    k / IMAGERY_TILES[0]
                ))
            })
            .collect(),
    };
    let extent_m = DVec2::new(WIDTH_M, HEIGHT_M);
    write_terrain(&files.terrain, extent_m, TERRAIN_PIXEL_M, ground)?;
    write_buildings(&files.buildings, &town.buildings)?;
    (0..files.imagery.len()).into_par_iter().try_for_each(|k| {
        write_imagery(
            &files.imagery[k],
            &town,
            [k % IMAGERY_TILES[0], k / IMAGERY_TILES[0]],
        )
    })?;
    Ok(files)
}

fn write_error(path: &Path) -> impl Fn(gdal::errors::GdalError) -> SourceError + use<'_> {
    |error| SourceError::Write {
        path: path.to_owned(),
        why: gdal_says(&error),
    }
}

fn crs() -> Result<gdal::spatial_ref::SpatialRef, SourceError> {
    Crs::from_text(CRS)
        .and_then(|crs| gdal_reference(&crs))
        .map_err(|source| SourceError::Crs {
            path: PathBuf::from(CRS),
            source,
        })
}

/// Creates a GeoTIFF, replacing an older one.
/// `placement`: west and north edge and a pixel's side, metres. `shape`: columns, rows, bands.
fn create_tiff<T: gdal::raster::GdalType>(
    path: &Path,
    [west, north, pixel_m]: [f64; 3],
    [columns, rows, bands]: [usize; 3],
    options: &[&str],
) -> Result<gdal::Dataset, SourceError> {
    let create = || -> Result<gdal::Dataset, gdal::errors::GdalError> {
        let driver = DriverManager::get_driver_by_name("GTiff")?;
        let options: RasterCreationOptions = options.iter().copied().collect();
        let mut dataset =
            driver.create_with_band_type_with_options::<T, _>(path, columns, rows, bands, &options)?;
        dataset.set_geo_transform(&[west, pixel_m, 0.0, north, 0.0, -pixel_m])?;
        Ok(dataset)
    };
    let mut dataset = create().map_err(write_error(path))?;
    dataset.set_spatial_ref(&crs()?).map_err(write_error(path))?;
    Ok(dataset)
}

fn write_terrain(
    path: &Path,
    extent_m: DVec2,
    pixel_m: f64,
    ground: fn(DVec2) -> f64,
) -> Result<(), SourceError> {
    let size = extent_m.to_array().map(|side| (side / pixel_m).ceil() as usize);
    let north = size[1] as f64 * pixel_m;
    let heights: Vec<f32> = (0..size[0] * size[1])
        .into_par_iter()
        .map(|k| {
            let (column, row) = ((k % size[0]) as f64 + 0.5, (k / size[0]) as f64 + 0.5);
            let metres = ground(DVec2::new(column * pixel_m, north - row * pixel_m));
            // A survey's centimetres.
            ((metres * 100.0).round() / 100.0) as f32
        })
        .collect();
    let placement = [ORIGIN.x, ORIGIN.y + north, pixel_m];
    let options = ["COMPRESS=DEFLATE", "PREDICTOR=3", "TILED=YES"];
    let dataset = create_tiff::<f32>(path, placement, [size[0], size[1], 1], &options)?;
    let mut band = dataset.rasterband(1).map_err(write_error(path))?;
    let mut buffer = Buffer::new((size[0], size[1]), heights);
    band.write((0, 0), (size[0], size[1]), &mut buffer)
        .map_err(write_error(path))?;
    dataset.close().map_err(write_error(path))
}

fn write_imagery(path: &Path, town: &Town, tile: [usize; 2]) -> Result<(), SourceError> {
    let [width_m, height_m] = [
        WIDTH_M / IMAGERY_TILES[0] as f64,
        HEIGHT_M / IMAGERY_TILES[1] as f64,
    ];
    let size = [width_m, height_m].map(|side| (side / IMAGERY_PIXEL_M) as usize);
    let west = tile[0] as f64 * width_m;
    let north = (tile[1] + 1) as f64 * height_m;
    let rgb = paint(town, west, north, size, IMAGERY_PIXEL_M);
    let placement = [ORIGIN.x + west, ORIGIN.y + north, IMAGERY_PIXEL_M];
    let options = ["COMPRESS=JPEG", "JPEG_QUALITY=90", "PHOTOMETRIC=RGB", "TILED=YES"];
    let dataset = create_tiff::<u8>(path, placement, [size[0], size[1], 3], &options)?;
    for channel in 0..3 {
        let values: Vec<u8> = rgb.iter().skip(channel).step_by(3).copied().collect();
        let mut band = dataset.rasterband(channel + 1).map_err(write_error(path))?;
        let mut buffer = Buffer::new((size[0], size[1]), values);
        band.write((0, 0), (size[0], size[1]), &mut buffer)
            .map_err(write_error(path))?;
    }
    dataset.close().map_err(write_error(path))
}

fn write_buildings(path: &Path, buildings: &[SampleBuilding]) -> Result<(), SourceError> {
    write_building_batches(path, |write| write(buildings))
}

/// Takes a batch of buildings.
type WriteBatch<'a> = dyn FnMut(&[SampleBuilding]) -> Result<(), gdal::errors::GdalError> + 'a;

/// Writes what `batches` hands over.
fn write_building_batches(
    path: &Path,
    batches: impl FnOnce(&mut WriteBatch<'_>) -> Result<(), gdal::errors::GdalError>,
) -> Result<(), SourceError> {
    if path.exists() {
        std::fs::remove_file(path).map_err(|error| SourceError::Write {
            path: path.to_owned(),
            why: error.to_string(),
        })?;
    }
    let srs = crs()?;
    let write = || -> Result<(), gdal::errors::GdalError> {
        let mut dataset = DriverManager::get_driver_by_name("GPKG")?.create_vector_only(path)?;
        let mut transaction = dataset.start_transaction()?;
        let layer = transaction.create_layer(LayerOptions {
            name: "buildings",
            srs: Some(&srs),
            ty: OGRwkbGeometryType::wkbPolygon,
            options: None,
        })?;
        for (name, kind) in [
            ("kind", OGRFieldType::OFTString),
            ("storeys", OGRFieldType::OFTInteger),
            ("height_m", OGRFieldType::OFTReal),
        ] {
            FieldDefn::new(name, kind)?.add_to_layer(&layer)?;
        }
        batches(&mut |buildings| {
            for building in buildings {
                let mut feature = Feature::new(layer.defn())?;
                feature.set_field_string(0, building.kind)?;
                feature.set_field_integer(1, building.storeys as i32)?;
                feature.set_field_double(2, building.height_m)?;
                feature.set_geometry(Geometry::from_wkt(&wkt_of(building))?)?;
                feature.create(&layer)?;
            }
            Ok(())
        })?;
        transaction.commit()?;
        dataset.close()
    };
    write().map_err(write_error(path))
}

/// Well-known text of an outline in the sample's CRS, to the millimetre.
fn wkt_of(building: &SampleBuilding) -> String {
    let ring = |points: &[DVec2]| {
        let closed = points.iter().chain(points.first());
        let texts: Vec<String> = closed
            .map(|p| format!("{:.3} {:.3}", ORIGIN.x + p.x, ORIGIN.y + p.y))
            .collect();
        format!("({})", texts.join(","))
    };
    let rings: Vec<String> = std::iter::once(&building.ring)
        .chain(&building.holes)
        .map(|points| ring(points))
        .collect();
    format!("POLYGON({})", rings.join(","))
}
