//! What careless and hostile files do to import, film and update: what is no file is not waited for, what is cut is not taken for whole,
//! what unpacks or nests without end is not begun, and nobody's own files are lost.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use rilievo::city::{City, Layer};
use rilievo::space::TileId;
use support::{copied, import_arguments, refused, rilievo, sample, succeed};

/// Longest that a refusal may take.
const SOON: Duration = Duration::from_secs(5);

/// The sample's import with other files: `changes` name a flag and what it is given instead.
fn import_with(out: &Path, changes: &[(&str, &Path)]) -> Vec<String> {
    let mut arguments = import_arguments(&sample().join("files"), out);
    for (flag, file) in changes {
        let file = file.display().to_string();
        match arguments.iter().position(|argument| argument == flag) {
            Some(at) => arguments[at + 1] = file,
            None => arguments.extend([(*flag).to_owned(), file]),
        }
    }
    arguments
}

/// Refused soon, by name and with `why`.
fn refused_soon(arguments: &[String], why: &str) {
    let begun = Instant::now();
    let message = refused(arguments);
    assert!(message.contains(why), "{message}");
    assert!(begun.elapsed() < SOON, "{:?}: {message}", begun.elapsed());
}

fn words(words: &[&str], paths: &[&Path]) -> Vec<String> {
    let mut all: Vec<String> = words.iter().map(|&word| word.to_owned()).collect();
    all.extend(paths.iter().map(|path| path.display().to_string()));
    all
}

/// A pipe keeps its reader waiting for ever.
#[test]
fn what_is_no_file_is_not_waited_for() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = |name: &str| -> PathBuf {
        let path = folder.path().join(name);
        assert!(Command::new("mkfifo").arg(&path).status().unwrap().success());
        path
    };
    let out = folder.path().join("c");
    let [vectors, raster, track, picture, table, rules] =
        ["f.geojson", "f.tif", "f.gpx", "f.png", "f.table", "f.toml"].map(pipe);
    for flag in ["--buildings", "--roads", "--water"] {
        refused_soon(&import_with(&out, &[(flag, &vectors)]), "is no plain file");
    }
    for flag in ["--terrain", "--photo"] {
        refused_soon(&import_with(&out, &[(flag, &raster)]), "is no plain file");
    }
    let with_rules = import_with(&out, &[("--roads", &vectors), ("--ground-rules", &rules)]);
    refused_soon(&with_rules, "is no plain file");
    let endless = folder.path().join("z.json");
    std::os::unix::fs::symlink("/dev/zero", &endless).unwrap();
    refused_soon(
        &import_with(&out, &[("--buildings", &endless)]),
        "is no plain file",
    );

    let city = sample().join("city");
    let mut film = words(&["film"], &[&city]);
    film.extend(words(&["--path"], &[&track]));
    film.extend(words(&["--out"], &[&folder.path().join("frames")]));
    refused_soon(&film, "is no plain file");
    let mut update = words(&["update"], &[&city]);
    update.extend(words(&["--buildings"], &[&vectors]));
    refused_soon(&update, "is no plain file");
    let mut relief = words(&["relief", "--texture"], &[&picture]);
    relief.extend(words(&["--height"], &[&picture]));
    relief.extend(words(&["--out"], &[&folder.path().join("o.png")]));
    refused_soon(&relief, "is no plain file");
    let mut render = words(&["render"], &[&city]);
    render.extend(words(
        &[
            "--eye",
            "288900,4772500,1000",
            "--look",
            "289230,4773050,215",
            "--lens",
            "heliar",
            "--flare-table",
        ],
        &[&table],
    ));
    render.extend(words(&["--out"], &[&folder.path().join("o.png")]));
    refused_soon(&render, "is no plain file");
}

