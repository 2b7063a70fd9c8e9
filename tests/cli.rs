//! The command line's promises: exit statuses, one-line errors that name the file and the remedy, JSON that is only JSON;
//! and every place of real data where it lies beside the project.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use std::fs;
use std::path::Path;

use serde_json::Value;
use support::{rilievo, sample, shared_data, succeed};

/// Runs, requires status 1 and a single line, and returns it.
fn refused(arguments: &[&str]) -> String {
    let output = rilievo(arguments);
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{arguments:?}: {text}");
    let lines: Vec<&str> = text.lines().filter(|line| line.starts_with("rilievo:")).collect();
    assert_eq!(lines.len(), 1, "{text}");
    lines[0].to_owned()
}

#[test]
fn wrong_usage_is_status_2() {
    for arguments in [
        &["fly-away"][..],
        &["import"],
        &[
            "render", "city", "--eye", "1,2", "--look", "0,0,0", "--out", "x.png",
        ],
    ] {
        assert_eq!(rilievo(arguments).status.code(), Some(2), "{arguments:?}");
    }
}

#[test]
fn errors_name_the_file_and_the_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    let files = sample().join("files");
    let terrain = files.join("terrain.tif").display().to_string();
    let buildings = files.join("buildings.gpkg").display().to_string();
    let imagery = files.join("photo_0_0.tif").display().to_string();
    let out = path("city");

    let error = refused(&[
        "import",
        "--terrain",
        &path("none.tif"),
        "--buildings",
        &buildings,
        "--out",
        &out,
    ]);
    assert!(
        error.contains("none.tif") && error.contains("gdalinfo"),
        "{error}"
    );

    let error = refused(&[
        "import",
        "--terrain",
        &imagery,
        "--buildings",
        &buildings,
        "--out",
        &out,
    ]);
    assert!(
        error.contains("photo_0_0.tif") && error.contains("--photo"),
        "{error}"
    );

    let error = refused(&[
        "import",
        "--terrain",
        &terrain,
        "--buildings",
        &buildings,
        "--height-field",
        "hoehe",
        "--out",
        &out,
    ]);
    assert!(error.contains("hoehe") && error.contains("height_m"), "{error}");

    let error = refused(&[
        "import",
        "--terrain",
        &terrain,
        "--buildings",
        &buildings,
        "--crs",
        "EPSG:4326",
        "--out",
        &out,
    ]);
    assert!(error.contains("metres"), "{error}");

    let far = path("far.geojson");
    fs::write(&far, r#"{"type":"FeatureCollection","features":[{"type":"Feature","properties":{},"geometry":{"type":"Polygon","coordinates":[[[0,0],[0.001,0],[0.001,0.001],[0,0]]]}}]}"#).unwrap();
    let error = refused(&[
        "import",
        "--terrain",
        &terrain,
        "--buildings",
        &far,
        "--out",
        &out,
    ]);
    assert!(
        error.contains("far.geojson") && error.contains("--buildings-crs"),
        "{error}"
    );

    let error = refused(&["info", &path("nowhere")]);
    assert!(error.contains("nowhere") && error.contains("import"), "{error}");
    assert!(!Path::new(&out).exists(), "a refused import left a city");
}

#[test]
fn json_is_one_object_and_nothing_else() {
    let city = sample().join("city").display().to_string();
    let info: Value = serde_json::from_str(&succeed(&["info", &city, "--json"])).unwrap();
    assert_eq!(info["crs"], "EPSG:32633");
    assert_eq!(info["buildings"], info["footprints"]["kept"]);
    for key in [
        "tiles",
        "extent",
        "building_map_bytes",
        "triangle_bytes",
        "terrain_triangles",
    ] {
        assert!(!info[key].is_null(), "{key}");
    }
}

