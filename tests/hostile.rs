//! What careless and hostile input does: nothing is lost, nothing is read outside a city, and no file costs more than its size allows.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use support::{copied, import_arguments, refused, sample, walk};

fn info(city: &Path) -> String {
    refused(&["info", city.to_str().unwrap()])
}

/// An import of the sample's files with other footprints.
fn import_of(footprints: &Path, out: &Path) -> Vec<String> {
    let mut arguments = sample_import(out);
    let at = arguments
        .iter()
        .position(|argument| argument == "--buildings")
        .unwrap();
    arguments[at + 1] = footprints.display().to_string();
    arguments
}

fn sample_import(out: &Path) -> Vec<String> {
    import_arguments(&sample().join("files"), out)
}

/// Another import of the same city is told and changes nothing.
#[test]
fn imports_of_one_city_take_turns() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("c");
    let lock = File::create(folder.path().join("c.lock")).unwrap();
    lock.lock().unwrap();
    let message = refused(&sample_import(&out));
    assert!(message.contains("another import"), "{message}");
    assert!(!out.exists() && !folder.path().join("c.partial").exists());
    drop(lock);
    support::succeed(&sample_import(&out));
    assert!(!folder.path().join("c.lock").exists());

    // Somebody's own file of that name is not taken for a lock.
    let own = folder.path().join("Cargo.lock");
    fs::write(&own, "version = 4").unwrap();
    let message = refused(&sample_import(&folder.path().join("Cargo")));
    assert!(message.contains("Cargo.lock"), "{message}");
    assert_eq!(fs::read_to_string(&own).unwrap(), "version = 4");
}

/// A journal that names another file, which SQLite would delete, is refused, also where an update is to be finished.
#[test]
fn a_journal_names_no_other_file() {
    let folder = tempfile::tempdir().unwrap();
    let city = copied(folder.path());
    let other = folder.path().join("precious.txt");
    fs::write(&other, "mine").unwrap();
    let name = other.display().to_string().into_bytes();
    // As SQLite's `readSuperJournal` wants its end: the name, its length, the sum of its bytes, and the magic bytes.
    let sum: u32 = name.iter().map(|&byte| u32::from(byte)).sum();
    let mut journal = vec![0_u8; 512];
    journal.extend(&name);
    journal.extend((name.len() as u32).to_be_bytes());
    journal.extend(sum.to_be_bytes());
    journal.extend([0xd9, 0xd5, 0x05, 0xf9, 0x20, 0xa1, 0x63, 0xd7]);
    fs::write(city.join("buildings.gpkg-journal"), journal).unwrap();
    fs::create_dir_all(city.join("update.commit/buildings/0")).unwrap();
    fs::write(
        city.join("update.commit/plan.toml"),
        "tiles = []\nbuildings = [3]\n",
    )
    .unwrap();
    fs::copy(city.join("city.toml"), city.join("update.commit/city.toml")).unwrap();
    let message = refused(&["update", city.to_str().unwrap()]);
    assert!(message.contains("names another file"), "{message}");
    assert!(other.exists());
}

/// Only what an import made is removed: not a folder with a manifest of somebody's own, nor a city moved to where imports stage theirs.
#[test]
fn what_no_import_made_stays() {
    let folder = tempfile::tempdir().unwrap();
    let own = folder.path().join("own");
    fs::create_dir_all(own.join("photo")).unwrap();
    fs::write(own.join("city.toml"), "mine = 1").unwrap();
    fs::write(own.join("photo/holiday.jpg"), "x").unwrap();
    let message = refused(&sample_import(&own));
    assert!(message.contains("is not a city"), "{message}");
    assert!(own.join("photo/holiday.jpg").exists());

    let city = copied(folder.path());
    fs::create_dir_all(city.join("terrain/0/notes")).unwrap();
    let message = refused(&sample_import(&city));
    assert!(message.contains("terrain/0/notes"), "{message}");
    fs::remove_dir(city.join("terrain/0/notes")).unwrap();

    let moved = folder.path().join("d.partial");
    fs::rename(&city, &moved).unwrap();
    let before = walk(&moved);
    let message = refused(&sample_import(&folder.path().join("d")));
    assert!(message.contains("d.partial"), "{message}");
    let from_it = import_of(&moved.join("buildings.gpkg"), &folder.path().join("d"));
    let message = refused(&from_it);
    assert!(message.contains("lies inside the city"), "{message}");
    assert_eq!(walk(&moved), before);
}

