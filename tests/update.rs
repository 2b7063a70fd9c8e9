//! Updates of a finished city: what comes out is what an import of the changed dataset gives, nothing else is touched, and a
//! killed update leaves the old city or the new one.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use gdal::vector::{
    Feature, FieldDefn, FieldValue, Geometry, LayerAccess, LayerOptions, OGRFieldType, OGRwkbGeometryType,
};
use gdal::{Dataset, DatasetOptions, DriverManager, GdalOpenFlags};
use rilievo::city::City;
use rilievo::gpu::Gpu;
use rilievo::output::Renderer;
use rilievo::scene::TerrainMesh;
use rilievo::space::Sun;
use support::records::{Record, is_a_fresh_import, records, tiles};
use support::{copied, import_arguments, rilievo, sample, succeed, walk};

/// A change: rings (moved, reshaped) and a height.
struct Change {
    fid: u64,
    rings: Vec<Vec<[f64; 2]>>,
    height_m: f64,
}

fn rings(wkb: &[u8]) -> Vec<Vec<[f64; 2]>> {
    let multi = Geometry::from_wkb(wkb).unwrap();
    let polygon = multi.get_geometry(0);
    (0..polygon.geometry_count())
        .map(|k| {
            let mut points = Vec::new();
            polygon.get_geometry(k).get_points(&mut points);
            points.iter().map(|&(x, y, _)| [x, y]).collect()
        })
        .collect()
}

fn polygon(rings: &[Vec<[f64; 2]>]) -> Geometry {
    let ring_text = |ring: &Vec<[f64; 2]>| {
        let points: Vec<String> = ring.iter().map(|[x, y]| format!("{x:?} {y:?}")).collect();
        format!("({})", points.join(","))
    };
    let rings: Vec<String> = rings.iter().map(ring_text).collect();
    Geometry::from_wkt(&format!("POLYGON({})", rings.join(","))).unwrap()
}

fn write_changes(path: &Path, changes: &[Change]) {
    let _ = fs::remove_file(path);
    let driver = DriverManager::get_driver_by_name("GPKG").unwrap();
    let mut dataset = driver.create_vector_only(path).unwrap();
    let crs = gdal::spatial_ref::SpatialRef::from_epsg(32633).unwrap();
    let layer = dataset
        .create_layer(LayerOptions {
            name: "changes",
            srs: Some(&crs),
            ty: OGRwkbGeometryType::wkbPolygon,
            options: None,
        })
        .unwrap();
    let height = FieldDefn::new("height_m", OGRFieldType::OFTReal).unwrap();
    height.add_to_layer(&layer).unwrap();
    for change in changes {
        let mut feature = Feature::new(layer.defn()).unwrap();
        feature.set_geometry(polygon(&change.rings)).unwrap();
        feature.set_field_double(0, change.height_m).unwrap();
        // SAFETY: the feature is alive.
        unsafe { gdal_sys::OGR_F_SetFID(feature.c_feature(), change.fid as i64) };
        feature.create(&layer).unwrap();
    }
}

/// A small generator of numbers below `n`.
struct Chance(u64);

impl Chance {
    fn below(&mut self, n: u64) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % n
    }

    fn metres(&mut self, most: f64) -> f64 {
        (self.below(2001) as f64 / 1000.0 - 1.0) * most
    }
}

fn moved(rings: &[Vec<[f64; 2]>], by: [f64; 2]) -> Vec<Vec<[f64; 2]>> {
    let point = |&[x, y]: &[f64; 2]| [x + by[0], y + by[1]];
    rings
        .iter()
        .map(|ring| ring.iter().map(point).collect())
        .collect()
}

/// Scaled about its first point.
fn scaled(rings: &[Vec<[f64; 2]>], by: f64) -> Vec<Vec<[f64; 2]>> {
    let [x0, y0] = rings[0][0];
    let point = |&[x, y]: &[f64; 2]| [x0 + (x - x0) * by, y0 + (y - y0) * by];
    rings
        .iter()
        .map(|ring| ring.iter().map(point).collect())
        .collect()
}

fn update(arguments: &[&dyn AsRef<std::ffi::OsStr>]) -> serde_json::Value {
    let mut all: Vec<std::ffi::OsString> = vec!["update".into(), "--json".into()];
    all.extend(arguments.iter().map(|argument| argument.as_ref().to_owned()));
    serde_json::from_str(&succeed(&all)).unwrap()
}