#[test]
fn odd_footprints_are_mended_counted_or_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("odd.geojson");
    let (e, n) = (289_200.0, 4_773_000.0);
    let polygon = |rings: &str| format!(r#"{{"type":"Polygon","coordinates":[{rings}]}}"#);
    let ring = |points: &[(f64, f64)]| {
        let texts: Vec<String> = points
            .iter()
            .map(|(x, y)| format!("[{},{}]", e + x, n + y))
            .collect();
        format!("[{}]", texts.join(","))
    };
    let square = ring(&[(0., 0.), (10., 0.), (10., 10.), (0., 10.), (0., 0.)]);
    let hole = ring(&[(3., 3.), (3., 6.), (6., 6.), (6., 3.), (3., 3.)]);
    let cases = [
        (r#""12.5 m""#, polygon(&square)),
        ("null", polygon(&format!("{square},{hole}"))),
        (
            r#""abc""#,
            polygon(&ring(&[(20., 0.), (30., 10.), (30., 0.), (20., 10.), (20., 0.)])),
        ),
        (
            "0",
            polygon(&ring(&[(40., 0.), (50., 0.), (50., 0.), (50., 9.), (40., 0.)])),
        ),
        ("5", polygon(&ring(&[(60., 0.), (70., 0.), (60., 0.)]))),
        ("5", polygon(&ring(&[(80., 0.), (85., 0.), (90., 0.), (80., 0.)]))),
        ("5", "null".to_owned()),
        (
            "5",
            r#"{"type":"Point","coordinates":[289200,4773000]}"#.to_owned(),
        ),
        (
            "5",
            polygon(&ring(&[(1e6, 0.), (1e6 + 9., 0.), (1e6, 9.), (1e6, 0.)])),
        ),
    ];
    let features: Vec<String> = cases
        .iter()
        .map(|(height, geometry)| {
            format!(r#"{{"type":"Feature","properties":{{"h":{height}}},"geometry":{geometry}}}"#)
        })
        .collect();
    let crs = r#""crs":{"type":"name","properties":{"name":"EPSG:32633"}}"#;
    fs::write(
        &file,
        format!(
            r#"{{"type":"FeatureCollection",{crs},"features":[{}]}}"#,
            features.join(",")
        ),
    )
    .unwrap();
    let out = folder.path().join("city").display().to_string();
    let terrain = sample().join("files/terrain.tif").display().to_string();
    let file = file.display().to_string();
    succeed(&[
        "import",
        "--terrain",
        &terrain,
        "--buildings",
        &file,
        "--height-field",
        "h",
        "--out",
        &out,
    ]);
    let info: Value = serde_json::from_str(&succeed(&["info", &out, "--json"])).unwrap();
    let report = &info["footprints"];
    assert_eq!(report["read"], 9);
    assert_eq!(report["kept"], 4, "{report}");
    assert_eq!(report["left_out"]["no geometry"], 1, "{report}");
    assert_eq!(report["left_out"]["not an area"], 1, "{report}");
    assert_eq!(report["left_out"]["no ground under it"], 1, "{report}");
    assert_eq!(
        report["mended"]["self-crossing or invalid outlines rebuilt"], 1,
        "{report}"
    );
    assert_eq!(report["mended"]["repeated points merged"], 1, "{report}");
    let left: u64 = report["left_out"]
        .as_object()
        .unwrap()
        .values()
        .filter_map(Value::as_u64)
        .sum();
    assert_eq!(left + 4, 9, "every feature is accounted for: {report}");
    // Ids are places in the source whatever was left out: the last kept one is the fourth.
    let city = rilievo::city::City::open(Path::new(&out)).unwrap();
    let fids: std::collections::BTreeSet<u32> = city
        .manifest()
        .grid
        .tiles()
        .filter_map(|tile| city.buildings(tile).unwrap())
        .flat_map(|map| map.roofs.into_iter().map(|roof| roof.fid))
        .collect();
    assert_eq!(fids.into_iter().collect::<Vec<_>>(), [1, 2, 3, 4]);
}

/// Place, terrain, footprints, further arguments, buildings kept at least.
type Place = (
    &'static str,
    &'static str,
    &'static str,
    &'static [&'static str],
    u64,
);

const PLACES: [Place; 9] = [
    (
        "alexandria",
        "alexandria_us/dtm.tif",
        "alexandria_us/buildings.geojson",
        &["--height-field", "HEIGHT"],
        84,
    ),
    (
        "gothenburg",
        "gothenburg_se/torgg_2m_epsg3006/torgg_dem.tif",
        "gothenburg_se/derived_kronhuset_buildings_epsg3006.gpkg",
        &["--height-field", "height_m"],
        137,
    ),
    (
        "lorient",
        "lorient_fr/derived_dtm_75m.tif",
        "lorient_fr/buildings.shp",
        &["--height-field", "HEIGHT"],
        1701,
    ),
    (
        "mamre",
        "mamre_za/LO19_050M_3318CB.tif",
        "mamre_za/derived_buildings_epsg32734.gpkg",
        &["--storeys-field", "levels"],
        2344,
    ),
    (
        "mamre CityJSON",
        "mamre_za/derived_dtm25_utm34s_clip.tif",
        "mamre_za/citjsn_mamre3D.city.json",
        &[],
        2344,
    ),
    (
        "monaco",
        "monaco_mc/N43E007.hgt",
        "monaco_mc/monaco-latest.osm.pbf",
        &["--storeys-field", "building:levels"],
        1207,
    ),
    (
        "onet",
        "onet_le_chateau_fr/derived_dtm_25m_from_zmin_minus_hauteur.tif",
        "onet_le_chateau_fr/bdtopo_v2/BATI_INDIFFERENCIE.shp",
        &["--height-field", "hauteur"],
        10_400,
    ),
    (
        "swellendam",
        "swellendam_za/srtm_41_19_4326.tif",
        "swellendam_za/training_data.gpkg",
        &["--layer", "buildings", "--storeys-field", "building:levels"],
        4708,
    ),
    (
        "zurich",
        "zurich_lidar_ch/derived_dtm_1m_epsg2056.tif",
        "zurich_lidar_ch/derived_buildings_epsg2056.gpkg",
        &["--height-field", "height_m"],
        7,
    ),
];

#[test]
fn real_places_import() {
    let Some(data) = shared_data() else { return };
    let folder = tempfile::tempdir().unwrap();
    for (name, terrain, buildings, more, least) in PLACES {
        let out = folder.path().join(name).display().to_string();
        let (terrain, buildings) = (data.join(terrain), data.join(buildings));
        let (terrain, buildings) = (terrain.display().to_string(), buildings.display().to_string());
        let mut arguments = vec![
            "import",
            "--terrain",
            &terrain,
            "--buildings",
            &buildings,
            "--out",
            &out,
        ];
        arguments.extend(more);
        succeed(&arguments);
        let info: Value = serde_json::from_str(&succeed(&["info", &out, "--json"])).unwrap();
        let kept = info["buildings"].as_u64().unwrap();
        println!("{name}: {kept} buildings in {}", info["crs"]);
        assert!(kept >= least, "{name}: {kept} of at least {least}");
    }
}
