//! Decoders of our own, on real files with some bytes changed: an error or a sound value, never a panic and never an endless read. More
//! rounds: `FUZZ_ROUNDS=100000 cargo test --release --test fuzz` (`tools/fuzz`).
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use std::fs;
use std::path::Path;
use std::sync::Arc;

use rilievo::camera::flare::{FlareTable, GhostTable, open_table, write_table};
use rilievo::camera::lens::{built_in, open, to_toml};
use rilievo::camera::{Paraxial, Tracer, beam_direction, single_crossing_ghosts};
use rilievo::city::{City, Layer};
use rilievo::material::FacadeRules;
use rilievo::output::{Flight, FlightPath};
use support::random::Random;

fn rounds(usual: u32) -> u32 {
    std::env::var("FUZZ_ROUNDS")
        .ok()
        .and_then(|rounds| rounds.parse().ok())
        .unwrap_or(usual)
}

#[test]
fn tiles_and_manifests() {
    let folder = tempfile::tempdir().unwrap();
    let city = support::copied(folder.path());
    let opened = City::open(&city).unwrap();
    let grid = opened.manifest().grid;
    let has_all = |tile| Layer::ALL.into_iter().all(|layer| opened.has(layer, tile));
    let tile = grid.tiles().find(|&tile| has_all(tile)).unwrap();
    let coarse = tile.parent();
    let mut random = Random(1);
    let (mut sound, mut refused) = (0, 0);
    for (layer, tile) in [
        (Layer::Terrain, tile),
        (Layer::Buildings, tile),
        (Layer::Imagery, tile),
        (Layer::Terrain, coarse),
        (Layer::Buildings, coarse),
    ] {
        let path = layer.tile_path(&city, tile);
        let whole = fs::read(&path).unwrap();
        for _ in 0..rounds(120) {
            fs::write(&path, random.changed(&whole)).unwrap();
            match opened.tile(tile) {
                Ok(_) => sound += 1,
                Err(error) => {
                    assert!(error.to_string().contains(".tif"), "{error}");
                    refused += 1;
                }
            }
        }
        fs::write(&path, whole).unwrap();
    }
    for name in ["city.toml", "terrain/errors.tif"] {
        let path = city.join(name);
        let whole = fs::read(&path).unwrap();
        for _ in 0..rounds(400) {
            fs::write(&path, random.changed(&whole)).unwrap();
            match City::open(&city).and_then(|city| city.terrain_errors()) {
                Ok(_) => sound += 1,
                Err(_) => refused += 1,
            }
        }
        fs::write(&path, whole).unwrap();
    }
    println!("{sound} sound, {refused} refused");
    assert!(sound > 0 && refused > sound, "{sound} sound, {refused} refused");
}

#[test]
fn rules_and_flights() {
    let folder = tempfile::tempdir().unwrap();
    let mut random = Random(2);
    let (mut sound, mut refused) = (0, 0);
    let mut count = |is_sound: bool| if is_sound { sound += 1 } else { refused += 1 };
    for _ in 0..rounds(600) {
        let text = random.changed(FacadeRules::BUILT_IN.as_bytes());
        count(FacadeRules::from_text(&String::from_utf8_lossy(&text)).is_ok());
    }
    let path = folder.path().join("p.json");
    let flight = br#"[{"t": 0, "eye": [1,2,3], "look": [4,5,6], "fov": 50, "f_number": 8}, {"t": 4, "eye": [9,2,3], "look": [4,5,6]}, {"t": 9, "eye": [9,9,3], "look": [4,5,6], "exposure": 2}]"#;
    for _ in 0..rounds(600) {
        fs::write(&path, random.changed(flight)).unwrap();
        let read = FlightPath::read(&path);
        count(read.is_ok());
        if let Some(flight) = read.ok().as_ref().and_then(Flight::new) {
            let [first, last] = flight.span();
            for k in 0..5 {
                let _ = flight.at(first + (last - first) * f64::from(k) / 4.0);
            }
        }
    }
    println!("{sound} sound, {refused} refused");
    assert!(sound > 0 && refused > 0, "{sound} sound, {refused} refused");
}