/// Footprints around the sample's town, as lines of one of the text formats; `row`: of one feature, by its number and ring.
fn footprints(count: u32, row: impl Fn(u32, &[[f64; 2]; 5]) -> String) -> String {
    (0..count)
        .map(|k| {
            let (x, y) = (
                289_100.0 + 20.0 * f64::from(k % 10),
                4_772_900.0 + 20.0 * f64::from(k / 10),
            );
            row(
                k,
                &[[0.0, 0.0], [8.0, 0.0], [8.0, 8.0], [0.0, 8.0], [0.0, 0.0]]
                    .map(|[dx, dy]| [x + dx, y + dy]),
            )
        })
        .collect()
}

/// A file that was cut while it was copied holds fewer buildings; its reader takes it for whole.
#[test]
fn cut_vectors_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("c");
    let points = |ring: &[[f64; 2]; 5]| ring.map(|[x, y]| format!("{x} {y}\n")).concat();
    // GMT: the last line is cut. MapInfo: features are missing for rows of the table.
    let gmt = footprints(60, |k, ring| format!("> -D{k}\n{}", points(ring)));
    let gmt = format!("# @VGMT1.0 @GPOLYGON\n# @NheightT @Tdouble\n# FEATURE_DATA\n{gmt}");
    let interchange = |count| {
        let regions = footprints(count, |_, ring| {
            format!(
                "Region 1\n  5\n{}    Pen (1,2,0)\n    Brush (1,0,16777215)\n",
                points(ring)
            )
        });
        format!(
            "Version 300\nCharset \"Neutral\"\nDelimiter \",\"\nCoordSys NonEarth Units \"m\" Bounds (0, 0) (1000000, 10000000)\nColumns 1\n  k Integer\nData\n\n{regions}"
        )
    };
    let rows: String = (0..60).map(|k| format!("{k}\n")).collect();
    let import = |name: &str| {
        let mut arguments = import_with(&out, &[("--buildings", &folder.path().join(name))]);
        let field = arguments
            .iter()
            .position(|argument| argument == "--height-field")
            .unwrap();
        arguments.drain(field..field + 2);
        arguments.extend(["--buildings-crs", "EPSG:32633"].map(str::to_owned));
        arguments
    };
    for (name, whole, cut) in [
        (
            "a.gmt",
            gmt.clone(),
            gmt[..gmt.len() * 2 / 3].trim_end().to_owned(),
        ),
        ("a.mif", interchange(60), interchange(45)),
    ] {
        fs::write(folder.path().join("a.mid"), &rows).unwrap();
        fs::write(folder.path().join(name), whole).unwrap();
        let report = rilievo(&import(name));
        let errors = String::from_utf8_lossy(&report.stderr).into_owned();
        assert!(report.status.success(), "{name}: {errors}");
        fs::remove_dir_all(&out).unwrap();
        fs::write(folder.path().join(name), cut).unwrap();
        refused_soon(&import(name), "damaged or truncated");
    }
}

/// Of a raster whose file was cut GDAL gives zeros for the rest.
#[test]
fn cut_rasters_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("c");
    let raster = folder.path().join("e.img");
    let side = 64;
    let header = format!(
        "ENVI\nsamples = {side}\nlines = {side}\nbands = 1\nheader offset = 0\nfile type = ENVI Standard\ndata type = 4\ninterleave = bsq\nbyte order = 0\nmap info = {{UTM, 1, 1, 288400, 4773800, 25, 25, 33, North,WGS-84}}\n"
    );
    fs::write(folder.path().join("e.hdr"), header).unwrap();
    let samples: Vec<u8> = (0..side * side).flat_map(|_| 215.0_f32.to_le_bytes()).collect();
    fs::write(&raster, &samples).unwrap();
    let import = import_with(
        &out,
        &[("--terrain", &raster), ("--terrain-crs", Path::new("EPSG:32633"))],
    );
    succeed(&import);
    fs::remove_dir_all(&out).unwrap();
    fs::write(&raster, &samples[..samples.len() * 3 / 5]).unwrap();
    refused_soon(&import, "damaged or truncated");
}

