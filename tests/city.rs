//! The city folder: repeatable to the byte, resumable, replaced whole or not at all, and safe to open when damaged.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use rilievo::buildings::{CellKind, DeviceMap, Pyramid};
use rilievo::city::City;
use support::{import_arguments, rilievo, sample, succeed};

/// Every file under a folder with its bytes.
fn contents(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(&next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                found.insert(
                    path.strip_prefix(folder).unwrap().to_owned(),
                    fs::read(&path).unwrap(),
                );
            }
        }
    }
    found
}

fn same(a: &Path, b: &Path) {
    let (mut a, mut b) = (contents(a), contents(b));
    // The manifest names the folder.
    for city in [&mut a, &mut b] {
        let manifest = city.remove(Path::new("city.toml")).expect("a manifest");
        assert!(manifest.len() > 500);
    }
    assert_eq!(a.keys().collect::<Vec<_>>(), b.keys().collect::<Vec<_>>());
    for (path, bytes) in &a {
        assert!(*bytes == b[path], "{} differs", path.display());
    }
}

#[test]
fn a_second_import_and_a_resumed_one_give_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let files = sample().join("files");
    let again = folder.path().join("again");
    succeed(&import_arguments(&files, &again));
    same(&sample().join("city"), &again);

    // Importing over a city replaces it.
    succeed(&import_arguments(&files, &again));
    same(&sample().join("city"), &again);
}

/// Killed by the system the moment a file grows beyond a size: in the terrain, in the footprint dataset, in the
/// orthophotos, always at the same file, however fast the machine is.
#[cfg(unix)]
#[test]
fn a_killed_import_is_resumed() {
    use std::os::unix::process::ExitStatusExt;

    let folder = tempfile::tempdir().unwrap();
    let city = sample().join("city");
    let sizes = |layer: &str| -> Vec<u64> {
        let entries = fs::read_dir(city.join(layer)).unwrap();
        let mut sizes: Vec<u64> = entries
            .map(|entry| entry.unwrap().metadata().unwrap().len())
            .collect();
        sizes.sort_unstable();
        sizes
    };
    let (terrain, imagery) = (sizes("terrain/0"), sizes("photo/0"));
    let dataset = fs::metadata(city.join("buildings.gpkg")).unwrap().len();
    let [terrain_max, imagery_max] = [&terrain, &imagery].map(|sizes| *sizes.last().unwrap());
    // The last one stops at the largest orthophoto alone, when other tiles are finished.
    let limits = [
        terrain[terrain.len() / 2],
        (terrain_max + dataset) / 2,
        (imagery[imagery.len() - 2].max(dataset) + imagery_max) / 2,
    ];
    assert!(
        limits.is_sorted(),
        "the sample's files do not tell the stages apart: {limits:?}"
    );
    let resumed = folder.path().join("resumed");
    let arguments = import_arguments(&sample().join("files"), &resumed);
    let staging = folder.path().join("resumed.partial");
    let finished = |layer: &str| {
        let entries = fs::read_dir(staging.join(layer)).unwrap();
        let names = entries.map(|entry| entry.unwrap().path());
        names
            .filter(|path| path.extension().is_some_and(|extension| extension == "tif"))
            .count()
    };
    for (stage, limit) in limits.iter().enumerate() {
        // POSIX: the unit of `ulimit -f` is 512 bytes.
        let killed = std::process::Command::new("sh")
            .args(["-c", "ulimit -c 0; ulimit -f $0; exec \"$@\""])
            .arg((limit / 512).to_string())
            .arg(support::PROGRAM)
            .args(&arguments)
            .output()
            .unwrap();
        assert!(killed.status.signal().is_some(), "{limit}: {killed:?}");
        assert!(!resumed.exists(), "{limit}: the city was put in place");
        assert_eq!(
            finished("terrain/0") == terrain.len(),
            stage > 0,
            "{limit}: all terrain"
        );
        assert_eq!(finished("buildings/0") > 0, stage > 1, "{limit}: buildings");
        assert!(finished("photo/0") < imagery.len(), "{limit}: all orthophotos");
    }
    succeed(&arguments);
    same(&city, &resumed);
    assert!(!staging.exists());
}

