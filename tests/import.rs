//! What an import says of odd sources: each remark names the file and what to do.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
mod support;

use std::path::{Path, PathBuf};

use gdal::DriverManager;
use gdal::raster::{ColorEntry, ColorInterpretation, ColorTable};
use support::{import_arguments, rilievo, sample, succeed};

/// Imports the sample with changed arguments; what it prints.
fn import_with(folder: &Path, change: impl FnOnce(&mut Vec<String>)) -> String {
    let mut arguments = import_arguments(&sample().join("files"), &folder.join("city"));
    change(&mut arguments);
    succeed(&arguments)
}

/// A small raster of 8 x 8 pixels of 8 m, heights or palette indices all 0, with its north-west corner given.
fn raster(path: PathBuf, epsg: u32, corner: [f64; 2], palette: Option<[i16; 3]>) -> String {
    let driver = DriverManager::get_driver_by_name("GTiff").unwrap();
    let mut file = driver.create_with_band_type::<u8, _>(&path, 8, 8, 1).unwrap();
    file.set_geo_transform(&[corner[0], 8.0, 0.0, corner[1], 0.0, -8.0])
        .unwrap();
    file.set_spatial_ref(&gdal::spatial_ref::SpatialRef::from_epsg(epsg).unwrap())
        .unwrap();
    if let Some([r, g, b]) = palette {
        let mut table = ColorTable::new(gdal::raster::PaletteInterpretation::Rgba);
        table.set_color_entry(0, &ColorEntry::rgba(r, g, b, 255));
        let mut band = file.rasterband(1).unwrap();
        band.set_color_table(&table);
        band.set_color_interpretation(ColorInterpretation::PaletteIndex)
            .unwrap();
    }
    file.close().unwrap();
    path.display().to_string()
}

#[test]
fn files_that_lie_elsewhere_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let elsewhere = raster(
        folder.path().join("elsewhere.tif"),
        32633,
        [500_000.0, 100_000.0],
        None,
    );
    let report = import_with(folder.path(), |arguments| {
        arguments.insert(3, elsewhere.clone());
        let imagery = 1 + arguments
            .iter()
            .position(|argument| argument == "--photo")
            .unwrap();
        arguments.insert(imagery, elsewhere);
    });
    assert_eq!(
        report.matches("elsewhere.tif lies outside the city").count(),
        2,
        "{report}"
    );
}

#[test]
fn a_crs_made_for_another_place_is_remarked_on() {
    let folder = tempfile::tempdir().unwrap();
    let dutch = |arguments: &mut Vec<String>| arguments.extend(["--crs".to_owned(), "EPSG:28992".to_owned()]);
    let report = import_with(folder.path(), dutch);
    assert!(
        report.contains("outside the area that EPSG:28992 is made for"),
        "{report}"
    );
    let own = import_with(&folder.path().join("own"), |_| ());
    assert!(!own.contains("outside the area"), "{own}");
}

#[test]
fn heights_without_a_unit_in_a_crs_in_feet_are_remarked_on() {
    let folder = tempfile::tempdir().unwrap();
    let in_feet = |arguments: &mut Vec<String>| {
        let crs = "EPSG:2229".to_owned();
        arguments.extend([
            "--terrain-crs".to_owned(),
            crs.clone(),
            "--buildings-crs".to_owned(),
            crs,
        ]);
        let imagery = arguments
            .iter()
            .position(|argument| argument == "--photo")
            .unwrap();
        arguments.drain(imagery..imagery + 5);
    };
    let report = import_with(folder.path(), in_feet);
    assert!(
        report.contains("terrain.tif is in a CRS that is not in metres"),
        "{report}"
    );
    let told = import_with(&folder.path().join("told"), |arguments| {
        in_feet(arguments);
        arguments.extend(["--terrain-unit".to_owned(), "0.3048".to_owned()]);
    });
    assert!(!told.contains("not in metres"), "{told}");
}