/// Kilobytes that ask for hours.
#[test]
fn rasters_ask_for_bounded_work() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("c");
    let terrain = sample().join("files/terrain.tif");
    // A raster of a fifth of a millimetre.
    let fine = folder.path().join("fine.vrt");
    fs::write(
        &fine,
        format!(
            "<VRTDataset rasterXSize=\"2000000000\" rasterYSize=\"2000000000\"><SRS>EPSG:32633</SRS><GeoTransform>288900,0.0002,0,4773200,0,-0.0002</GeoTransform><VRTRasterBand dataType=\"Float32\" band=\"1\"><SimpleSource><SourceFilename>{}</SourceFilename><SourceBand>1</SourceBand></SimpleSource></VRTRasterBand></VRTDataset>",
            terrain.display()
        ),
    )
    .unwrap();
    refused_soon(&import_with(&out, &[("--terrain", &fine)]), "coarser first");
    refused_soon(&import_with(&out, &[("--photo", &fine)]), "coarser first");
    // Twenty mosaics, each of which names the next twice: a million reads.
    let mut part = terrain.display().to_string();
    for level in 0..20 {
        let source = format!(
            "<SimpleSource><SourceFilename>{part}</SourceFilename><SourceBand>1</SourceBand></SimpleSource>"
        );
        let mosaic = folder.path().join(format!("{level}.vrt"));
        fs::write(
            &mosaic,
            format!(
                "<VRTDataset rasterXSize=\"256\" rasterYSize=\"256\"><SRS>EPSG:32633</SRS><GeoTransform>288400,4,0,4773600,0,-4</GeoTransform><VRTRasterBand dataType=\"Float32\" band=\"1\">{source}{source}</VRTRasterBand></VRTDataset>"
            ),
        )
        .unwrap();
        part = mosaic.display().to_string();
    }
    refused_soon(
        &import_with(&out, &[("--terrain", Path::new(&part))]),
        "nested too deep",
    );
}

/// What a city's owner put beside its files, or gave other names, stays as it is.
#[test]
fn nobodys_files_are_lost() {
    let folder = tempfile::tempdir().unwrap();
    // The sample's files over somebody's own.
    let own = folder.path().join("own");
    fs::create_dir(&own).unwrap();
    fs::write(own.join("terrain.tif"), "my survey").unwrap();
    let message = refused(&words(&["sample"], &[&own]));
    assert!(
        message.contains("terrain.tif: exists and is another file"),
        "{message}"
    );
    assert_eq!(fs::read(own.join("terrain.tif")).unwrap(), b"my survey");
    assert_eq!(fs::read_dir(&own).unwrap().count(), 1);

    // A backup by hard links keeps the buildings that an update takes out.
    let city = copied(folder.path());
    let (dataset, backup) = (city.join("buildings.gpkg"), folder.path().join("backup.gpkg"));
    fs::hard_link(&dataset, &backup).unwrap();
    let before = fs::read(&backup).unwrap();
    let mut update = words(&["update"], &[&city]);
    update.extend(["--delete", "1"].map(str::to_owned));
    succeed(&update);
    assert!(fs::read(&backup).unwrap() == before, "the backup was changed");
    assert!(fs::read(&dataset).unwrap() != before);
}