#[test]
fn a_failed_import_leaves_the_old_city() {
    let folder = tempfile::tempdir().unwrap();
    let city = folder.path().join("city");
    let mut arguments = import_arguments(&sample().join("files"), &city);
    succeed(&arguments);
    let before = contents(&city);
    let broken = folder.path().join("broken.tif");
    let terrain = fs::read(sample().join("files/terrain.tif")).unwrap();
    fs::write(&broken, &terrain[..terrain.len() / 2]).unwrap();
    arguments[2] = broken.display().to_string();
    let output = rilievo(&arguments);
    assert_eq!(output.status.code(), Some(1));
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(message.contains("broken.tif"), "{message}");
    assert_eq!(contents(&city), before);
}

#[test]
fn an_edited_footprint_dataset_is_not_lost() {
    let folder = tempfile::tempdir().unwrap();
    let city = folder.path().join("city");
    let arguments = import_arguments(&sample().join("files"), &city);
    succeed(&arguments);
    let map = fs::File::options()
        .write(true)
        .open(city.join("buildings.gpkg"))
        .unwrap();
    let later = std::time::SystemTime::now() + std::time::Duration::from_secs(10);
    map.set_modified(later).unwrap();
    let output = rilievo(&arguments);
    assert_eq!(output.status.code(), Some(1));
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(message.contains("buildings.gpkg: is newer"), "{message}");
    assert_eq!(
        city.join("buildings.gpkg")
            .metadata()
            .unwrap()
            .modified()
            .unwrap(),
        later
    );
}

#[test]
fn a_folder_that_is_no_city_is_never_replaced() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("thesis.txt"), "years of work").unwrap();
    let output = rilievo(&import_arguments(&sample().join("files"), folder.path()));
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(
        fs::read_to_string(folder.path().join("thesis.txt")).unwrap(),
        "years of work"
    );
}

#[test]
fn damaged_tiles_are_named_and_links_are_not_followed() {
    let folder = tempfile::tempdir().unwrap();
    let city = folder.path().join("city");
    for (path, bytes) in contents(&sample().join("city")) {
        let target = city.join(path);
        fs::create_dir_all(target.parent().unwrap()).unwrap();
        fs::write(target, bytes).unwrap();
    }
    let opened = City::open(&city).unwrap();
    let tile = opened
        .manifest()
        .grid
        .tiles()
        .find(|&tile| opened.has(rilievo::city::Layer::Buildings, tile))
        .unwrap();
    let path = city.join(format!("buildings/0/{}_{}.tif", tile.x, tile.y));
    let whole = fs::read(&path).unwrap();

    // Every cut and many flipped bytes: an error or a sound map, never a panic.
    for share in 1..40 {
        fs::write(&path, &whole[..whole.len() * share / 40]).unwrap();
        let error = opened.buildings(tile).unwrap_err().to_string();
        assert!(error.contains(&format!("{}_{}.tif", tile.x, tile.y)), "{error}");
    }
    for flip in (0..whole.len()).step_by(whole.len() / 150) {
        let mut bytes = whole.clone();
        bytes[flip] ^= 0x5a;
        fs::write(&path, &bytes).unwrap();
        if let Ok(Some(map)) = opened.buildings(tile) {
            assert!(map.is_sound());
        }
    }
    #[cfg(unix)]
    {
        let secret = folder.path().join("outside.tif");
        fs::write(&secret, &whole).unwrap();
        fs::remove_file(&path).unwrap();
        std::os::unix::fs::symlink(&secret, &path).unwrap();
        assert!(
            opened.buildings(tile).unwrap().is_none(),
            "a link led out of the city"
        );
    }
}

#[test]
fn the_pyramid_bounds_every_texel_and_words_name_real_buildings() {
    let city = City::open(&sample().join("city")).unwrap();
    let mut buildings = std::collections::BTreeSet::new();
    for tile in city.manifest().grid.tiles() {
        let Some(map) = city.buildings(tile).unwrap() else {
            continue;
        };
        let low = map.height_range[0];
        let pyramid = Pyramid::from_map(&map, low);
        let coarsest = (pyramid.max_height() - low) / 253.99 + 1e-3;
        for ([block_x, block_y], codes) in map.occupied_blocks() {
            let highest = codes.iter().map(|&code| map.highest_roof(code));
            let highest = highest.fold(f32::NEG_INFINITY, f32::max);
            for level in 1..=Pyramid::top_level(map.side) {
                let [column, row] = [block_x, block_y].map(|block| block >> (2 * level - 2));
                let bound = pyramid.bound(level, column, row);
                assert!(bound >= highest);
                assert!(level > 1 || bound <= highest + coarsest);
            }
        }
        buildings.extend(map.roofs.iter().map(|roof| roof.fid));
    }
    assert_eq!(buildings.len() as u64, city.manifest().buildings);
}

