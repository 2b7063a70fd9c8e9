//! What a city holds, to compare two of them: tiles byte for byte, the footprint dataset feature for feature.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use gdal::Dataset;
use gdal::vector::LayerAccess;
use rilievo::city::City;

use super::{import_arguments, sample, succeed, walk};

/// A footprint as the dataset holds it: rings of points, and its attributes as text.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    pub wkb: Vec<u8>,
    pub fields: BTreeMap<String, Option<String>>,
}

pub fn records(path: &Path) -> BTreeMap<u64, Record> {
    let dataset = Dataset::open(path).unwrap();
    let mut layer = dataset.layer(0).unwrap();
    let names: Vec<String> = layer.defn().fields().map(|field| field.name()).collect();
    layer
        .features()
        .map(|feature| {
            let fields = (0..names.len()).map(|k| (names[k].clone(), feature.field_as_string(k).unwrap()));
            let record = Record {
                wkb: feature.geometry().unwrap().wkb().unwrap(),
                fields: fields.collect(),
            };
            (feature.fid().unwrap(), record)
        })
        .collect()
}

pub fn tiles(city: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    ["terrain", "buildings", "photo"]
        .iter()
        .flat_map(|layer| walk(&city.join(layer)))
        .map(|path| {
            (
                path.strip_prefix(city).unwrap().to_owned(),
                fs::read(&path).unwrap(),
            )
        })
        .collect()
}

/// The city is the one that an import of its own dataset on the same terrain gives.
pub fn is_a_fresh_import(city: &Path, folder: &Path) {
    let fresh = folder.join("fresh");
    let dataset = folder.join("dataset.gpkg");
    fs::copy(city.join("buildings.gpkg"), &dataset).unwrap();
    let mut arguments = import_arguments(&sample().join("files"), &fresh);
    let place = arguments
        .iter()
        .position(|argument| argument == "--buildings")
        .unwrap();
    arguments[place + 1] = dataset.display().to_string();
    succeed(&arguments);
    let (updated, imported) = (tiles(city), tiles(&fresh));
    assert_eq!(
        updated.keys().collect::<Vec<_>>(),
        imported.keys().collect::<Vec<_>>()
    );
    for (path, bytes) in &updated {
        assert!(*bytes == imported[path], "{} differs", path.display());
    }
    assert_eq!(
        records(&city.join("buildings.gpkg")),
        records(&fresh.join("buildings.gpkg"))
    );
    let (updated, imported) = (City::open(city).unwrap(), City::open(&fresh).unwrap());
    let figures = |city: &City| {
        let manifest = city.manifest();
        [
            manifest.buildings,
            manifest.building_tiles,
            manifest.building_map_bytes,
            manifest.triangle_bytes,
            manifest.footprints.kept,
        ]
    };
    assert_eq!(figures(&updated), figures(&imported));
    updated.require_all_tiles().unwrap();
    fs::remove_dir_all(&fresh).unwrap();
}