/// An import over a city keeps its owner's pictures, and does not replace an edited dataset because its manifest was edited after it.
#[test]
fn an_import_keeps_what_the_owner_made() {
    let folder = tempfile::tempdir().unwrap();
    let city = folder.path().join("c");
    let import = import_with(&city, &[]);
    succeed(&import);
    fs::create_dir(city.join("facades")).unwrap();
    fs::write(city.join("facades/mine.png"), "a picture for rules to come").unwrap();
    succeed(&import);
    assert!(city.join("facades/mine.png").is_file());

    // A folder of theirs under a name of the program's.
    let own = city.join("facades.before.toml");
    fs::create_dir(&own).unwrap();
    fs::write(own.join("mine.txt"), "mine").unwrap();
    assert!(refused(&import).contains("facades.before.toml"));
    assert!(own.join("mine.txt").is_file());
    fs::remove_dir_all(&own).unwrap();

    let dataset = rusqlite::Connection::open(city.join("buildings.gpkg")).unwrap();
    dataset
        .execute_batch("CREATE TABLE notes (text); INSERT INTO notes VALUES ('mine')")
        .unwrap();
    drop(dataset);
    let manifest = city.join("city.toml");
    let text = fs::read_to_string(&manifest).unwrap();
    std::thread::sleep(Duration::from_millis(20));
    fs::write(&manifest, text.replacen("name = \"c\"", "name = \"Town\"", 1)).unwrap();
    let message = refused(&import);
    assert!(message.contains("would lose"), "{message}");
}

/// A coarse tile from another place, or one that is gone, is told.
#[test]
fn coarse_tiles_are_checked() {
    let folder = tempfile::tempdir().unwrap();
    let city = copied(folder.path());
    let opened = City::open(&city).unwrap();
    let level = 1;
    let mut tiles = opened.manifest().grid.tiles_of_level(level);
    let mut next = || tiles.find(|&tile| opened.has(Layer::Buildings, tile)).unwrap();
    let (a, b) = (next(), next());
    opened.require_all_tiles().unwrap();
    let path = |tile: TileId| city.join(format!("buildings/{level}/{}_{}.tif", tile.x, tile.y));
    let (of_a, of_b) = (fs::read(path(a)).unwrap(), fs::read(path(b)).unwrap());
    fs::write(path(a), of_b).unwrap();
    fs::write(path(b), of_a).unwrap();
    for tile in [a, b] {
        let error = opened.buildings(tile).unwrap_err().to_string();
        assert!(error.contains("that of another place"), "{error}");
    }
    for layer in [Layer::Buildings, Layer::Terrain] {
        fs::remove_file(city.join(format!("{}/{level}/{}_{}.tif", layer.name(), a.x, a.y))).unwrap();
        let error = opened.require_tiles(layer).unwrap_err().to_string();
        assert!(error.contains(&format!("{}_{}.tif", a.x, a.y)), "{error}");
    }
}

/// A city from a stranger whose parts are links: nothing outside it is written or copied.
#[test]
fn links_in_a_city_lead_nowhere() {
    use std::os::unix::fs::symlink;
    let folder = tempfile::tempdir().unwrap();
    let precious = folder.path().join("precious.txt");
    fs::write(&precious, "precious").unwrap();
    let is_intact = || assert_eq!(fs::read(&precious).unwrap(), b"precious");

    // What an import writes over an old city.
    let city = copied(folder.path());
    for name in ["import.cache_key.partial", "facades"] {
        symlink("../precious.txt", city.join(name)).unwrap();
        let message = refused(&import_with(&city, &[]));
        assert!(message.contains(name), "{message}");
        is_intact();
        fs::remove_file(city.join(name)).unwrap();
    }
    // The copy of a dataset that has another name.
    let pending = city.join("update.commit");
    fs::create_dir_all(pending.join("buildings/0")).unwrap();
    fs::copy(city.join("city.toml"), pending.join("city.toml")).unwrap();
    fs::write(pending.join("plan.toml"), "tiles = []\nbuildings = [3]\n").unwrap();
    symlink("../../precious.txt", pending.join("dataset.gpkg")).unwrap();
    fs::hard_link(city.join("buildings.gpkg"), folder.path().join("other.gpkg")).unwrap();
    let _ = rilievo(&words(&["update"], &[&city]));
    is_intact();
    assert!(city.join("buildings.gpkg").symlink_metadata().unwrap().is_file());

    // A marker without end.
    let staging = folder.path().join("z.partial");
    fs::create_dir(&staging).unwrap();
    let marker = fs::File::create(staging.join("import.cache_key")).unwrap();
    std::io::Write::write_all(&mut &marker, b"rilievo ").unwrap();
    marker.set_len(6 << 30).unwrap();
    succeed(&import_with(&folder.path().join("z"), &[]));
}