/// A region of a size asked for: the same files every time, as many buildings as named, on the ground; refused where they do not fit.
#[test]
fn a_region_has_the_buildings_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let [first, second, city] = ["first", "second", "city"].map(|name| folder.path().join(name));
    for region in [&first, &second] {
        succeed(&[
            "sample".as_ref(),
            "--buildings".as_ref(),
            "2500".as_ref(),
            "--km2".as_ref(),
            "9".as_ref(),
            region.as_os_str(),
        ]);
    }
    let (a, b) = (contents(&first), contents(&second));
    assert_eq!(a.keys().collect::<Vec<_>>(), b.keys().collect::<Vec<_>>());
    assert!(a.iter().all(|(path, bytes)| *bytes == b[path]), "two runs differ");
    let files = [first.join("terrain.tif"), first.join("buildings.gpkg")];
    let [terrain, buildings] = files.each_ref().map(|path| path.as_os_str());
    succeed(&[
        "import".as_ref(),
        "--terrain".as_ref(),
        terrain,
        "--buildings".as_ref(),
        buildings,
        "--height-field".as_ref(),
        "height_m".as_ref(),
        "--out".as_ref(),
        city.as_os_str(),
    ]);
    let opened = City::open(&city).unwrap();
    let manifest = opened.manifest();
    assert_eq!(manifest.buildings, 2500);
    assert_eq!(manifest.footprints.repaired.len(), 0, "{:?}", manifest.footprints);
    let bounds = manifest.grid.bounds();
    let km2 = bounds.width() * bounds.height() * 1e-6;
    assert!((7.0..12.0).contains(&km2), "{km2} km2");

    let refused = rilievo(&[
        "sample".as_ref(),
        "--buildings".as_ref(),
        "90000".as_ref(),
        "--km2".as_ref(),
        "1".as_ref(),
        second.as_os_str(),
    ]);
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert_eq!(refused.status.code(), Some(1), "{said}");
    assert!(said.contains("fit") && said.contains("--km2"), "{said}");
}

/// What shaders read of a building map, read as they do, says of every texel what the map says.
#[test]
fn the_device_reads_the_same_codes() {
    let city = City::open(&sample().join("city")).unwrap();
    let grid = city.manifest().grid;
    let (mut texels, mut lists) = (0, 0);
    for id in (0..grid.levels()).flat_map(|level| grid.tiles_of_level(level)) {
        let Some(map) = city.buildings(id).unwrap() else {
            continue;
        };
        let device = DeviceMap::new(&map);
        assert_eq!(device.words.len(), DeviceMap::word_count(&map));
        let groups = map.side / 16;
        for ([column, row], codes) in map.occupied_blocks() {
            let index = device.words[row / 4 * groups + column / 4];
            let bit = row % 4 * 4 + column % 4;
            assert!(index & (1 << bit) != 0);
            let before = (index & ((1 << bit) - 1)).count_ones();
            let [header, main, own, _] = device.blocks[((index >> 16) + before) as usize];
            let mut own = own as usize;
            for (texel, &code) in codes.iter().enumerate() {
                let read = match (header >> (2 * texel)) & 3 {
                    0 => 0,
                    1 => main,
                    _ => {
                        own += 1;
                        device.words[own - 1]
                    }
                };
                texels += 1;
                match (CellKind::from_code(code), CellKind::from_code(read)) {
                    (CellKind::List(_), CellKind::List(place)) => {
                        let place = place as usize;
                        let count = device.words[place] as usize;
                        assert_eq!(map.codes(code), &device.words[place + 1..place + 1 + count]);
                        lists += 1;
                    }
                    _ => assert_eq!(code, read, "{id:?}, block {column} {row}, texel {texel}"),
                }
            }
        }
    }
    assert!(texels > 100_000 && lists > 1000, "{texels} texels, {lists} lists");
}
