//! Coordinate reference systems against figures from elsewhere: EPSG's worked examples (IOGP guidance note 7-2), national
//! surveys, and pyproj 3.7.2, which brings a PROJ and a registry of its own (9.5.1).
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use glam::DVec2;
use rilievo::space::{Accuracy, Crs, GeoArea, Operation, OperationWarning, Place, PointTransform};

fn crs(text: &str) -> Crs {
    Crs::from_text(text).unwrap_or_else(|error| panic!("{text}: {error}"))
}

fn transform(from: &Crs, to: &Crs, point: [f64; 2]) -> DVec2 {
    let transform = PointTransform::new(from, to).unwrap();
    transform.point(DVec2::from(point)).unwrap()
}

fn area(west_deg: f64, south_deg: f64, east_deg: f64, north_deg: f64) -> GeoArea {
    GeoArea {
        west_deg,
        south_deg,
        east_deg,
        north_deg,
    }
}

fn degrees(whole: f64, minutes: f64, seconds: f64) -> f64 {
    whole + minutes / 60.0 + seconds / 3600.0
}

#[test]
fn projections_give_the_published_coordinates() {
    let cases = [
        // IOGP 373-7-2, Lambert Conic Conformal (2SP): NAD27 / Texas South Central, US survey feet.
        (
            "EPSG:4267",
            "EPSG:32040",
            [-96.0, 28.5],
            [2_963_503.91, 254_759.80],
        ),
        // IOGP 373-7-2, Transverse Mercator: OSGB36 / British National Grid.
        ("EPSG:4277", "EPSG:27700", [0.5, 50.5], [577_274.99, 69_740.50]),
        // IOGP 373-7-2, Krovak: southing and westing, and with axes east and north.
        (
            "EPSG:4156",
            "EPSG:5513",
            [degrees(16.0, 50.0, 59.179), degrees(50.0, 12.0, 32.442)],
            [1_050_538.63, 568_991.00],
        ),
        (
            "EPSG:4156",
            "EPSG:5514",
            [degrees(16.0, 50.0, 59.179), degrees(50.0, 12.0, 32.442)],
            [-568_991.00, -1_050_538.63],
        ),
        // IOGP 373-7-2, Hotine Oblique Mercator (variant B): Timbalai 1948 / RSO Borneo.
        (
            "EPSG:4298",
            "EPSG:29873",
            [degrees(115.0, 48.0, 19.8196), degrees(5.0, 23.0, 14.1129)],
            [679_245.73, 596_562.78],
        ),
        // Ordnance Survey, A guide to coordinate systems in Great Britain, annexe C: Caister water tower.
        (
            "EPSG:4277",
            "EPSG:27700",
            [degrees(1.0, 43.0, 4.5177), degrees(52.0, 39.0, 27.2531)],
            [651_409.903, 313_177.270],
        ),
        // swisstopo: the old observatory in Bern is the origin of LV03.
        (
            "EPSG:4149",
            "EPSG:21781",
            [degrees(7.0, 26.0, 22.5), degrees(46.0, 57.0, 8.66)],
            [600_000.0, 200_000.0],
        ),
    ];
    for (from, to, point, expected) in cases {
        let found = transform(&crs(from), &crs(to), point);
        let off = (found - DVec2::from(expected)).length();
        // The examples are rounded to centimetres, their seconds of arc to 0.03 mm and 3 mm.
        assert!(off < 0.02, "{to}: {found}, {off} off");
        let operation = Operation::between(&crs(from), &crs(to)).unwrap().unwrap();
        assert_eq!(
            operation.accuracy,
            Accuracy::Metres(0.0),
            "{to}: a pure projection"
        );
    }
}