/// A dataset whose definition or index makes a change of one footprint endless, or change others.
#[test]
fn a_dataset_runs_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let city = copied(folder.path());
    let dataset = city.join("buildings.gpkg");
    let whole = fs::read(&dataset).unwrap();
    let refused_after = |change: &str| {
        fs::write(&dataset, &whole).unwrap();
        let database = rusqlite::Connection::open(&dataset).unwrap();
        let columns: String = database
            .query_row(
                "SELECT sql FROM sqlite_master WHERE name = 'buildings'",
                (),
                |row| row.get(0),
            )
            .unwrap();
        assert!(columns.trim_end().ends_with(')'), "{columns}");
        database.execute_batch(change).unwrap();
        drop(database);
        let mut update = words(&["update"], &[&city]);
        update.extend(["--delete", "1"].map(str::to_owned));
        let begun = Instant::now();
        let message = refused(&update);
        assert!(message.contains("buildings.gpkg"), "{message}");
        assert!(begun.elapsed() < SOON, "{change}");
    };
    let with = |constraint: &str| {
        format!(
            "PRAGMA writable_schema = on; UPDATE sqlite_master SET sql = rtrim(sql, ') ') || ', {constraint})' WHERE name = 'buildings'"
        )
    };
    refused_after(&with("CHECK (length(hex(zeroblob(450000000))) > 0)"));
    refused_after(&with("UNIQUE (geom) ON CONFLICT REPLACE"));
    refused_after("CREATE INDEX i ON buildings (hex(geom))");
    refused_after(&with("UNIQUE (geom) /* ') */ ON CONFLICT REPLACE").replace("/* ')", "/* '')"));
    refused_after(
        "CREATE TRIGGER x AFTER UPDATE ON gpkg_contents BEGIN DELETE FROM buildings WHERE fid < 3; END",
    );
    refused_after("CREATE TABLE rtree_x (id INTEGER)");
    // A spatial index of thirty levels in a node or two.
    refused_after("UPDATE rtree_buildings_geom_node SET data = x'001e' || substr(data, 3) WHERE nodeno = 1");
}

/// What honest owners add to a dataset is none of that: a new building gets the defaults of columns that it does not name.
#[test]
fn honest_definitions_are_taken() {
    let folder = tempfile::tempdir().unwrap();
    let city = copied(folder.path());
    let dataset = city.join("buildings.gpkg");
    let database = rusqlite::Connection::open(&dataset).unwrap();
    database
        .execute_batch(
            "ALTER TABLE buildings ADD COLUMN conflict TEXT;
             ALTER TABLE buildings ADD COLUMN note TEXT NOT NULL DEFAULT 'none';
             ALTER TABLE buildings ADD COLUMN floors INTEGER CHECK (floors >= 0);
             CREATE INDEX high ON buildings (height_m) WHERE height_m IS NOT NULL;
             CREATE VIEW few AS SELECT fid FROM buildings",
        )
        .unwrap();
    drop(database);
    succeed(&words(&["update"], &[&city]));
    let footprints = folder.path().join("new.geojson");
    let ring = "[[289230,4773050],[289240,4773050],[289240,4773060],[289230,4773060],[289230,4773050]]";
    fs::write(
        &footprints,
        format!(
            "{{\"type\":\"FeatureCollection\",\"features\":[{{\"type\":\"Feature\",\"properties\":{{\"fid\":90001,\"height_m\":9}},\"geometry\":{{\"type\":\"Polygon\",\"coordinates\":[{ring}]}}}}]}}"
        ),
    )
    .unwrap();
    let mut update = words(&["update"], &[&city]);
    update.extend(words(
        &["--buildings-crs", "EPSG:32633", "--buildings"],
        &[&footprints],
    ));
    succeed(&update);
    let database = rusqlite::Connection::open(&dataset).unwrap();
    let note: String = database
        .query_row("SELECT note FROM buildings WHERE fid = 90001", (), |row| {
            row.get(0)
        })
        .unwrap();
    assert_eq!(note, "none");
}