/// A link to an empty folder is that folder; the link stays.
#[cfg(unix)]
#[test]
fn a_city_can_be_made_through_a_link() {
    let folder = tempfile::tempdir().unwrap();
    let (real, link) = (folder.path().join("real"), folder.path().join("link"));
    fs::create_dir(&real).unwrap();
    std::os::unix::fs::symlink(&real, &link).unwrap();
    support::succeed(&sample_import(&link));
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert!(real.join("city.toml").is_file());
}

/// Links and pipes for parts of a city are refused, and none of them is read.
#[cfg(unix)]
#[test]
fn nothing_leads_out_of_a_city() {
    use std::os::unix::fs::symlink;
    for part in [
        "city.toml",
        "facades.toml",
        "terrain",
        "terrain/0",
        "buildings/0",
        "photo",
    ] {
        let folder = tempfile::tempdir().unwrap();
        let city = copied(folder.path());
        let (inside, outside) = (city.join(part), folder.path().join("outside"));
        fs::rename(&inside, &outside).unwrap();
        symlink(&outside, &inside).unwrap();
        let message = match part {
            "facades.toml" => refused(&[
                "bench",
                city.to_str().unwrap(),
                "--size",
                "32x32",
                "--frames",
                "1",
            ]),
            _ => info(&city),
        };
        assert!(message.contains(part), "{part}: {message}");
    }
    let folder = tempfile::tempdir().unwrap();
    let city = copied(folder.path());
    fs::remove_file(city.join("city.toml")).unwrap();
    rustix::fs::mkfifoat(rustix::fs::CWD, city.join("city.toml"), rustix::fs::Mode::RUSR).unwrap();
    assert!(info(&city).contains("is no plain file"));
}

/// A footprint dataset that is a description of another file or of a service, and CRS behind addresses, are refused.
#[test]
fn a_city_names_no_other_file_and_no_server() {
    let folder = tempfile::tempdir().unwrap();
    let city = copied(folder.path());
    let manifest = fs::read_to_string(city.join("city.toml")).unwrap();
    let crs = manifest.lines().find(|line| line.starts_with("crs = ")).unwrap();
    for other in [
        "http://127.0.0.1:9/crs",
        "+proj=utm +zone=33 +nadgrids=/etc/passwd",
        "/etc/passwd",
        "urn:ogc:def:crs:EPSG::1/../../x",
    ] {
        fs::write(
            city.join("city.toml"),
            manifest.replace(crs, &format!("crs = \"{other}\"")),
        )
        .unwrap();
        assert!(info(&city).contains("its CRS is neither"), "{other}");
    }
    fs::write(city.join("city.toml"), &manifest).unwrap();
    let outside = sample().join("files/buildings.gpkg");
    for text in [
        format!(
            "<OGRVRTDataSource><OGRVRTLayer name=\"buildings\"><SrcDataSource>{}</SrcDataSource><SrcLayer>buildings</SrcLayer></OGRVRTLayer></OGRVRTDataSource>",
            outside.display()
        ),
        "<OGRWFSDataSource><URL>http://127.0.0.1:9/wfs</URL></OGRWFSDataSource>".to_owned(),
    ] {
        fs::write(city.join("buildings.gpkg"), text).unwrap();
        let message = refused(&[
            "render",
            city.to_str().unwrap(),
            "--eye=0,0,900",
            "--look=1,1,0",
            "--size=32x32",
            "--relief=polygons",
            "--out",
            folder.path().join("o.png").to_str().unwrap(),
        ]);
        assert!(message.contains("buildings.gpkg"), "{message}");
    }
}

/// A description of a service that is imported reaches no server either.
#[test]
fn no_server_is_asked() {
    let folder = tempfile::tempdir().unwrap();
    let server = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    server.set_nonblocking(true).unwrap();
    let address = server.local_addr().unwrap();
    for text in [
        format!("<OGRWFSDataSource><URL>http://{address}/wfs</URL></OGRWFSDataSource>"),
        format!(
            "<OGRVRTDataSource><OGRVRTLayer name=\"a\"><SrcDataSource>/vsicurl/http://{address}/a.geojson</SrcDataSource></OGRVRTLayer></OGRVRTDataSource>"
        ),
    ] {
        let path = folder.path().join("service.xml");
        fs::write(&path, text).unwrap();
        let arguments = import_of(&path, &folder.path().join("c"));
        let output = std::process::Command::new(support::PROGRAM)
            .args(&arguments)
            .env("no_proxy", "")
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(1));
        assert!(server.accept().is_err(), "it asked the server");
    }
}