#[test]
fn x_is_east_and_y_is_north_whatever_the_authority_says() {
    // By definition: central meridian and false easting of the zone; northings by pyproj, to a millimetre.
    for (from, to, point, expected) in [
        (
            "EPSG:4314",
            "EPSG:31467",
            [9.0, 50.0],
            [3_500_000.0, 5_540_279.542],
        ),
        (
            "EPSG:4167",
            "EPSG:2193",
            [173.0, -41.0],
            [1_600_000.0, 5_461_242.938],
        ),
        (
            "EPSG:4167",
            "EPSG:2193",
            [174.5, -41.0],
            [1_726_154.332, 5_460_159.418],
        ),
        // Westing and southing stay what they are: they are refused as a city's, not mirrored.
        ("EPSG:4148", "EPSG:2048", [19.0, -33.5], [0.0, 3_708_202.502]),
        (
            "EPSG:4148",
            "EPSG:2048",
            [19.1, -33.5],
            [-9_292.256, 3_708_206.977],
        ),
    ] {
        let found = transform(&crs(from), &crs(to), point);
        assert!((found - DVec2::from(expected)).length() < 2e-3, "{to}: {found}");
    }
    assert!(crs("EPSG:2193").is_metric() && crs("EPSG:31467").is_metric());
    for unfit in [
        "EPSG:2048",
        "EPSG:5513",
        "EPSG:4326",
        "EPSG:3857",
        "EPSG:2230",
        "EPSG:3395",
    ] {
        assert!(!crs(unfit).is_metric(), "{unfit}");
    }
}

#[test]
fn coordinates_of_a_file_are_read_as_gdal_reads_them() {
    use gdal::spatial_ref::{AxisMappingStrategy, CoordTransform, SpatialRef};
    let reference = |code: u32| {
        let mut reference = SpatialRef::from_epsg(code).unwrap();
        reference.set_axis_mapping_strategy(AxisMappingStrategy::TraditionalGisOrder);
        reference
    };
    for (geographic, projected, point) in [
        (4326, 32633, [15.5, 45.0]),
        (4314, 31467, [9.3, 50.2]),
        (4167, 2193, [174.0, -41.0]),
        (4148, 2048, [19.3, -33.5]),
        (4156, 5513, [16.0, 50.0]),
        (4156, 5514, [16.0, 50.0]),
        (4269, 2230, [-117.0, 32.8]),
        (4326, 3857, [10.0, 50.0]),
        (4326, 5041, [30.0, 80.0]),
    ] {
        let gdal = CoordTransform::new(&reference(geographic), &reference(projected)).unwrap();
        let (mut x, mut y) = ([point[0]], [point[1]]);
        gdal.transform_coords(&mut x, &mut y, &mut []).unwrap();
        let (from, to) = (
            crs(&format!("EPSG:{geographic}")),
            crs(&format!("EPSG:{projected}")),
        );
        let found = transform(&from, &to, point);
        assert!(
            (found - DVec2::new(x[0], y[0])).length() < 1e-6,
            "EPSG:{projected}: {found}, GDAL {x:?} {y:?}"
        );
        let back = transform(&to, &from, found.into());
        assert!(
            (back - DVec2::from(point)).length() < 1e-9,
            "EPSG:{projected}: {back}"
        );
    }
}

#[test]
fn datum_shifts_are_as_accurate_as_they_say() {
    let metres_apart = |a: DVec2, b: DVec2| {
        let metres = 6_378_137.0_f64.to_radians();
        ((a - b) * DVec2::new(metres * a.y.to_radians().cos(), metres)).length()
    };
    // (CRS, point in it, the same place in WGS 84 or ETRS89, CRS of that, area)
    // Ordnance Survey, guide for OSTN15: ETRS89 52 39 28.723 N, 1 42 57.787 E is 651409.804, 313177.450.
    let caister = DVec2::new(degrees(1.0, 42.0, 57.787), degrees(52.0, 39.0, 28.723));
    // swisstopo: Bern, 2600000 1200000 in LV95.
    let bern = DVec2::new(7.438_632_421, 46.951_082_772);
    // Survey and Mapping Office, Hong Kong: HK80 origin 22 18 43.68 N, 114 10 42.80 E lies 5.5 s, 8.8 s from WGS 84.
    let hong_kong = DVec2::new(
        degrees(114.0, 10.0, 42.80 + 8.8),
        degrees(22.0, 18.0, 43.68 - 5.5),
    );
    for (projected, point, truth, globe) in [
        ("EPSG:27700", [651_409.804, 313_177.450], caister, "EPSG:4258"),
        ("EPSG:2056", [2_600_000.0, 1_200_000.0], bern, "EPSG:4326"),
        ("EPSG:21781", [600_000.0, 200_000.0], bern, "EPSG:4326"),
        ("EPSG:2326", [836_694.05, 819_069.80], hong_kong, "EPSG:4326"),
    ] {
        let around = GeoArea::from_points(&[truth]).unwrap().grown(0.05);
        let (from, to) = (crs(projected).used_in(Some(around)), crs(globe));
        let operation = Operation::between(&from, &to).unwrap().unwrap();
        let found = transform(&from, &to, point);
        let off = metres_apart(found, truth);
        let Accuracy::Metres(stated) = operation.accuracy else {
            panic!("{projected}: {operation:?}");
        };
        println!(
            "{projected}: {off:.3} m off, stated {stated} m: {}",
            operation.name
        );
        // Hong Kong's tenths of a second are 3 m.
        let rounding_m = if projected == "EPSG:2326" { 3.0 } else { 0.02 };
        assert!(off <= stated + rounding_m, "{projected}: {off} m, {operation:?}");
        let round_trip = transform(&to, &from, found.into());
        assert!(
            (round_trip - DVec2::from(point)).length() < 5e-3,
            "{projected}: {round_trip} (heights are left out both times)"
        );
    }
}