/// Another layer of a dataset is not looked at: a view may have rows without end.
#[test]
fn other_layers_are_not_looked_at() {
    let folder = tempfile::tempdir().unwrap();
    let city = copied(folder.path());
    let database = rusqlite::Connection::open(city.join("buildings.gpkg")).unwrap();
    database
        .execute_batch(
            "CREATE VIEW endless AS WITH RECURSIVE c(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM c) SELECT x AS fid, NULL AS geom FROM c WHERE x < 0;
             INSERT INTO gpkg_contents (table_name, data_type, identifier, srs_id) SELECT 'endless', 'features', 'endless', srs_id FROM gpkg_contents WHERE table_name = 'buildings';
             INSERT INTO gpkg_geometry_columns SELECT 'endless', 'geom', 'GEOMETRY', srs_id, 0, 0 FROM gpkg_contents WHERE table_name = 'buildings'",
        )
        .unwrap();
    drop(database);
    let begun = Instant::now();
    succeed(&words(&["update"], &[&city]));
    assert!(begun.elapsed() < SOON, "{:?}", begun.elapsed());
}

/// Cut raw files behind other headers.
#[test]
fn cut_raw_files_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("c");
    let side = 64_usize;
    let samples: Vec<u8> = (0..side * side).flat_map(|_| 215.0_f32.to_le_bytes()).collect();
    let [grid, raw, mosaic] = ["e.flt", "r.bin", "r.vrt"].map(|name| folder.path().join(name));
    fs::write(
        folder.path().join("e.hdr"),
        format!(
            "ncols {side}\nnrows {side}\nxllcorner 288400\nyllcorner 4772200\ncellsize 25\nNODATA_value -9999\nbyteorder LSBFIRST\n"
        ),
    )
    .unwrap();
    fs::write(
        &mosaic,
        format!(
            "<VRTDataset rasterXSize=\"{side}\" rasterYSize=\"{side}\"><SRS>EPSG:32633</SRS><GeoTransform>288400,25,0,4773800,0,-25</GeoTransform><VRTRasterBand dataType=\"Float32\" band=\"1\" subClass=\"VRTRawRasterBand\"><SourceFilename relativeToVRT=\"1\">r.bin</SourceFilename><ImageOffset>0</ImageOffset><PixelOffset>4</PixelOffset><LineOffset>{}</LineOffset><ByteOrder>LSB</ByteOrder></VRTRasterBand></VRTDataset>",
            4 * side
        ),
    )
    .unwrap();
    for (given, data) in [(&grid, &grid), (&mosaic, &raw)] {
        let import = import_with(
            &out,
            &[("--terrain", given), ("--terrain-crs", Path::new("EPSG:32633"))],
        );
        fs::write(data, &samples).unwrap();
        succeed(&import);
        fs::remove_dir_all(&out).unwrap();
        fs::write(data, &samples[..samples.len() * 3 / 5]).unwrap();
        refused_soon(&import, "damaged or truncated");
    }
}