/// A backup that a user keeps beside the city stays; a city's folder may lie where none is yet.
#[test]
fn a_backup_beside_the_city_stays() {
    let folder = tempfile::tempdir().unwrap();
    let city = copied(folder.path());
    let backup = folder.path().join("berlin.previous");
    fs::rename(&city, &backup).unwrap();
    let before = walk(&backup);
    support::succeed(&sample_import(&folder.path().join("berlin")));
    assert_eq!(walk(&backup), before);
    support::succeed(&sample_import(&folder.path().join("berlin")));
    assert_eq!(walk(&backup), before);
    support::succeed(&sample_import(&folder.path().join("new/folder/berlin")));
    assert!(folder.path().join("new/folder/berlin/city.toml").is_file());
    assert!(!folder.path().join("new/folder/berlin/import.cache_key").exists());
}

/// Honest definitions of CRS pass, also when their names read like more.
#[test]
fn honest_crs_are_known() {
    use rilievo::space::Crs;
    for text in [
        "EPSG:25832",
        "IGNF:LAMB93",
        "PROJCRS[\"Airport Extension Grid\",BASEGEOGCRS[\"WGS 84\",ID[\"EPSG\",4326]],REMARK[\"see https://example.org\"]]",
    ] {
        assert!(Crs::is_plain_definition(text), "{text}");
    }
    for text in [
        "BOUNDCRS[SOURCECRS[X],PARAMETERFILE[\"a\",\"/etc/passwd\"]]",
        "PROJCS[\"x\",EXTENSION[\"PROJ4\",\"+proj=utm +nadgrids=/a\"]]",
        "+proj=longlat",
        "http://a/b:1",
        "/tmp/x",
    ] {
        assert!(!Crs::is_plain_definition(text), "{text}");
    }
}

/// A manifest cannot ask for more than an import makes; a tile of another place is none of this one.
#[test]
fn sizes_and_places_are_checked() {
    let folder = tempfile::tempdir().unwrap();
    let city = copied(folder.path());
    let path = city.join("city.toml");
    let manifest = fs::read_to_string(&path).unwrap();
    let line = |key: &str| {
        let begins = format!("{key} = ");
        manifest
            .lines()
            .find(|line| line.starts_with(&begins))
            .unwrap()
            .to_owned()
    };
    for (key, value) in [
        ("columns", "8192"),
        ("rows", "60000"),
        ("terrain_side", "8000"),
        ("photo_side", "8192"),
        ("tile_texels", "1048576"),
        ("building_map_bytes", "9000000000000000000"),
        ("levels", "31"),
        ("terrain_error_m", "inf"),
        ("texel_m", "nan"),
        ("terrain_tiles", "0"),
    ] {
        fs::write(&path, manifest.replace(&line(key), &format!("{key} = {value}"))).unwrap();
        assert!(info(&city).contains("city.toml"), "{key}");
    }
    fs::write(&path, &manifest).unwrap();
    let opened = rilievo::city::City::open(&city).unwrap();
    let tiles: Vec<_> = opened
        .manifest()
        .grid
        .tiles()
        .filter(|&tile| {
            opened.has(rilievo::city::Layer::Terrain, tile)
                && opened.has(rilievo::city::Layer::Buildings, tile)
                && opened.has(rilievo::city::Layer::Imagery, tile)
        })
        .take(2)
        .collect();
    for layer in ["terrain", "buildings", "photo"] {
        let file = |tile: rilievo::space::TileId| city.join(format!("{layer}/0/{}_{}.tif", tile.x, tile.y));
        let (a, b) = (file(tiles[0]), file(tiles[1]));
        let aside = folder.path().join("aside");
        fs::rename(&a, &aside).unwrap();
        fs::rename(&b, &a).unwrap();
        fs::rename(&aside, &b).unwrap();
        let error = opened.tile(tiles[0]).unwrap_err().to_string();
        assert!(error.contains("another place"), "{layer}: {error}");
        fs::rename(&a, &aside).unwrap();
        fs::rename(&b, &a).unwrap();
        fs::rename(&aside, &b).unwrap();
    }
    opened.tile(tiles[0]).unwrap();
}

