//! Edits of single buildings: what is undone is as before, what is redone as after, and in the end the city is what a fresh import of
//! its dataset gives.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use std::collections::BTreeMap;

use geo::{Coord, LineString, MultiPolygon, Polygon};
use rilievo::city::{City, CityError, Edit, Editor};
use support::copied;
use support::records::{Record, is_a_fresh_import, records, tiles};

/// A small deterministic generator (Steele, Lea & Flood 2014, "splitmix64").
struct Random(u64);

impl Random {
    fn below(&mut self, count: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % count.max(1) as u64) as usize
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.below(1_000_000) as f64 * 1e-6
    }
}

fn moved(outline: &MultiPolygon<f64>, by: [f64; 2]) -> MultiPolygon<f64> {
    use geo::MapCoords;
    outline.map_coords(|Coord { x, y }| Coord {
        x: x + by[0],
        y: y + by[1],
    })
}

fn rectangle(x: f64, y: f64, width: f64, depth: f64) -> MultiPolygon<f64> {
    let corners = [[x, y], [x + width, y], [x + width, y + depth], [x, y + depth]];
    let ring = corners
        .into_iter()
        .map(|[x, y]| Coord { x, y })
        .collect::<Vec<_>>();
    MultiPolygon::new(vec![Polygon::new(LineString::new(ring), Vec::new())])
}

fn random_edit(random: &mut Random, city: &City, standing: &BTreeMap<u64, Record>) -> Edit {
    let fids: Vec<u64> = standing.keys().copied().collect();
    let fid = fids[random.below(fids.len())] as u32;
    let outline = || city.building(fid).unwrap().unwrap().building.outline;
    match random.below(5) {
        0 => {
            let bounds = city.manifest().grid.bounds();
            let x = random.between(bounds.west + 200.0, bounds.east - 300.0);
            let y = random.between(bounds.south + 200.0, bounds.north - 300.0);
            Edit::Add {
                outline: rectangle(x, y, random.between(4.0, 60.0), random.between(4.0, 60.0)),
                height_m: random.between(2.5, 80.0),
            }
        }
        1 => Edit::Delete { fid },
        2 => Edit::Height {
            fid,
            height_m: random.between(2.5, 60.0),
        },
        3 => Edit::Outline {
            fid,
            outline: moved(&outline(), [random.between(-9.0, 9.0), random.between(-9.0, 9.0)]),
        },
        _ => {
            let centre = outline().0[0].exterior().0[0];
            Edit::Outline {
                fid,
                outline: rectangle(
                    centre.x,
                    centre.y,
                    random.between(5.0, 30.0),
                    random.between(5.0, 30.0),
                ),
            }
        }
    }
}

/// Random edits with undo and redo among them: after each the dataset is the one of its place in history.
fn edits_end_where_they_should(count: usize) {
    let folder = tempfile::tempdir().unwrap();
    let path = copied(folder.path());
    let dataset = path.join("buildings.gpkg");
    let (first_tiles, mut history) = (tiles(&path), vec![records(&dataset)]);
    let mut editor = Editor::new(&path, folder.path().join("edits"));
    let mut random = Random(7);
    let (mut at, mut edited, mut refused) = (0_usize, 0_usize, 0_usize);
    while edited < count {
        match random.below(10) {
            0..=1 => {
                let report = editor.undo().unwrap();
                assert_eq!(report.is_some(), at > 0);
                at = at.saturating_sub(1);
            }
            2 => {
                let report = editor.redo().unwrap();
                assert_eq!(report.is_some(), at + 1 < history.len());
                at = (at + 1).min(history.len() - 1);
            }
            _ => {
                let edit = random_edit(&mut random, &City::open(&path).unwrap(), &history[at]);
                match editor.apply(&edit) {
                    Ok(report) => {
                        history.truncate(at + 1);
                        history.push(records(&dataset));
                        at += 1;
                        let is_there = history[at].contains_key(&u64::from(report.fid));
                        assert_eq!(report.is_standing, is_there);
                        assert_ne!(history[at], history[at - 1], "{edit:?} changed nothing");
                    }
                    // Moved to where there is no ground or no tile.
                    Err(CityError::OutsideCity { .. } | CityError::NotTaken { .. }) => refused += 1,
                    Err(error) => panic!("{edit:?}: {error}"),
                }
                edited += 1;
            }
        }
        assert!(records(&dataset) == history[at], "after {edited} edits, at {at}");
    }
    println!("{edited} edits, {refused} refused, {at} deep");
    is_a_fresh_import(&path, folder.path());
    while editor.undo().unwrap().is_some() {}
    assert!(
        records(&dataset) == history[0],
        "all undone: the dataset is the first"
    );
    assert!(tiles(&path) == first_tiles, "all undone: the tiles are the first");
}