/// A terrain across 180 degrees of longitude, and one whose longitudes go on beyond them, are whole.
#[test]
fn terrain_across_the_date_line_is_whole() {
    let folder = tempfile::tempdir().unwrap();
    let side = 120_usize;
    let samples: Vec<u8> = (0..side * side).flat_map(|_| 50.0_f32.to_le_bytes()).collect();
    let square = |k: u32, lon: f64, lat: f64| {
        let ring = [[0.0, 0.0], [1e-4, 0.0], [1e-4, 1e-4], [0.0, 1e-4], [0.0, 0.0]];
        let ring = ring
            .map(|[x, y]| format!("[{:.6},{:.6}]", lon + x, lat + y))
            .join(",");
        format!(
            "{{\"type\":\"Feature\",\"properties\":{{\"height_m\":{}}},\"geometry\":{{\"type\":\"Polygon\",\"coordinates\":[[{ring}]]}}}}",
            5 + k
        )
    };
    for (name, west, places) in [
        ("a", 179.997, [179.9985, -179.9985]),
        ("b", 184.997, [-175.0015, 185.0015]),
    ] {
        let raster = folder.path().join(format!("{name}.img"));
        fs::write(&raster, &samples).unwrap();
        fs::write(
            folder.path().join(format!("{name}.hdr")),
            format!(
                "ENVI\nsamples = {side}\nlines = {side}\nbands = 1\nheader offset = 0\nfile type = ENVI Standard\ndata type = 4\ninterleave = bsq\nbyte order = 0\nmap info = {{Geographic Lat/Lon, 1, 1, {west}, -17, 5e-5, 5e-5, WGS-84}}\n"
            ),
        )
        .unwrap();
        let footprints = folder.path().join(format!("{name}.geojson"));
        let features = [square(1, places[0], -17.003), square(2, places[1], -17.0031)].join(",");
        fs::write(
            &footprints,
            format!("{{\"type\":\"FeatureCollection\",\"features\":[{features}]}}"),
        )
        .unwrap();
        let out = folder.path().join(format!("city_{name}"));
        let mut import = words(&["import", "--height-field", "height_m", "--terrain"], &[&raster]);
        import.extend(words(&["--buildings"], &[&footprints]));
        import.extend(words(&["--out"], &[&out]));
        succeed(&import);
        let manifest = City::open(&out).unwrap().manifest().clone();
        assert_eq!(manifest.buildings, 2, "{name}");
        // Ground over the whole raster: 120 x 5e-5 degrees, 106 km each at that latitude, half of it east of the line.
        let (bounds, ground) = (manifest.grid.bounds(), City::open(&out).unwrap());
        let ground = ground.ground();
        let step_m = 20.0;
        let widest = (0..(bounds.height() / step_m) as u32).map(|row| {
            let y = bounds.south + step_m * f64::from(row);
            let places = (0..(bounds.width() / step_m) as u32).map(|k| bounds.west + step_m * f64::from(k));
            places
                .filter(|&x| ground.at(x, y).ok().flatten().is_some())
                .count()
        });
        let widest_m = step_m * widest.max().unwrap_or(0) as f64;
        assert!((600.0..680.0).contains(&widest_m), "{name}: {widest_m} m");
    }
}

/// What is read is not written over, and edited rules for facades stay beside the new ones.
#[test]
fn inputs_and_rules_stay() {
    let folder = tempfile::tempdir().unwrap();
    let flight = folder.path().join("o.png");
    let views = r#"[{"eye": [288900, 4772600, 400], "look": [289180, 4773000, 215]}]"#;
    fs::write(&flight, views).unwrap();
    let mut render = words(&["render"], &[&sample().join("city")]);
    render.extend(words(&["--path"], &[&flight]));
    render.extend(words(&["--out"], &[&flight]));
    assert!(refused(&render).contains("would be written over"));
    assert_eq!(fs::read_to_string(&flight).unwrap(), views);

    let city = folder.path().join("c");
    let import = import_with(&city, &[]);
    succeed(&import);
    let rules = city.join("facades.toml");
    let edited = format!("# mine\n{}", fs::read_to_string(&rules).unwrap());
    fs::write(&rules, &edited).unwrap();
    let other = folder.path().join("other.toml");
    fs::write(&other, format!("# other\n{edited}")).unwrap();
    // The second time nothing is replaced, and what was stays.
    for _ in 0..2 {
        succeed(&import_with(&city, &[("--facades", &other)]));
        let before = fs::read_to_string(city.join("facades.before.toml")).unwrap();
        assert_eq!(before, edited);
    }
}