/// Moved, reshaped, added, deleted and of another height, many times.
#[test]
fn many_edits_end_like_a_fresh_import() {
    edits_end_like_a_fresh_import(8);
}

/// A thousand edits, and two hundred kills.
#[test]
#[ignore = "takes minutes"]
fn a_thousand_edits_and_two_hundred_kills() {
    edits_end_like_a_fresh_import(45);
    kills_leave_a_whole_city(200);
}

fn edits_end_like_a_fresh_import(rounds: u64) {
    let folder = tempfile::tempdir().unwrap();
    let city = copied(folder.path());
    let changes_path = folder.path().join("changes.gpkg");
    let mut chance = Chance(7);
    for round in 0..rounds {
        let known = records(&city.join("buildings.gpkg"));
        let fids: Vec<u64> = known.keys().copied().collect();
        let mut changes: BTreeMap<u64, Change> = BTreeMap::new();
        let mut deleted: Vec<u64> = Vec::new();
        for k in 0..24 {
            let fid = fids[chance.below(fids.len() as u64) as usize];
            if changes.contains_key(&fid) || deleted.contains(&fid) {
                continue;
            }
            let old = rings(&known[&fid].wkb);
            let height_m: f64 = known[&fid].fields["height_m"]
                .as_deref()
                .unwrap()
                .parse()
                .unwrap();
            let change = |fid, rings, height_m| Change { fid, rings, height_m };
            match k % 5 {
                0 => deleted.push(fid),
                1 => {
                    let by = [chance.metres(9.0), chance.metres(9.0)];
                    changes.insert(fid, change(fid, moved(&old, by), height_m));
                }
                2 => {
                    changes.insert(fid, change(fid, scaled(&old, 0.8), height_m));
                }
                3 => {
                    changes.insert(fid, change(fid, old, height_m + 4.5));
                }
                _ => {
                    let new = fids[fids.len() - 1] + 1 + k;
                    let by = [chance.metres(30.0), chance.metres(30.0)];
                    changes.insert(new, change(new, moved(&old, by), 5.0));
                }
            }
        }
        let changes: Vec<Change> = changes.into_values().collect();
        write_changes(&changes_path, &changes);
        let list: Vec<String> = deleted.iter().map(u64::to_string).collect();
        let report = update(&[&city, &"--buildings", &changes_path, &"--delete", &list.join(",")]);
        assert_eq!(report["generation"], round + 1, "{report}");
        assert_eq!(report["deleted"], deleted.len(), "{report}");
    }
    is_a_fresh_import(&city, folder.path());
    // Attributes that the changes do not name stay.
    let (before, after) = (
        records(&sample().join("city/buildings.gpkg")),
        records(&city.join("buildings.gpkg")),
    );
    let kept = before
        .iter()
        .filter_map(|(fid, record)| Some((record, after.get(fid)?)));
    let others = |record: &Record| {
        let mut fields = record.fields.clone();
        fields.remove("height_m");
        fields
    };
    assert!(
        kept.clone().any(|(before, after)| before != after),
        "nothing was changed"
    );
    for (before, after) in kept {
        assert_eq!(others(before), others(after));
    }
}