#[test]
fn the_area_decides_between_operations() {
    // pyproj: ED50 in Finland by "ED50 to WGS 84 (7)", in Cyprus by (30); NAD27 in Havana by "NAD27 to WGS 84 (88)".
    for (from, around, point, expected, name, metres) in [
        (
            "EPSG:4230",
            area(25.0, 61.5, 25.5, 61.9),
            [25.25, 61.7],
            [25.249_077_515, 61.699_745_632],
            "ED50 to WGS 84 (7)",
            7.0,
        ),
        (
            "EPSG:4230",
            area(33.0, 35.0, 34.0, 35.4),
            [33.5, 35.2],
            [33.499_707_550, 35.198_925_876],
            "ED50 to WGS 84 (30)",
            2.0,
        ),
        (
            "EPSG:4267",
            area(-82.5, 22.9, -82.2, 23.2),
            [-82.35, 23.1],
            [-82.349_870_761, 23.100_455_877],
            "NAD27 to WGS 84 (88)",
            1.0,
        ),
    ] {
        let (from, to) = (crs(from).used_in(Some(around)), crs("EPSG:4326"));
        let operation = Operation::between(&from, &to).unwrap().unwrap();
        assert!(operation.name.contains(name), "{operation:?}");
        assert_eq!(operation.accuracy, Accuracy::Metres(metres), "{operation:?}");
        let found = transform(&from, &to, point);
        assert!((found - DVec2::from(expected)).length() < 1e-8, "{name}: {found}");
    }
}

#[test]
fn a_missing_grid_is_named_and_a_ballpark_is_the_last_resort() {
    let caister = area(1.6, 52.6, 1.8, 52.7);
    let (from, to) = (crs("EPSG:4258").used_in(Some(caister)), crs("EPSG:27700"));
    let operation = Operation::between(&from, &to).unwrap().unwrap();
    // With OSTN15 0.03 m, without it by way of WGS 84.
    assert!(
        operation.accuracy.metres().is_some_and(|metres| metres <= 3.0),
        "{operation:?}"
    );
    if operation.accuracy.metres() > Some(0.5) {
        let warning = operation.warning(&from, &to).expect("a better one needs a grid");
        assert!(matches!(&warning, OperationWarning::MissingGrids { better, .. }
            if better.files.iter().any(|file| file.contains("OSTN15"))));
        let sentence = warning.to_string();
        assert!(sentence.contains("OSTN15"), "{sentence}");
    }

    let stranger = crs(
        r#"GEOGCS["village",DATUM["village datum",SPHEROID["Bessel 1841",6377397.155,299.1528128]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]]"#,
    );
    let (from, to) = (stranger, crs("EPSG:32633"));
    let operation = Operation::between(&from, &to).unwrap().unwrap();
    assert_eq!(operation.accuracy, Accuracy::Ballpark);
    let warning = operation.warning(&from, &to);
    assert!(
        matches!(warning, Some(OperationWarning::Ballpark { .. })),
        "{warning:?}"
    );
}

