//! Heights that find themselves: which field gave each building its own, told feature by feature and counted.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use gdal::vector::{LayerAccess, sql::Dialect};
use gdal::{Dataset, DatasetOptions, GdalOpenFlags};
use rilievo::buildings::Building;
use rilievo::city::{City, building_map, buildings_by_tile};
use serde_json::{Value, json};
use support::{sample, shared_data, succeed};

/// A GeoJSON of 10 m squares, 20 m apart on the sample's terrain, one for each object of properties; the first lies
/// 1,000 km away, so that ids and rows differ in what is kept.
fn footprints(path: PathBuf, properties: &[Value]) -> String {
    let square = |east: f64| {
        let north = 4_773_000.0;
        let ring = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0], [0.0, 0.0]];
        let ring: Vec<[f64; 2]> = ring.iter().map(|[x, y]| [east + x, north + y]).collect();
        json!({"type": "Polygon", "coordinates": [ring]})
    };
    let features: Vec<Value> = (0..)
        .zip(properties)
        .map(|(k, properties)| {
            let east = 289_200.0 + 20.0 * f64::from(k) + if k == 0 { 1e6 } else { 0.0 };
            json!({"type": "Feature", "properties": properties, "geometry": square(east)})
        })
        .collect();
    let crs = json!({"type": "name", "properties": {"name": "EPSG:32633"}});
    let file = json!({"type": "FeatureCollection", "crs": crs, "features": features});
    fs::write(&path, file.to_string()).unwrap();
    path.display().to_string()
}

fn import(buildings: &str, more: &[&str], out: &Path) -> String {
    let terrain = sample().join("files/terrain.tif").display().to_string();
    let out = out.display().to_string();
    let mut arguments = vec![
        "import",
        "--terrain",
        &terrain,
        "--buildings",
        buildings,
        "--out",
        &out,
    ];
    arguments.extend(more);
    succeed(&arguments)
}

/// Height of every building as the city's tiles hold it.
fn heights(city: &Path) -> BTreeMap<u32, f32> {
    let city = City::open(city).unwrap();
    let tiles = city.manifest().grid.tiles();
    tiles
        .filter_map(|tile| city.buildings(tile).unwrap())
        .flat_map(|map| map.roofs)
        .map(|roof| (roof.fid, roof.roof_m - roof.base_m))
        .collect()
}

/// The footprint dataset's buildings on the city's ground.
fn raised(city: &City) -> Vec<Building> {
    city.raised_buildings().unwrap()
}

fn same_heights(found: &BTreeMap<u32, f32>, expected: &[(u32, f32)]) {
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (fid, height) in expected {
        assert!((found[fid] - height).abs() < 1e-3, "{fid}: {found:?}");
    }
}

fn osm() -> Vec<Value> {
    vec![
        json!({"height": "7"}),
        json!({"height": "12.5 m", "building:levels": "9"}),
        json!({"height": "-1", "building:levels": "4", "roof:levels": "1"}),
        json!({"height": null, "building:levels": "3"}),
        json!({"height": "9999"}),
        json!({}),
        json!({"height": "40'"}),
    ]
}

#[test]
fn the_best_usable_field_of_each_feature_gives_its_height() {
    let folder = tempfile::tempdir().unwrap();
    let file = footprints(folder.path().join("osm.geojson"), &osm());
    let out = folder.path().join("city");
    let said = import(&file, &[], &out);
    same_heights(
        &heights(&out),
        &[
            (2, 12.5),
            (3, 16.0),
            (4, 9.6),
            (5, 6.0),
            (6, 6.0),
            (7, 40.0 * 0.3048),
        ],
    );
    let expected =
        "2 from \"height\" (metres), 2 from \"building:levels\" (+ \"roof:levels\") x 3.2 m, 2 default";
    assert!(said.contains(expected), "{said}");
    let info: Value =
        serde_json::from_str(&succeed(&["info", &out.display().to_string(), "--json"])).unwrap();
    let counts = info["footprints"]["heights"].as_array().unwrap();
    assert_eq!(counts[0]["buildings"], 2, "{info}");
    assert_eq!(counts[0]["unusable"], 2, "-1 and 9999: {info}");
    assert_eq!(counts[1]["buildings"], 2, "{info}");
    let defaults = info["footprints"]["default_heights"].as_object().unwrap();
    assert_eq!(
        defaults.values().filter_map(Value::as_u64).sum::<u64>(),
        2,
        "{info}"
    );

    // A named field decides alone.
    let alone = folder.path().join("alone");
    import(
        &file,
        &["--storeys-field", "building:levels", "--storey-height", "3"],
        &alone,
    );
    same_heights(
        &heights(&alone),
        &[(2, 27.0), (3, 12.0), (4, 9.0), (5, 6.0), (6, 6.0), (7, 6.0)],
    );
}