#[test]
fn thirty_edits_end_where_they_should() {
    edits_end_where_they_should(30);
}

/// The long run: `cargo test --release --test edit -- --ignored`.
#[test]
#[ignore = "minutes"]
fn five_hundred_edits_end_where_they_should() {
    edits_end_where_they_should(500);
}

#[test]
fn what_is_no_outline_is_refused_and_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = copied(folder.path());
    let before = (records(&path.join("buildings.gpkg")), tiles(&path));
    let mut editor = Editor::new(&path, folder.path().join("edits"));
    let bow = [[0.0, 0.0], [10.0, 10.0], [10.0, 0.0], [0.0, 10.0]];
    let centre = City::open(&path).unwrap().manifest().grid.bounds().centre();
    let ring: Vec<Coord<f64>> = bow
        .into_iter()
        .map(|[x, y]| Coord {
            x: centre.x + x,
            y: centre.y + y,
        })
        .collect();
    let outline = MultiPolygon::new(vec![Polygon::new(LineString::new(ring), Vec::new())]);
    let add = Edit::Add {
        outline,
        height_m: 10.0,
    };
    assert!(matches!(editor.apply(&add), Err(CityError::WrongOutline { .. })));
    assert!(matches!(
        editor.apply(&Edit::Delete { fid: 999_999 }),
        Err(CityError::NoBuilding { .. })
    ));
    assert_eq!(editor.depth(), [0, 0]);
    assert!(before == (records(&path.join("buildings.gpkg")), tiles(&path)));
}

/// What another program writes into the dataset is taken over by what differs from the copy kept, and ends like a fresh import.
#[test]
fn edits_of_another_program_are_taken_over() {
    let folder = tempfile::tempdir().unwrap();
    let path = copied(folder.path());
    let dataset = path.join("buildings.gpkg");
    let mut editor = Editor::new(&path, folder.path().join("edits"));
    editor.keep_known().unwrap();
    let before = records(&dataset);
    let fids: Vec<u64> = before.keys().copied().collect();
    let edit = |sql: &str| {
        let options = gdal::DatasetOptions {
            open_flags: gdal::GdalOpenFlags::GDAL_OF_VECTOR | gdal::GdalOpenFlags::GDAL_OF_UPDATE,
            ..gdal::DatasetOptions::default()
        };
        let file = gdal::Dataset::open_ex(&dataset, options).unwrap();
        file.execute_sql(sql, None, gdal::vector::sql::Dialect::DEFAULT)
            .unwrap();
        file.close().unwrap();
    };
    // Later than the tiles, also where the clock is coarse.
    std::thread::sleep(std::time::Duration::from_millis(1100));
    edit(&format!(
        "UPDATE buildings SET height_m = 42.5 WHERE fid = {}",
        fids[100]
    ));
    edit(&format!("DELETE FROM buildings WHERE fid = {}", fids[200]));
    edit(&format!(
        "INSERT INTO buildings (fid, geom, height_m) SELECT 900000, geom, 77 FROM buildings WHERE fid = {}",
        fids[300]
    ));
    let report = editor.take_over().unwrap();
    assert_eq!(report.manifest.generation, 1);
    assert_eq!(report.footprints.read, 2, "only what differs is read");
    assert_eq!(report.manifest.buildings, before.len() as u64);
    is_a_fresh_import(&path, folder.path());
}