/// One building: only the tiles under its old and new outline are other files afterwards.
#[test]
fn only_the_tiles_under_a_changed_building_are_written() {
    let folder = tempfile::tempdir().unwrap();
    let city = copied(folder.path());
    let known = records(&city.join("buildings.gpkg"));
    let (&fid, record) = known.iter().nth(1200).unwrap();
    let new = moved(&rings(&record.wkb), [40.0, -25.0]);
    let path = folder.path().join("changes.gpkg");
    write_changes(
        &path,
        &[Change {
            fid,
            rings: new.clone(),
            height_m: 30.0,
        }],
    );
    let before = tiles(&city);
    let time = |path: &Path| fs::metadata(path).unwrap().modified().unwrap();
    let times: BTreeMap<_, _> = walk(&city)
        .into_iter()
        .map(|path| (path.clone(), time(&path)))
        .collect();
    let report = update(&[&city, &"--buildings", &path]);
    let opened = City::open(&city).unwrap();
    let grid = opened.manifest().grid;
    // The tile under a point, and those over it.
    let tiles_of = |[x, y]: [f64; 2]| {
        let id = grid.tile_at(glam::DVec2::new(x, y)).unwrap();
        let path = move |level: u32| format!("buildings/{level}/{}_{}.tif", id.x >> level, id.y >> level);
        (0..grid.levels()).map(move |level| PathBuf::from(path(level)))
    };
    let old = rings(&record.wkb);
    let under: Vec<PathBuf> = old[0]
        .iter()
        .chain(&new[0])
        .flat_map(|&point| tiles_of(point))
        .collect();
    let after = tiles(&city);
    let mut changed = 0;
    for (path, bytes) in &after {
        if *bytes != before[path] {
            assert!(under.contains(path), "{} changed", path.display());
            changed += u32::from(path.starts_with("buildings/0"));
        }
    }
    assert!((1..=4).contains(&changed), "{changed} tiles");
    assert_eq!(report["tiles_written"], changed);
    for (path, before) in times {
        let relative = path.strip_prefix(&city).unwrap();
        let may = under.iter().any(|tile| tile == relative);
        let is_record = ["buildings.gpkg", "city.toml"]
            .iter()
            .any(|name| relative == Path::new(name));
        assert!(
            may || is_record || time(&path) == before,
            "{} was written",
            path.display()
        );
    }
    // The same again changes no tile.
    let again = update(&[&city, &"--buildings", &path]);
    assert_eq!(again["tiles_written"], 0, "{again}");
}

/// A renderer that follows an update shows what a renderer of the updated city shows, without reading ground or imagery again.
#[test]
fn an_open_city_follows_an_update() {
    let folder = tempfile::tempdir().unwrap();
    let folder_of_city = copied(folder.path());
    let city = City::open(&folder_of_city).unwrap();
    let mut renderer = Renderer::open(Gpu::open().unwrap(), &city, TerrainMesh::Tin).unwrap();
    let (_, eye, target) = support::VIEWS[1];
    let camera = support::pinhole(eye, target, 1.0);
    let sun = Sun::from_azimuth_altitude(200.0, 40.0);
    let request = support::request(&camera, &sun, [96, 54]);
    let before = renderer.still(&request, 1).unwrap();
    // All that are seen go, but for one, which grows.
    let mut seen: Vec<u32> = before.ids.iter().copied().filter(|&id| id > 0).collect();
    seen.sort_unstable();
    seen.dedup();
    assert!(seen.len() > 20, "{} buildings in view", seen.len());
    let fid = u64::from(seen.pop().unwrap());
    let record = records(&folder_of_city.join("buildings.gpkg"))[&fid].clone();
    let path = folder.path().join("changes.gpkg");
    let rings = rings(&record.wkb);
    let height_m = 55.0;
    write_changes(&path, &[Change { fid, rings, height_m }]);
    let list: Vec<String> = seen.iter().map(u32::to_string).collect();
    update(&[
        &folder_of_city,
        &"--buildings",
        &path,
        &"--delete",
        &list.join(","),
    ]);

    let newer = city.updated().unwrap().expect("another generation");
    assert!(newer.updated().unwrap().is_none());
    assert!(renderer.follow(&newer).unwrap() > 0);
    let followed = renderer.still(&request, 1).unwrap();
    let mut fresh = Renderer::open(Gpu::open().unwrap(), &newer, TerrainMesh::Tin).unwrap();
    let opened = fresh.still(&request, 1).unwrap();
    assert_eq!(followed.ids, opened.ids);
    assert!(followed.rgba == opened.rgba, "the images differ");
    assert!(
        followed.ids.iter().all(|id| !seen.contains(id)),
        "what was deleted is gone"
    );
    assert_ne!(followed.ids, before.ids);
}