/// A cut OSM file is no whole one, though its reader says nothing.
#[test]
fn cut_files_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let mut text = "<?xml version='1.0'?>\n<osm version=\"0.6\">\n".to_owned();
    for k in 0..300 {
        let (lat, lon) = (42.0 + 1e-3 * f64::from(k % 20), 12.0 + 1e-3 * f64::from(k / 20));
        for (n, (dy, dx)) in [(0.0, 0.0), (0.0, 2e-4), (2e-4, 2e-4), (2e-4, 0.0)]
            .into_iter()
            .enumerate()
        {
            text += &format!(
                "<node id=\"{}\" lat=\"{}\" lon=\"{}\"/>\n",
                10 * k + n as u32 + 1,
                lat + dy,
                lon + dx
            );
        }
    }
    for k in 0..300 {
        let id = |n: u32| 10 * k + n + 1;
        text += &format!("<way id=\"{}\">", k + 1);
        for n in [0, 1, 2, 3, 0] {
            text += &format!("<nd ref=\"{}\"/>", id(n));
        }
        text += "<tag k=\"building\" v=\"yes\"/></way>\n";
    }
    let cut = folder.path().join("cut.osm");
    fs::write(&cut, &text[..text.len() * 19 / 20]).unwrap();
    let mut arguments = import_of(&cut, &folder.path().join("c"));
    let field = arguments
        .iter()
        .position(|argument| argument == "--height-field")
        .unwrap();
    arguments.drain(field..field + 2);
    let message = refused(&arguments);
    assert!(
        message.contains("cut.osm") && message.contains("damaged or truncated"),
        "{message}"
    );
}

/// A resume trusts what its sources hold: a member of a mosaic that changed begins it again.
#[test]
fn every_file_of_a_source_is_known() {
    let folder = tempfile::tempdir().unwrap();
    let terrain = folder.path().join("in.tif");
    fs::copy(sample().join("files/terrain.tif"), &terrain).unwrap();
    let inner = folder.path().join("inner.vrt");
    let outer = folder.path().join("outer.vrt");
    let vrt = |of: &str| {
        format!(
            "<VRTDataset rasterXSize=\"4\" rasterYSize=\"4\"><VRTRasterBand dataType=\"Float32\" band=\"1\"><SimpleSource><SourceFilename relativeToVRT=\"1\">{of}</SourceFilename><SourceBand>1</SourceBand></SimpleSource></VRTRasterBand></VRTDataset>"
        )
    };
    fs::write(&inner, vrt("in.tif")).unwrap();
    fs::write(&outer, vrt("inner.vrt")).unwrap();
    fs::write(folder.path().join("in.tif.aux.xml"), "<PAMDataset/>").unwrap();
    let files: Vec<PathBuf> = rilievo::source::files_of(&outer).into_iter().collect();
    for file in [&inner, &outer, &terrain] {
        assert!(
            files.iter().any(|known| known.file_name() == file.file_name()),
            "{file:?}: {files:?}"
        );
    }
    // A long comment first, and names of GDAL's for parts of files.
    let commented = folder.path().join("commented.vrt");
    fs::write(&commented, format!("<!--{}-->{}", "x".repeat(700), vrt("in.tif"))).unwrap();
    let part = |name: String| rilievo::source::files_of(Path::new(&name));
    for files in [
        rilievo::source::files_of(&commented),
        part(format!("vrt://{}?bands=1", terrain.display())),
    ] {
        let is_known = files.iter().any(|file| file.file_name() == terrain.file_name());
        assert!(is_known, "{files:?}");
    }
    let zipped = folder.path().join("z.zip");
    fs::write(&zipped, "PK").unwrap();
    assert!(part(format!("/vsizip/{}/in.tif", zipped.display())).contains(&zipped));
    // A data file beside its header.
    let header = folder.path().join("m.ers");
    fs::write(folder.path().join("m"), vec![0_u8; 64]).unwrap();
    fs::write(
        &header,
        "DatasetHeader Begin\n\tVersion = \"6.0\"\n\tDataFile = \"m\"\n\tDataSetType = ERStorage\n\tDataType = Raster\n\tByteOrder = LSBFirst\n\tRasterInfo Begin\n\t\tCellType = IEEE4ByteReal\n\t\tNrOfLines = 4\n\t\tNrOfCellsPerLine = 4\n\t\tNrOfBands = 1\n\tRasterInfo End\nDatasetHeader End\n",
    )
    .unwrap();
    let files = rilievo::source::files_of(&header);
    assert!(files.contains(&folder.path().join("m")), "{files:?}");
    let of_terrain = rilievo::source::files_of(&terrain);
    assert!(
        of_terrain.contains(&folder.path().join("in.tif.aux.xml")),
        "{of_terrain:?}"
    );
    let of_folder = rilievo::source::files_of(folder.path());
    assert!(of_folder.len() >= 4, "{of_folder:?}");
}