/// What is no lens is refused; what is one can be traced.
#[test]
fn lenses() {
    let folder = tempfile::tempdir().unwrap();
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/lenses");
    let mut seeds: Vec<(String, Vec<u8>)> = fs::read_dir(fixtures)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.is_file())
        .map(|path| {
            let ending = path.extension().unwrap().to_string_lossy().into_owned();
            (ending, fs::read(&path).unwrap())
        })
        .filter(|(ending, _)| ["toml", "csv", "zmx", "seq", "dat"].contains(&ending.as_str()))
        .collect();
    seeds.push((
        "toml".to_owned(),
        to_toml(&built_in("nikon").unwrap().unwrap()).into_bytes(),
    ));
    seeds.push((
        "zmx".to_owned(),
        b"NAME x\nUNIT MM\nSURF 0\n  CURV 0\n  DISZ INFINITY\nSURF 1\n  CURV 0.02\n  DISZ 5\n  GLAS N-BK7 0 0 1.5168 64.17\n  DIAM 10\nSURF 2\n  STOP\n  CURV -0.02\n  DISZ 40\n  DIAM 9\nSURF 3\n  CURV 0\n".to_vec(),
    ));
    seeds.push((
        "seq".to_owned(),
        b"RDM;LEN\nTITLE 'x'\nDIM M\nS0 0 1e10\nS 40 5 BK7_SCHOTT\nS -40 2\nS 0 30\nSTO\nSI 0 0\nGO\n"
            .to_vec(),
    ));
    let mut random = Random(3);
    let (mut sound, mut refused) = (0, 0);
    for (ending, seed) in &seeds {
        let path = folder.path().join(format!("l.{ending}"));
        for _ in 0..rounds(300) {
            fs::write(&path, random.changed(seed)).unwrap();
            let Ok(lens) = open(path.to_str().unwrap()) else {
                refused += 1;
                continue;
            };
            sound += 1;
            let paraxial = Paraxial::new(&lens, 0.587_56, None);
            let tracer = Tracer::new(&lens, 0.5, paraxial.sensor_gap_mm());
            for ghost in single_crossing_ghosts(&lens).into_iter().take(4) {
                let _ = paraxial.matrices(Some(ghost));
                let _ = tracer.trace(Some(ghost), glam::DVec2::new(1.0, 0.5), beam_direction(0.1));
            }
        }
    }
    println!("{sound} sound, {refused} refused");
    assert!(sound > 0 && refused > 0, "{sound} sound, {refused} refused");
}

#[test]
fn flare_tables() {
    let folder = tempfile::tempdir().unwrap();
    let lens = Arc::new(built_in("tessar").unwrap().unwrap());
    let path = folder.path().join("t.flare");
    let baked = GhostTable::of_rays(FlareTable::bake(&lens, 8.0, 0.2));
    write_table(&path, &lens, baked).unwrap();
    let packed = fs::read(&path).unwrap();
    // The packing's checksum refuses most: what is inside is changed too.
    let mut inside = Vec::new();
    std::io::Read::read_to_end(
        &mut flate2::read::ZlibDecoder::new(packed.as_slice()),
        &mut inside,
    )
    .unwrap();
    let mut random = Random(4);
    let (mut sound, mut refused) = (0, 0);
    for round in 0..rounds(250) {
        let bytes = if round % 4 == 0 {
            random.changed(&packed)
        } else {
            let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
            std::io::Write::write_all(&mut encoder, &random.changed(&inside)).unwrap();
            encoder.finish().unwrap()
        };
        fs::write(&path, bytes).unwrap();
        let Ok(table) = open_table(&path, &lens, 8.0) else {
            refused += 1;
            continue;
        };
        sound += 1;
        for angle in [0.0, 0.07, 0.19] {
            if let Some(rays) = table.at(angle, false).rays {
                for ghost in single_crossing_ghosts(&lens) {
                    if let Some(evaluated) = rays.ghost(ghost).and_then(|ghost| ghost.at(angle)) {
                        let _ = evaluated.grid(0.55, 8);
                    }
                }
            }
        }
    }
    println!("{sound} sound, {refused} refused");
    assert!(refused > 0, "{sound} sound, {refused} refused");
}