#[test]
fn an_ellipsoid_with_other_digits_is_no_other_datum() {
    // The terrain of Mamre names EPSG:4326 and writes its flattening as 1/298.257223600004.
    let rounded = crs(
        r#"PROJCS["",GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223600004,AUTHORITY["EPSG","7030"]],AUTHORITY["EPSG","6326"]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433,AUTHORITY["EPSG","9122"]],AUTHORITY["EPSG","4326"]],PROJECTION["Transverse_Mercator"],PARAMETER["latitude_of_origin",0],PARAMETER["central_meridian",19],PARAMETER["scale_factor",1],PARAMETER["false_easting",0],PARAMETER["false_northing",0],UNIT["metre",1,AUTHORITY["EPSG","9001"]],AXIS["Easting",EAST],AXIS["Northing",NORTH]]"#,
    );
    assert!(rounded.is_metric() && !rounded.label().starts_with("EPSG:"));
    let operation = Operation::between(&crs("EPSG:32734"), &rounded).unwrap().unwrap();
    assert_eq!(operation.accuracy, Accuracy::Metres(0.0));
    assert!(!operation.name.contains("Ballpark"), "{operation:?}");
    assert_eq!(crs(rounded.label()), rounded, "a label reads back");
}

#[test]
fn feet_are_feet_and_heights_keep_their_unit() {
    // Example of the PROJ crate's documentation: NAD83 / California zone 6 in US survey feet and in metres.
    let found = transform(
        &crs("EPSG:2230"),
        &crs("EPSG:26946"),
        [4_760_096.421_921, 3_744_293.729_449],
    );
    assert!(
        (found - DVec2::new(1_450_880.291, 1_141_263.011)).length() < 1e-3,
        "{found}"
    );
    let foot = 1200.0 / 3937.0;
    let feet = crs("EPSG:2230");
    assert!(feet.has_non_metric_lengths());
    assert!((feet.metres_per_unit_at(DVec2::ZERO) - DVec2::splat(foot)).length() < 1e-12);
    // A degree on the equator of WGS 84 is 111319.49 m; at 60 degrees half of it along the parallel.
    let degree = crs("EPSG:4326").metres_per_unit_at(DVec2::new(0.0, 60.0));
    assert!(
        (degree - DVec2::new(55_659.75, 111_319.49)).length() < 0.01,
        "{degree}"
    );
    // EPSG:6360 is NAVD88 height in US survey feet, 5703 in metres, 8228 in feet.
    for (compound, unit) in [
        ("EPSG:2230+6360", Some(foot)),
        ("EPSG:2230+8228", Some(0.3048)),
        ("EPSG:2230+5703", Some(1.0)),
        ("EPSG:7415", Some(1.0)),
        ("EPSG:2230", None),
    ] {
        let found = crs(compound).metres_per_height_unit();
        assert!(
            found
                .zip(unit)
                .map_or(found == unit, |(a, b)| (a - b).abs() < 1e-9),
            "{compound}: {found:?}"
        );
    }
    assert_eq!(
        crs("EPSG:7415").label(),
        "EPSG:28992",
        "only the horizontal part stays"
    );
}

