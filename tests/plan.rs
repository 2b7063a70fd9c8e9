//! Roads, water and green drawn on the ground, where the survey has them and as wide as it says.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use glam::DVec2;
use rilievo::city::City;
use rilievo::source::GroundRules;
use rilievo::space::TileId;
use support::{rilievo, sample, succeed};

/// The imagery's pixel at a place: red, green, blue, alpha; none where nothing is drawn on the tile.
fn pixel(city: &City, at: DVec2) -> Option<[u8; 4]> {
    let grid = &city.manifest().grid;
    let local = (at - DVec2::new(grid.west, grid.south)) / grid.tile_m;
    let tile = TileId {
        level: 0,
        x: local.x as u32,
        y: local.y as u32,
    };
    let imagery = city.imagery(tile).unwrap()?;
    let inside = local.fract() * imagery.side as f64;
    let row = imagery.side - 1 - inside.y as usize;
    let place = 4 * (row * imagery.side + inside.x as usize);
    Some(imagery.rgba[place..place + 4].try_into().unwrap())
}

#[test]
fn lines_are_as_wide_as_told_and_areas_are_filled() {
    let folder = tempfile::tempdir().unwrap();
    let files = sample().join("files");
    let [roads, green, out] = ["roads.geojson", "green.geojson", "city"].map(|name| folder.path().join(name));
    let (x, y) = (289_000.0, 4_772_900.0);
    let collection = |features: &str| {
        format!(
            r#"{{"type":"FeatureCollection","crs":{{"type":"name","properties":{{"name":"EPSG:25832"}}}},"features":[{features}]}}"#
        )
    };
    let crs = City::open(&sample().join("city")).unwrap().manifest().crs.clone();
    let line = format!(
        r#"{{"type":"Feature","properties":{{"width":"12"}},"geometry":{{"type":"LineString","coordinates":[[{x},{y}],[{},{y}]]}}}}"#,
        x + 100.0
    );
    let area = format!(
        r#"{{"type":"Feature","properties":{{}},"geometry":{{"type":"Polygon","coordinates":[[[{x},{a}],[{b},{a}],[{b},{c}],[{x},{c}],[{x},{a}]]]}}}}"#,
        a = y + 40.0,
        b = x + 80.0,
        c = y + 90.0
    );
    std::fs::write(&roads, collection(&line).replace("EPSG:25832", &crs)).unwrap();
    std::fs::write(&green, collection(&area).replace("EPSG:25832", &crs)).unwrap();
    let import = |roads: &std::path::Path| -> Vec<std::ffi::OsString> {
        let [terrain, buildings] = ["terrain.tif", "buildings.gpkg"].map(|name| files.join(name));
        let mut arguments: Vec<std::ffi::OsString> =
            vec!["import".into(), "--terrain".into(), terrain.into()];
        arguments.extend([
            "--buildings".into(),
            buildings.into(),
            "--height-field".into(),
            "height_m".into(),
        ]);
        arguments.extend([
            "--roads".into(),
            roads.into(),
            "--green".into(),
            green.clone().into(),
        ]);
        arguments.extend(["--margin".into(), "0".into(), "--out".into(), out.clone().into()]);
        arguments
    };
    succeed(&import(&roads));
    let city = City::open(&out).unwrap();
    let at = |dx: f64, dy: f64| pixel(&city, DVec2::new(x + dx, y + dy));
    let alpha = |dx: f64, dy: f64| at(dx, dy).map_or(0, |pixel| pixel[3]);
    // The road is twelve metres wide, and less opaque than an orthophoto.
    for dx in [10.0, 50.0, 90.0] {
        let width = (-200..200)
            .filter(|k| alpha(dx, f64::from(*k) * 0.1) > 112)
            .count() as f64
            * 0.1;
        assert!((width - 12.0).abs() <= 0.6, "{dx}: {width} m");
        assert!((200..250).contains(&alpha(dx, 1.5)), "{}", alpha(dx, 1.5));
    }
    let park = at(40.0, 65.0).unwrap();
    assert!(park[1] > park[2] && park[3] > 200, "{park:?}");
    assert_eq!(
        at(40.0, 25.0).map_or(0, |pixel| pixel[3]),
        0,
        "between them nothing is drawn"
    );

    // Rules of one's own.
    let rules = folder.path().join("ground.toml");
    let own = GroundRules::BUILT_IN
        .replacen("colour = \"#869466\"", "colour = \"#3060c0\"", 1)
        .replacen("carriageway = \"#707072\"", "carriageway = \"#c03030\"", 1);
    std::fs::write(&rules, own).unwrap();
    let with_rules = |rules: &std::path::Path| {
        let mut arguments = import(&roads);
        arguments.extend(["--ground-rules".into(), rules.into()]);
        arguments
    };
    succeed(&with_rules(&rules));
    let city = City::open(&out).unwrap();
    let at = |dx: f64, dy: f64| pixel(&city, DVec2::new(x + dx, y + dy)).unwrap();
    assert_eq!(at(40.0, 65.0)[..3], [0x30, 0x60, 0xc0]);
    assert_eq!(at(50.0, 1.5)[..3], [0xc0, 0x30, 0x30]);
    std::fs::write(&rules, "[roads]\nusual_m = 3\n").unwrap();
    let refused = rilievo(&with_rules(&rules));
    let message = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(
        !refused.status.success() && message.contains("ground.toml"),
        "{message}"
    );

    // A file without lines is refused by name.
    let empty = folder.path().join("none.geojson");
    std::fs::write(&empty, collection("").replace("EPSG:25832", &crs)).unwrap();
    let refused = rilievo(&import(&empty));
    let message = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(
        !refused.status.success() && message.contains("none.geojson"),
        "{message}"
    );
}