/// Work that no machine can do is refused before it begins.
#[test]
fn lenses_ask_for_bounded_work() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("f.png");
    let message = refused(&[
        "lens",
        "flare",
        "canon",
        "--angle=5,0",
        "--f-number=8",
        "--mode=exact",
        "--rays=512",
        "--wavelengths=64",
        "--size=64x48",
        "--out",
        out.to_str().unwrap(),
    ]);
    assert!(message.contains("million rays"), "{message}");
    let message = refused(&[
        "lens",
        "flare",
        "heliar",
        "--angle=5,0",
        "--f-number=1",
        "--out",
        out.to_str().unwrap(),
    ]);
    assert!(message.contains("does not open to f/1"), "{message}");
    let heliar = support::succeed(&["lens", "show", "heliar", "--toml"]);
    let path = folder.path().join("l.toml");
    for (from, to) in [
        ("semi_diameter = 14.5", "semi_diameter = 1e12"),
        ("thickness = 7.7", "thickness = -1e300"),
        ("film_mm = [36.0, 24.0]", "film_mm = [nan, 24.0]"),
        ("index = 1.38", "index = -4.0"),
    ] {
        let changed = heliar.replace(from, to);
        assert!(changed != heliar, "{from}");
        fs::write(&path, changed).unwrap();
        let message = refused(&[
            "lens",
            "diagram",
            path.to_str().unwrap(),
            "--out",
            out.to_str().unwrap(),
        ]);
        assert!(message.contains("l.toml"), "{message}");
    }
    #[cfg(unix)]
    refused(&["lens", "show", "/dev/zero"]);
}

/// What is written lies in no city's folder and over none of what is read, whatever it is.
#[test]
fn nothing_is_written_among_a_citys_files() {
    let folder = tempfile::tempdir().unwrap();
    let city = copied(folder.path());
    let before = walk(&city);
    let inside = |name: &str| city.join(name).display().to_string();
    let view = [
        "--eye=288900,4772600,400",
        "--look=289180,4773000,215",
        "--size=32x32",
    ];
    let name = city.display().to_string();
    for out in ["terrain/0/0_0.tif", "new.png", "photo/x.exr"] {
        let out = inside(out);
        let mut arguments = vec!["render", &name];
        arguments.extend(view);
        arguments.extend(["--out", &out]);
        let message = refused(&arguments);
        assert!(message.contains("lies in the folder of the city"), "{message}");
    }
    #[cfg(unix)]
    {
        let link = folder.path().join("link.png");
        std::os::unix::fs::symlink(city.join("city.toml"), &link).unwrap();
        let link = link.display().to_string();
        let mut arguments = vec!["render", &name];
        arguments.extend(view);
        arguments.extend(["--out", &link]);
        assert!(refused(&arguments).contains("lies in the folder of the city"));
    }
    let svg = inside("lens.svg");
    assert!(refused(&["lens", "diagram", "tessar", "--out", &svg]).contains("city"));
    for out in ["inner", "terrain/inner"] {
        let message = refused(&sample_import(&city.join(out)));
        assert!(message.contains("lies in the folder of the city"), "{message}");
    }
    assert!(refused(&["sample", &name]).contains("lies in the folder of the city"));
    assert!(
        refused(&[
            "lens",
            "bake",
            "tessar",
            "--f-number=8",
            "--out",
            &inside("t.flare")
        ])
        .contains("city")
    );
    assert_eq!(walk(&city), before);

    let file = folder.path().join("file");
    fs::write(&file, "x").unwrap();
    assert!(refused(&sample_import(&file)).contains("is not a city"));
    let lens = folder.path().join("l.toml");
    fs::write(&lens, support::succeed(&["lens", "show", "tessar", "--toml"])).unwrap();
    let text = fs::read(&lens).unwrap();
    let name = lens.display().to_string();
    let message = refused(&["lens", "bake", &name, "--f-number=8", "--out", &name]);
    assert!(message.contains("written over"), "{message}");
    assert_eq!(fs::read(&lens).unwrap(), text);
}