#[test]
fn text_without_a_code_finds_its_registered_twin() {
    let esri = r#"PROJCS["NAD_1983_UTM_Zone_18N",GEOGCS["GCS_North_American_1983",DATUM["D_North_American_1983",SPHEROID["GRS_1980",6378137.0,298.257222101]],PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],PARAMETER["False_Easting",500000.0],PARAMETER["False_Northing",0.0],PARAMETER["Central_Meridian",-75.0],PARAMETER["Scale_Factor",0.9996],PARAMETER["Latitude_Of_Origin",0.0],UNIT["Meter",1.0]]"#;
    assert_eq!(crs(esri).label(), "EPSG:26918");
    assert!(
        PointTransform::new(&crs(esri), &crs("EPSG:26918"))
            .unwrap()
            .is_identity()
    );
    let french = r#"PROJCS["RGF93 / Lambert-93",GEOGCS["RGF93",DATUM["Reseau_Geodesique_Francais_1993",SPHEROID["GRS 1980",6378137,298.257222101,AUTHORITY["EPSG","7019"]],AUTHORITY["EPSG","6171"]],PRIMEM["Greenwich",0,AUTHORITY["EPSG","8901"]],UNIT["degree",0.0174532925199433,AUTHORITY["EPSG","9122"]],AUTHORITY["EPSG","4171"]],PROJECTION["Lambert_Conformal_Conic_2SP"],PARAMETER["standard_parallel_1",49],PARAMETER["standard_parallel_2",44],PARAMETER["latitude_of_origin",46.5],PARAMETER["central_meridian",3],PARAMETER["false_easting",700000],PARAMETER["false_northing",6600000],UNIT["metre",1,AUTHORITY["EPSG","9001"]],AXIS["X",EAST],AXIS["Y",NORTH],AUTHORITY["EPSG","2154"]]"#;
    assert!(
        PointTransform::new(&crs(french), &crs("EPSG:2154"))
            .unwrap()
            .is_identity()
    );
    let from_proj = crs("+proj=utm +zone=33 +datum=WGS84");
    let found = transform(&crs("EPSG:4326"), &from_proj, [15.0, 0.0]);
    assert!(from_proj.is_metric() && (found - DVec2::new(500_000.0, 0.0)).length() < 1e-6);
    assert_eq!(from_proj.label(), "EPSG:32633");
    for nonsense in [
        "",
        "EPSG:0",
        "nonsense",
        "EPSG:5703",
        "EPSG:4978",
        "PROJCS[",
        "a\0b",
    ] {
        let error = Crs::from_text(nonsense).expect_err(nonsense).to_string();
        assert!(error.contains("EPSG:25832"), "{nonsense}: {error}");
    }
}

#[test]
fn the_identity_changes_no_bit_and_points_outside_become_nan() {
    let same = PointTransform::new(&crs("EPSG:32633"), &crs("EPSG:32633")).unwrap();
    let (mut xs, mut ys) = ([0.1 + 0.2, f64::MAX], [-0.0, 1e-300]);
    same.points(&mut xs, &mut ys);
    assert_eq!(
        (xs.map(f64::to_bits), ys.map(f64::to_bits)),
        (
            [0.1 + 0.2, f64::MAX].map(f64::to_bits),
            [-0.0, 1e-300_f64].map(f64::to_bits)
        )
    );
    let to_utm = PointTransform::new(&crs("EPSG:4326"), &crs("EPSG:32633")).unwrap();
    let (mut xs, mut ys) = (
        [15.0, 15.0, f64::NAN, 1e300, 15.0],
        [45.0, 91.0, 45.0, 45.0, f64::INFINITY],
    );
    to_utm.points(&mut xs, &mut ys);
    assert!((xs[0] - 500_000.0).abs() < 1e-6, "{xs:?}");
    assert!(
        xs[1..].iter().chain(&ys[1..]).all(|value| value.is_nan()),
        "{xs:?} {ys:?}"
    );
}

#[test]
fn areas_reach_over_the_date_line() {
    let fiji = GeoArea::from_points(&[DVec2::new(179.0, -17.0), DVec2::new(-179.5, -16.0)]).unwrap();
    assert_eq!((fiji.west_deg, fiji.east_deg), (179.0, -179.5));
    assert!((fiji.centre() - DVec2::new(179.75, -16.5)).length() < 1e-9);
    assert!(fiji.contains(DVec2::new(-179.9, -16.5)) && !fiji.contains(DVec2::new(0.0, -16.5)));
    let east = area(-180.0, -17.0, -179.0, -16.0);
    assert_eq!(fiji.intersection(&east), Some(area(180.0, -17.0, -179.5, -16.0)));
    assert_eq!(fiji.intersection(&area(10.0, -17.0, 20.0, -16.0)), None);
    assert_eq!(GeoArea::from_points(&[DVec2::NAN]), None);
    // Fiji Map Grid (EPSG:3460) by pyproj, on both sides of the line.
    let grid = crs("EPSG:3460").used_in(Some(fiji));
    for (point, expected) in [
        ([179.5, -17.0], [2_079_837.870, 3_999_843.059]),
        ([-179.5, -17.0], [2_186_329.948, 3_999_163.733]),
    ] {
        let found = transform(&crs("EPSG:4326"), &grid, point);
        assert!((found - DVec2::from(expected)).length() < 2e-3, "{found}");
    }
    let at = |longitude_deg: f64, latitude_deg: f64| Place {
        latitude_deg,
        longitude_deg,
        grid_north_deg: 0.0,
    };
    assert!(grid.is_meant_for(&at(-179.0, -17.0)) && grid.is_meant_for(&at(178.0, -17.0)));
    assert!(!grid.is_meant_for(&at(10.0, 50.0)));
}