#[test]
fn a_photo_with_a_colour_table_keeps_its_colours() {
    let folder = tempfile::tempdir().unwrap();
    let corner = [289_400.0, 4_773_100.0];
    let red = raster(folder.path().join("red.tif"), 32633, corner, Some([200, 30, 10]));
    import_with(folder.path(), |arguments| {
        let imagery = arguments
            .iter()
            .position(|argument| argument == "--photo")
            .unwrap();
        arguments.drain(imagery + 1..imagery + 5);
        arguments.insert(imagery + 1, red);
    });
    let mut pixels = 0;
    for tile in std::fs::read_dir(folder.path().join("city/photo/0")).unwrap() {
        let imagery = gdal::Dataset::open(tile.unwrap().path()).unwrap();
        let band = |index| imagery.rasterband(index).unwrap().read_band_as::<u8>().unwrap();
        let bands = [band(1), band(2), band(3), band(4)];
        for (k, alpha) in bands[3].data().iter().enumerate() {
            if *alpha == 255 {
                let colour = [0, 1, 2].map(|channel: usize| bands[channel].data()[k]);
                assert_eq!(colour, [200, 30, 10]);
                pixels += 1;
            }
        }
    }
    assert!(pixels >= 64, "{pixels}");
}

#[test]
fn an_empty_layer_is_refused_as_empty() {
    let folder = tempfile::tempdir().unwrap();
    let empty = folder.path().join("empty.gpkg");
    let driver = DriverManager::get_driver_by_name("GPKG").unwrap();
    let mut file = driver.create_vector_only(&empty).unwrap();
    file.create_layer(gdal::vector::LayerOptions {
        name: "houses",
        srs: Some(&gdal::spatial_ref::SpatialRef::from_epsg(32633).unwrap()),
        ty: gdal::vector::OGRwkbGeometryType::wkbPolygon,
        ..Default::default()
    })
    .unwrap();
    file.close().unwrap();
    let mut arguments = import_arguments(&sample().join("files"), &folder.path().join("city"));
    let buildings = 1 + arguments
        .iter()
        .position(|argument| argument == "--buildings")
        .unwrap();
    arguments[buildings] = empty.display().to_string();
    let heights = arguments
        .iter()
        .position(|argument| argument == "--height-field")
        .unwrap();
    arguments.drain(heights..heights + 2);
    let output = rilievo(&arguments);
    assert_eq!(output.status.code(), Some(1));
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(
        message.contains("empty.gpkg: its layer holds no features"),
        "{message}"
    );
}

/// Closed polylines of an AutoCAD drawing (DXF reference, ENTITIES section), two layers of it.
fn drawing(path: &Path, corner: [f64; 2]) {
    let square = |layer: &str, [x, y]: [f64; 2]| {
        let mut text = format!("0\nLWPOLYLINE\n8\n{layer}\n90\n4\n70\n1\n");
        for [dx, dy] in [[0.0, 0.0], [9.0, 0.0], [9.0, 9.0], [0.0, 9.0]] {
            text += &format!("10\n{}\n20\n{}\n", x + dx, y + dy);
        }
        text
    };
    let [x, y] = corner;
    let mut text = "0\nSECTION\n2\nENTITIES\n".to_owned();
    for k in 0..3 {
        text += &square("WALLS", [x + 30.0 * f64::from(k), y]);
        text += &square("POOLS", [x + 30.0 * f64::from(k), y + 40.0]);
    }
    std::fs::write(path, text + "0\nENDSEC\n0\nEOF\n").unwrap();
}

/// Of a CAD drawing the named layer's outlines become buildings, and no others.
#[test]
fn a_layer_of_a_drawing_is_read_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plan.dxf");
    drawing(&path, [289_000.0, 4_773_000.0]);
    for (layer, expected) in [(Some("WALLS"), 3), (None, 6)] {
        let out = folder.path().join("city");
        let _ = std::fs::remove_dir_all(&out);
        import_with(folder.path(), |arguments| {
            let place = arguments
                .iter()
                .position(|argument| argument == "--buildings")
                .unwrap();
            arguments[place + 1] = path.display().to_string();
            let field = arguments
                .iter()
                .position(|argument| argument == "--height-field")
                .unwrap();
            arguments.drain(field..field + 2);
            arguments.extend(["--buildings-crs".to_owned(), "EPSG:32633".to_owned()]);
            if let Some(layer) = layer {
                arguments.extend(["--layer".to_owned(), layer.to_owned()]);
            }
        });
        let city = rilievo::city::City::open(&out).unwrap();
        assert_eq!(city.manifest().buildings, expected, "{layer:?}");
    }
}