#[test]
fn a_city_of_its_own_footprint_dataset_is_the_same_and_an_edited_field_counts() {
    let folder = tempfile::tempdir().unwrap();
    let file = footprints(folder.path().join("osm.geojson"), &osm());
    let [first, second] = ["first", "second"].map(|name| folder.path().join(name));
    import(&file, &[], &first);
    let dataset = folder.path().join("copy.gpkg");
    fs::copy(first.join("buildings.gpkg"), &dataset).unwrap();
    import(&dataset.display().to_string(), &[], &second);
    for tile in fs::read_dir(first.join("buildings/0")).unwrap() {
        let name = tile.unwrap().file_name();
        let [a, b] = [&first, &second].map(|city| fs::read(city.join("buildings/0").join(&name)).unwrap());
        assert!(a == b, "{name:?} differs");
    }
    assert_eq!(heights(&first), heights(&second));

    // The very same tiles from the footprint dataset and the ground.
    let city = City::open(&first).unwrap();
    let (grid, side) = (city.manifest().grid, city.manifest().tile_texels);
    for (tile, buildings) in buildings_by_tile(&grid, &raised(&city)) {
        let lowest = city
            .terrain(tile)
            .unwrap()
            .and_then(|terrain| terrain.ground.range());
        let made = building_map(&grid, tile, side, &buildings).unwrap();
        let made = made.map(|map| map.over_ground(lowest.map_or(f32::INFINITY, |[lowest, _]| lowest)));
        assert!(made == city.buildings(tile).unwrap(), "{tile:?} differs");
    }

    let standing = |city: &Path| -> BTreeMap<u32, f32> {
        let buildings = raised(&City::open(city).unwrap());
        let height = |building: &Building| (building.roof_m - building.base_m) as f32;
        buildings
            .iter()
            .map(|building| (building.fid, height(building)))
            .collect()
    };
    let before: Vec<(u32, f32)> = heights(&first).into_iter().collect();
    same_heights(&standing(&first), &before);
    let options = DatasetOptions {
        open_flags: GdalOpenFlags::GDAL_OF_VECTOR | GdalOpenFlags::GDAL_OF_UPDATE,
        ..DatasetOptions::default()
    };
    let edited = Dataset::open_ex(first.join("buildings.gpkg"), options).unwrap();
    let query = "UPDATE buildings SET height = '20' WHERE fid = 4";
    edited.execute_sql(query, None, Dialect::DEFAULT).unwrap();
    edited.close().unwrap();
    assert!((standing(&first)[&4] - 20.0).abs() < 1e-3);
}

#[test]
fn without_a_known_field_the_first_dozen_is_listed() {
    let folder = tempfile::tempdir().unwrap();
    let many: serde_json::Map<String, Value> = (0..35)
        .map(|k| (format!("attribute_number_{k}"), json!(k)))
        .collect();
    let file = footprints(
        folder.path().join("many.geojson"),
        &[json!({}), Value::Object(many)],
    );
    let said = import(&file, &[], &folder.path().join("city"));
    let note: Vec<&str> = said.lines().skip_while(|line| !line.contains("note:")).collect();
    assert!(
        note[0].contains("every building is 6 m high") && note[0].contains("--height-field"),
        "{said}"
    );
    assert!(note[1..].iter().all(|line| line.len() <= 100), "{said}");
    assert!(
        note.len() >= 4 && note.join(" ").contains("and 23 more"),
        "{said}"
    );
}

#[test]
fn a_survey_offices_heights_are_those_of_its_fields() {
    let Some(data) = shared_data() else { return };
    let folder = tempfile::tempdir().unwrap();
    let onet = data.join("onet_le_chateau_fr");
    let terrain = onet.join("derived_dtm_25m_from_zmin_minus_hauteur.tif");
    let footprints = onet.join("bdtopo_v3/BATIMENT.shp");
    let source = Dataset::open(&footprints).unwrap();
    let count = |condition: &str| {
        let query = format!("SELECT COUNT(*) FROM BATIMENT WHERE {condition}");
        let mut rows = source
            .execute_sql(query, None, Dialect::DEFAULT)
            .unwrap()
            .unwrap();
        rows.features()
            .next()
            .unwrap()
            .field_as_integer64(0)
            .unwrap()
            .unwrap()
    };
    let out = folder.path().join("city").display().to_string();
    let [terrain, footprints] = [&terrain, &footprints].map(|path| path.display().to_string());
    succeed(&[
        "import",
        "--terrain",
        &terrain,
        "--buildings",
        &footprints,
        "--out",
        &out,
    ]);
    let info: Value = serde_json::from_str(&succeed(&["info", &out, "--json"])).unwrap();
    assert_eq!(
        info["footprints"]["read"], info["footprints"]["kept"],
        "all have ground"
    );
    let from = |field: &str| {
        let counts = info["footprints"]["heights"].as_array().unwrap();
        let named = counts
            .iter()
            .find(|count| count["field"].as_str().unwrap().contains(field));
        named.unwrap()["buildings"].as_i64().unwrap()
    };
    assert_eq!(from("HAUTEUR"), count("HAUTEUR > 0"));
    assert_eq!(
        from("NB_ETAGES"),
        count(
            "(HAUTEUR IS NULL OR HAUTEUR <= 0) AND NB_ETAGES > 0 AND (Z_MIN_TOIT IS NULL OR Z_MIN_TOIT <= Z_MIN_SOL)"
        )
    );
}
