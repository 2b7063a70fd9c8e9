//! Small made surveys: a DTM of any spacing, CRS and pixel type, and one footprint on it.

use std::path::{Path, PathBuf};

use gdal::DriverManager;
use gdal::raster::{Buffer, GdalType};

use super::succeed;

/// A north-up raster.
#[derive(Clone, Copy)]
pub struct Raster {
    pub epsg: u32,
    /// West and north edge.
    pub corner: [f64; 2],
    /// Width and height of a pixel.
    pub pixel: [f64; 2],
    pub size: [usize; 2],
}

impl Raster {
    /// Writes heights given by column and row.
    pub fn write<T: GdalType + Copy>(
        &self,
        path: &Path,
        height: impl Fn(usize, usize) -> T,
        no_data: Option<f64>,
    ) {
        let driver = DriverManager::get_driver_by_name("GTiff").unwrap();
        let mut file = driver
            .create_with_band_type::<T, _>(path, self.size[0], self.size[1], 1)
            .unwrap();
        file.set_geo_transform(&[
            self.corner[0],
            self.pixel[0],
            0.0,
            self.corner[1],
            0.0,
            -self.pixel[1],
        ])
        .unwrap();
        file.set_spatial_ref(&gdal::spatial_ref::SpatialRef::from_epsg(self.epsg).unwrap())
            .unwrap();
        let heights = (0..self.size[0] * self.size[1]).map(|k| height(k % self.size[0], k / self.size[0]));
        let mut buffer = Buffer::new((self.size[0], self.size[1]), heights.collect());
        let mut band = file.rasterband(1).unwrap();
        band.set_no_data_value(no_data).unwrap();
        band.write((0, 0), (self.size[0], self.size[1]), &mut buffer)
            .unwrap();
        file.flush_cache().unwrap();
    }
}

/// Writes square footprints of 8 m and `height` 5 m, south-west corners given in metres of a projected CRS.
pub fn footprints(path: &Path, corners: &[[f64; 2]]) {
    let features: Vec<String> = corners
        .iter()
        .map(|[x, y]| {
            let ring = [[*x, *y], [x + 8.0, *y], [x + 8.0, y + 8.0], [*x, y + 8.0], [*x, *y]];
            format!(
                r#"{{"type":"Feature","properties":{{"height":5.0}},"geometry":{{"type":"Polygon","coordinates":[{ring:?}]}}}}"#
            )
        })
        .collect();
    let text = format!(
        r#"{{"type":"FeatureCollection","features":[{}]}}"#,
        features.join(",")
    );
    std::fs::write(path, text).unwrap();
}

/// Imports terrain files with one footprint in EPSG:32633, with more arguments; the city's folder and what was said.
pub fn import(folder: &Path, terrain: &[&Path], corners: &[[f64; 2]], more: &[&str]) -> (PathBuf, String) {
    let buildings = folder.join("footprints.geojson");
    footprints(&buildings, corners);
    let out = folder.join("city");
    let mut arguments: Vec<String> = ["import", "--terrain"].map(String::from).to_vec();
    arguments.extend(terrain.iter().map(|path| path.display().to_string()));
    arguments.extend(["--buildings".to_owned(), buildings.display().to_string()]);
    arguments.extend(["--buildings-crs", "EPSG:32633", "--height-field", "height"].map(String::from));
    arguments.extend(more.iter().map(|&argument| argument.to_owned()));
    arguments.extend(["--out".to_owned(), out.display().to_string()]);
    let said = succeed(&arguments);
    (out, said)
}