/// A dataset edited behind the program's back, as in QGIS: also with an outline that crosses itself and one drawn clockwise.
#[test]
fn an_edited_dataset_is_compared() {
    let folder = tempfile::tempdir().unwrap();
    let city = copied(folder.path());
    let path = city.join("buildings.gpkg");
    std::thread::sleep(Duration::from_millis(20));
    {
        let options = DatasetOptions {
            open_flags: GdalOpenFlags::GDAL_OF_UPDATE | GdalOpenFlags::GDAL_OF_VECTOR,
            ..DatasetOptions::default()
        };
        let dataset = Dataset::open_ex(&path, options).unwrap();
        let layer = dataset.layer(0).unwrap();
        let height = layer.defn().field_index("height_m").unwrap();
        let mut first = layer.feature(10).unwrap();
        first.set_field(height, &FieldValue::RealValue(41.0)).unwrap();
        layer.set_feature(first).unwrap();
        let mut second = layer.feature(11).unwrap();
        let mut clockwise = moved(&rings(&second.geometry().unwrap().wkb().unwrap()), [3.0, 3.0]);
        clockwise[0].reverse();
        let multi = |polygon: &Geometry| Geometry::from_wkt(&polygon.wkt().unwrap()).unwrap();
        second.set_geometry(multi(&polygon(&clockwise))).unwrap();
        layer.set_feature(second).unwrap();
        // SAFETY: the layer is open for writing.
        unsafe { gdal_sys::OGR_L_DeleteFeature(layer.c_layer(), 12) };
    }
    // Named changes have to wait until the edits are known.
    let refused = rilievo(&[
        "update".as_ref(),
        city.as_os_str(),
        "--delete".as_ref(),
        "13".as_ref(),
    ]);
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert_eq!(refused.status.code(), Some(1), "{said}");
    assert!(
        said.contains("buildings.gpkg") && said.contains("edited"),
        "{said}"
    );

    let report = update(&[&city]);
    assert!(report["tiles_written"].as_u64().unwrap() >= 1, "{report}");
    is_a_fresh_import(&city, folder.path());
    let again = update(&[&city]);
    assert_eq!(again["tiles_written"], 0, "{again}");
    assert_eq!(again["generation"], report["generation"], "nothing changed");
}

/// Killed at any moment the city opens, whole; the next update finishes what held and the edits end where they would have.
#[test]
fn a_killed_update_leaves_the_old_city_or_the_new_one() {
    kills_leave_a_whole_city(24);
}

fn kills_leave_a_whole_city(kills: u32) {
    let folder = tempfile::tempdir().unwrap();
    let city = copied(folder.path());
    let known = records(&city.join("buildings.gpkg"));
    let fids: Vec<u64> = known.keys().copied().collect();
    let changes = |shift: f64| -> Vec<Change> {
        let some = fids.iter().step_by(40);
        some.map(|&fid| Change {
            fid,
            rings: moved(&rings(&known[&fid].wkb), [shift, 0.5]),
            height_m: 9.0 + shift,
        })
        .collect()
    };
    let path = folder.path().join("changes.gpkg");
    write_changes(&path, &changes(1.0));
    let start = |path: &Path| {
        Command::new(support::PROGRAM)
            .args([Path::new("update"), &city, Path::new("--buildings"), path])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap()
    };
    let begun = Instant::now();
    assert!(start(&path).wait().unwrap().success());
    let whole = begun.elapsed();
    let (mut old, mut new) = (0, 0);
    for k in 0..kills {
        let generation = City::open(&city).unwrap().manifest().generation;
        write_changes(&path, &changes(f64::from(k % 7) - 3.0));
        let mut child = start(&path);
        // The last ones late, however busy the machine has become.
        let fraction = match k + 3 < kills {
            true => 1.1 * f64::from(k) / f64::from(kills),
            false => 6.0,
        };
        std::thread::sleep(whole.mul_f64(fraction));
        child.kill().unwrap();
        child.wait().unwrap();
        let opened = City::open(&city).unwrap();
        opened.require_all_tiles().unwrap();
        for id in opened.manifest().grid.tiles() {
            opened.tile(id).unwrap();
        }
        match opened.manifest().generation {
            now if now == generation => old += 1,
            now if now == generation + 1 => new += 1,
            now => panic!("generation {now} after {generation}"),
        }
    }
    println!("{old} old, {new} new");
    assert!(
        old > 0 && new > 0,
        "{old} old, {new} new: the kills missed the update"
    );
    write_changes(&path, &changes(0.25));
    update(&[&city, &"--buildings", &path]);
    let left: Vec<PathBuf> = fs::read_dir(&city)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    assert_eq!(left.len(), 6, "{left:?}");
    is_a_fresh_import(&city, folder.path());
}