/// A footprint dataset holds its features itself: no view, which may run without end, and no virtual table, which reads other files.
#[test]
fn a_footprint_dataset_holds_its_features() {
    let folder = tempfile::tempdir().unwrap();
    let text = folder.path().join("other.csv");
    fs::write(&text, "a,b\n1,2\n").unwrap();
    let virtual_table = |sql: &str| {
        format!(
            "PRAGMA writable_schema = 1; DELETE FROM sqlite_master WHERE name = 'buildings' OR type = 'trigger';
             INSERT INTO sqlite_master (type, name, tbl_name, rootpage, sql) VALUES ('table', 'buildings', 'buildings', 0, '{}');",
            sql.replace('\'', "''")
        )
    };
    let path = text.display();
    for change in [
        "ALTER TABLE buildings RENAME TO b; CREATE VIEW buildings AS SELECT * FROM b;".to_owned(),
        "ALTER TABLE buildings RENAME TO b; CREATE VIEW buildings AS
         WITH RECURSIVE c(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM c) SELECT b.* FROM b, c;"
            .to_owned(),
        "ALTER TABLE gpkg_contents RENAME TO c; CREATE VIEW gpkg_contents AS
         WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n) SELECT c.* FROM c, n;"
            .to_owned(),
        "ALTER TABLE buildings ADD COLUMN more AS (hex(zeroblob(300000000)));".to_owned(),
        "CREATE TRIGGER rtree_more AFTER DELETE ON buildings BEGIN DELETE FROM buildings WHERE fid > 2; END;".to_owned(),
        "CREATE TRIGGER more AFTER UPDATE ON gpkg_ogr_contents BEGIN DELETE FROM buildings; END;".to_owned(),
        virtual_table(&format!("CREATE VIRTUAL TABLE buildings USING VirtualText('{path}', 'UTF-8', 0, COMMA)")),
        virtual_table(&format!("CREATE VIRTUAL TABLE buildings USING VirtualOGR('{path}')")),
        format!(
            "PRAGMA writable_schema = 1;
             INSERT INTO sqlite_master (type, name, tbl_name, rootpage, sql)
             VALUES ('table', 'aside', 'aside', 0, 'CREATE VIRTUAL TABLE aside USING VirtualShape(''{path}'', ''UTF-8'', 4326)');"
        ),
    ] {
        let city = copied(&folder.path().join(format!("c{}", change.len())));
        let dataset = city.join("buildings.gpkg");
        rusqlite::Connection::open(&dataset)
            .unwrap()
            .execute_batch(&change)
            .unwrap();
        let message = refused(&["update", city.to_str().unwrap()]);
        assert!(
            [
                "not a table",
                "could read other files",
                "generated, not stored",
                "more than keep index and count",
            ]
            .iter()
            .any(|why| message.contains(why)),
            "{message}"
        );
    }
}

/// A table of text that was cut is refused, wherever it was cut; a whole one is not, however it is quoted.
#[test]
fn cut_tables_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let whole: String = (0..200)
        .map(|k| {
            let (x, y) = (288_900 + 10 * (k % 20), 4_772_600 + 10 * (k / 20));
            format!(
                "\"POLYGON (({x} {y},{} {y},{} {},{x} {y}))\";\"a \"\"b\"\" {k}\";{}.5\n",
                x + 8,
                x + 8,
                y + 8,
                5 + k % 7
            )
        })
        .collect();
    let import = |text: String| {
        let path = folder.path().join("b.csv");
        fs::write(&path, text).unwrap();
        let mut arguments = import_of(&path, &folder.path().join("c"));
        let photo = arguments
            .iter()
            .position(|argument| argument == "--photo")
            .unwrap();
        arguments.drain(photo..photo + 5);
        arguments.extend(["--buildings-crs".to_owned(), "EPSG:25833".to_owned()]);
        arguments
    };
    let header = "WKT;note;height_m\n";
    support::succeed(&import(format!("{header}{whole}")));
    support::succeed(&import(format!("{header}{}", whole.trim_end())));
    let row = whole.lines().next_back().unwrap();
    let end = whole.len() - row.len() - 1;
    for left in [4, 30, row.find(";").unwrap(), row.len() - 8, row.len() - 5] {
        let message = refused(&import(format!("{header}{}", &whole[..end + left])));
        assert!(message.contains("damaged or truncated"), "{left}: {message}");
    }
}