/// Two copies of PROJ in one process would each read what the other's environment names.
#[cfg(target_os = "linux")]
#[test]
fn there_is_one_libproj() {
    let _used = (
        crs("EPSG:4326"),
        gdal::spatial_ref::SpatialRef::from_epsg(4326).unwrap(),
    );
    let maps = std::fs::read_to_string("/proc/self/maps").unwrap();
    let of_proj: Vec<&str> = maps.lines().filter(|line| line.contains("libproj")).collect();
    let files: std::collections::BTreeSet<&str> = of_proj
        .iter()
        .filter_map(|line| line.split_whitespace().last())
        .collect();
    assert_eq!(files.len(), 1, "{files:?}");
    let address = proj_sys::proj_create as *const () as usize;
    let holds = |line: &&str| {
        let (from, to) = line.split_once(' ')?.0.split_once('-')?;
        let bound = |text| usize::from_str_radix(text, 16).ok();
        Some((bound(from)?..bound(to)?).contains(&address))
    };
    assert!(
        of_proj.iter().any(|line| holds(line) == Some(true)),
        "proj_create is not that library's"
    );
}

/// Drawing reads the city's tiles and nothing else: without PROJ's registry, GDAL's files and the GeoPackage the same picture.
#[test]
fn drawing_needs_neither_proj_nor_gdal() {
    let folder = tempfile::tempdir().unwrap();
    let city = folder.path().join("city");
    copy(&support::sample().join("city"), &city);
    let draw = |name: &str, blind: bool| {
        let out = folder.path().join(name);
        let mut program = std::process::Command::new(support::PROGRAM);
        program.args(["render", "--size", "160x90", "--samples", "1"]);
        program.args([
            "--eye",
            "288900,4772600,400",
            "--look",
            "289180,4773000,215",
            "--out",
        ]);
        program.arg(&out).arg(&city);
        if blind {
            for variable in ["PROJ_DATA", "PROJ_LIB", "GDAL_DATA", "GDAL_DRIVER_PATH"] {
                program.env(variable, "/nowhere");
            }
        }
        let output = program.output().unwrap();
        assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
        std::fs::read(out).unwrap()
    };
    let seeing = draw("seeing.png", false);
    std::fs::remove_file(city.join("buildings.gpkg")).unwrap();
    assert!(seeing == draw("blind.png", true), "the pictures differ");
}

fn copy(from: &std::path::Path, to: &std::path::Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy(&entry.path(), &target);
        } else {
            std::fs::copy(entry.path(), target).unwrap();
        }
    }
}

/// The manifest and `info` say how the coordinates came in and how far they may be off.
#[test]
fn info_shows_the_operation_and_its_accuracy() {
    let folder = tempfile::tempdir().unwrap();
    let files = support::sample().join("files");
    let out = folder.path().join("city");
    let mut arguments = support::import_arguments(&files, &out);
    // The sample lies in WGS 84 / UTM 33; ETRS89 is a metre from it.
    arguments.extend(["--crs".to_owned(), "EPSG:25833".to_owned()]);
    support::succeed(&arguments);
    let city = out.display().to_string();
    let json: serde_json::Value =
        serde_json::from_str(&support::succeed(&["info", &city, "--json"])).unwrap();
    let operations = json["operations"].as_array().unwrap();
    let roles: Vec<&str> = operations
        .iter()
        .filter_map(|record| record["role"].as_str())
        .collect();
    assert_eq!(roles, ["terrain", "buildings", "photo"]);
    for record in operations {
        assert_eq!(record["from"], "EPSG:32633");
        assert_eq!(record["accuracy_m"], 1.0, "{record}");
        assert_eq!(record["ballpark"], false);
    }
    let text = support::succeed(&["info", &city]);
    assert!(text.contains("from EPSG:32633, accurate to 1 m"), "{text}");
}