/// Two at once wait for each other: both are there.
#[test]
fn two_updates_at_once_are_both_done() {
    let folder = tempfile::tempdir().unwrap();
    let city = copied(folder.path());
    let known = records(&city.join("buildings.gpkg"));
    let children: Vec<_> = [100, 101]
        .iter()
        .map(|&fid: &u64| {
            let path = folder.path().join(format!("{fid}.gpkg"));
            let rings = moved(&rings(&known[&fid].wkb), [2.0, 2.0]);
            let height_m = 12.0;
            write_changes(&path, &[Change { fid, rings, height_m }]);
            Command::new(support::PROGRAM)
                .args([Path::new("update"), &city, Path::new("--buildings"), &path])
                .stdout(Stdio::null())
                .spawn()
                .unwrap()
        })
        .collect();
    for mut child in children {
        assert!(child.wait().unwrap().success());
    }
    assert_eq!(City::open(&city).unwrap().manifest().generation, 2);
    let now = records(&city.join("buildings.gpkg"));
    for fid in [100, 101] {
        assert_ne!(now[&fid].wkb, known[&fid].wkb);
    }
}

/// More changes than SQLite keeps in memory before it writes them to the file: they are not taken for somebody else's edit.
#[test]
fn many_changes_at_once_hold() {
    const ADDED: u64 = 20_000;
    let folder = tempfile::tempdir().unwrap();
    let city = copied(folder.path());
    let bounds = City::open(&city).unwrap().manifest().grid.bounds();
    // In the middle, where all of them have ground.
    let side = 150;
    let step = [bounds.width(), bounds.height()].map(|extent| 0.5 * extent / side as f64);
    let changes: Vec<Change> = (0..ADDED)
        .map(|k| {
            let at = [k % side, k / side];
            let [x, y] = [0, 1].map(|axis: usize| {
                [bounds.west, bounds.south][axis] + (0.5 * side as f64 + at[axis] as f64) * step[axis]
            });
            Change {
                fid: 100_000 + k,
                rings: vec![vec![
                    [x, y],
                    [x + 2.0, y],
                    [x + 2.0, y + 2.0],
                    [x, y + 2.0],
                    [x, y],
                ]],
                height_m: 3.0,
            }
        })
        .collect();
    let path = folder.path().join("many.gpkg");
    write_changes(&path, &changes);
    let report = update(&[&city, &"--buildings", &path]);
    assert_eq!(report["added"], ADDED, "{report}");
    let now = records(&city.join("buildings.gpkg"));
    let added = now.range(100_000..).count() as u64;
    assert_eq!(added, ADDED);
    let manifest = City::open(&city).unwrap().manifest().clone();
    assert_eq!(manifest.buildings, now.len() as u64);
}

/// Attributes that the changes do not say stay, the height among them; a column of ids stands for the ids that GeoJSON does not
/// keep.
#[test]
fn what_the_changes_do_not_say_stays() {
    let folder = tempfile::tempdir().unwrap();
    let city = copied(folder.path());
    let dataset = city.join("buildings.gpkg");
    let before = records(&dataset);
    let moved = moved(&rings(&before[&77].wkb), [6.0, -4.0]);
    let feature = serde_json::json!({"type": "Feature", "properties": {"fid": 77, "kind": null},
        "geometry": {"type": "Polygon", "coordinates": moved}});
    let crs = serde_json::json!({"type": "name", "properties": {"name": "EPSG:32633"}});
    let text = serde_json::json!({"type": "FeatureCollection", "crs": crs, "features": [feature]});
    let path = folder.path().join("moved.geojson");
    fs::write(&path, text.to_string()).unwrap();
    let report = update(&[&city, &"--buildings", &path]);
    assert_eq!(report["changed"], 1, "{report}");
    let after = records(&dataset);
    assert_eq!(after[&77].fields, before[&77].fields);
    assert_ne!(after[&77].wkb, before[&77].wkb);
    is_a_fresh_import(&city, folder.path());
    // An import would lose the change.
    let refused = rilievo(&import_arguments(&sample().join("files"), &city));
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert_eq!(refused.status.code(), Some(1), "{said}");
    assert!(said.contains("updated"), "{said}");
}

/// A damaged tile and a lost one are made again; a dataset that was only touched is no edit for ever.
#[test]
fn damaged_tiles_are_made_again() {
    let folder = tempfile::tempdir().unwrap();
    let city = copied(folder.path());
    let files = walk(&city.join("buildings"));
    let bytes = fs::read(&files[4]).unwrap();
    fs::write(&files[4], &bytes[..bytes.len() / 2]).unwrap();
    fs::remove_file(&files[7]).unwrap();
    let report = update(&[&city]);
    assert_eq!(report["tiles_written"], 2, "{report}");
    assert!(tiles(&city) == tiles(&sample().join("city")));
    City::open(&city).unwrap().require_all_tiles().unwrap();
    std::thread::sleep(Duration::from_millis(20));
    let dataset = fs::File::options()
        .append(true)
        .open(city.join("buildings.gpkg"))
        .unwrap();
    dataset.set_modified(std::time::SystemTime::now()).unwrap();
    drop(dataset);
    update(&[&city]);
    let report = update(&[&city, &"--delete", &"5"]);
    assert_eq!(report["deleted"], 1, "{report}");
}

/// Links in the folder of a pending update lead nowhere.
#[cfg(unix)]
#[test]
fn links_are_not_followed() {
    let folder = tempfile::tempdir().unwrap();
    let city = copied(folder.path());
    let outside = folder.path().join("outside");
    fs::create_dir(&outside).unwrap();
    fs::write(outside.join("1_1.tif"), "precious").unwrap();
    let pending = city.join("update.commit");
    fs::create_dir_all(pending.join("buildings")).unwrap();
    std::os::unix::fs::symlink(&outside, pending.join("buildings/0")).unwrap();
    fs::write(pending.join("plan.toml"), "tiles = []\nbuildings = []\n").unwrap();
    fs::copy(city.join("city.toml"), pending.join("city.toml")).unwrap();
    let refused = rilievo(&["update".as_ref(), city.as_os_str()]);
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert_eq!(refused.status.code(), Some(1), "{said}");
    assert!(said.contains("is a link"), "{said}");
    assert_eq!(fs::read_to_string(outside.join("1_1.tif")).unwrap(), "precious");
}

/// What does not fit is refused by name, and the city stays as it is.
#[test]
fn changes_that_do_not_fit_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let city = copied(folder.path());
    let before = tiles(&city);
    let refuse = |arguments: &[&dyn AsRef<std::ffi::OsStr>], words: &[&str]| {
        let mut all: Vec<std::ffi::OsString> = vec!["update".into(), city.clone().into()];
        all.extend(arguments.iter().map(|argument| argument.as_ref().to_owned()));
        let output = rilievo(&all);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{said}");
        for word in words {
            assert!(said.contains(word), "{word}: {said}");
        }
    };
    refuse(&[&"--delete", &"99999999"], &["buildings.gpkg", "99999999"]);
    refuse(&[&"--buildings", &"nowhere.gpkg"], &["nowhere.gpkg"]);
    let geojson = folder.path().join("no_ids.geojson");
    support::survey::footprints(&geojson, &[[400_000.0, 5_000_000.0]]);
    refuse(
        &[&"--buildings", &geojson, &"--buildings-crs", &"EPSG:32633"],
        &["no_ids.geojson", "fid"],
    );
    let far = folder.path().join("far.gpkg");
    let known = records(&city.join("buildings.gpkg"));
    let grid = City::open(&city).unwrap().manifest().grid;
    let east = grid.bounds().east;
    let ring = rings(&known[&5].wkb);
    let to_border = east - 2.0 - ring[0].iter().map(|[x, _]| *x).fold(f64::INFINITY, f64::min);
    let change = |fid: u64, by: f64| Change {
        fid,
        rings: moved(&ring, [by, 0.0]),
        height_m: 7.0,
    };
    write_changes(&far, &[change(5, to_border)]);
    let output = rilievo(&[
        "update".as_ref(),
        city.as_os_str(),
        "--buildings".as_ref(),
        far.as_os_str(),
    ]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let told = String::from_utf8_lossy(&output.stdout).into_owned();
    // Beyond the terrain it has no ground, on its last metres it reaches out: refused or counted, never lost.
    assert!(
        said.contains("building 5 reaches beyond") || told.contains("no ground"),
        "{said}{told}"
    );
    write_changes(&far, &[change(5, 1.0)]);
    refuse(
        &[&"--buildings", &far, &"--delete", &"5"],
        &["building 5", "deleted"],
    );
    // Far away there is no ground: counted, and the building stays where it is, in the dataset too.
    write_changes(&far, &[change(5, 90_000.0)]);
    let report = update(&[&city, &"--buildings", &far]);
    assert_eq!(
        report["footprints"]["left_out"]["no ground under it"], 1,
        "{report}"
    );
    assert_eq!(report["tiles_written"], 0, "{report}");
    assert!(!city.join("update.partial").exists() && !city.join("update.commit").exists());
    assert!(tiles(&city) == before, "a refused update changed tiles");
    assert_eq!(known, records(&city.join("buildings.gpkg")));
}
