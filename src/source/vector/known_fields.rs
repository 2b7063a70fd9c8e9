//! Names of attributes that are known to give a building's height, with the publisher that defines them. Best first: heights
//! that are measured before heights that are estimated, heights before storeys.
//!
//! Names are compared without case, and `:`, `-`, `.` and blanks count as `_`; a Shapefile's ten characters are names of
//! their own.

use super::footprint_source::FootprintSource;
use crate::source::height_text::FOOT_M;
use crate::source::{HeightField, HeightReading, HeightRule, SourceError};

/// What a known name means.
enum Known {
    /// Height above ground, metres (or the unit that the name ends in).
    Metres,
    /// Height above ground, feet.
    Feet,
    /// Elevation of the roof; the ground's is in the field of this name.
    RoofAbove(&'static str),
    /// Number of storeys; and where more of them are counted.
    Storeys(Option<&'static str>),
}

use Known::{Feet, Metres, RoofAbove, Storeys};

/// What the names mean and who says so.
const KNOWN: &[(Known, &[&str])] = &[
    // Made from the model's own vertices by this program (`cityjson`).
    (Metres, &[super::cityjson::GEOMETRY_HEIGHT]),
    // OGC CityGML 2.0 (12-019), 10.3.3, class _AbstractBuilding; 3DCityDB's column; CityJSON; PLATEAU; LoD1-DE.
    (Metres, &["measuredHeight", "measured_height", "measuredHe"]),
    // Ordnance Survey MasterMap Building Height Attribute: relative heights, to the highest part and to the roof's base.
    (Metres, &["RelHMax", "rel_h_max", "RelH2", "rel_h2"]),
    // IGN BD TOPO 2 and 3, BATIMENT: "hauteur du bâtiment mesurée entre le sol et la gouttière".
    (Metres, &["HAUTEUR"]),
    // swisstopo swissBUILDINGS3D 3.0: from the lowest ground to the highest roof.
    (Metres, &["GESAMTHOEHE"]),
    // Catalogo dei dati territoriali (DM 10.11.2011), UN_VOL: altezza del volume.
    (Metres, &["UN_VOL_AV"]),
    // NYC Open Data, Building Footprints: height of the roof above the ground, feet.
    (Feet, &["heightroof", "height_roof"]),
    // City of The Hague, 3D city model: ridge above ground, then eaves.
    (Metres, &["RelativeRidgeHeight", "RelativeEavesHeight"]),
    // INSPIRE Data Specification on Buildings 3.0, HeightAboveGround, as flat columns.
    (Metres, &["heightAboveGround", "height_above_ground"]),
    // OpenStreetMap Key:height; Overture and Microsoft buildings (-1 = unknown); Geoclimate's copy of BD TOPO.
    (Metres, &["height", "building:height", "building_h"]),
    // The same under the names that exports and cadastres give it.
    (
        Metres,
        &[
            "bldg_height",
            "bldgheight",
            "bldg_heigh",
            "bld_height",
            "bldheight",
            "height_",
            "hgt",
            "bldg_hgt",
            "bld_hgt",
            "hoehe",
            "höhe",
            "altura",
        ],
    ),
    // Nearmap, Google Open Buildings 2.5D and others who name the unit alone differently.
    (Metres, &["building_height"]),
    // 3DBAG (TU Delft): roof at 70 % of its heights, and the ground, NAP; names before and after 2023.
    (RoofAbove("b3_h_maaiveld"), &["b3_h_dak_70p"]),
    (RoofAbove("h_maaiveld"), &["h_dak_70p"]),
    // AdV LoD2-DE and LoD2 of the Länder: elevations of the roof and of the lowest ground.
    (RoofAbove("HoeheGrund"), &["HoeheDach"]),
    // IGN BD TOPO 3: elevation of the gutter and of the ground, where HAUTEUR is 0.
    (RoofAbove("Z_MIN_SOL"), &["Z_MIN_TOIT"]),
    // OpenStreetMap Key:est_height.
    (Metres, &["est_height"]),
    // OpenStreetMap Key:building:levels, which leaves out the storeys under the roof; and its Shapefile forms.
    (
        Storeys(Some("roof:levels")),
        &["building:levels", "building:l", "building:le", "building:lev"],
    ),
    // CityGML 2.0 and AdV; 3DCityDB's column.
    (
        Storeys(None),
        &["storeysAboveGround", "storeys_above_ground", "storeysAbo"],
    ),
    // INSPIRE Buildings 3.0; Dirección General del Catastro.
    (
        Storeys(None),
        &["numberOfFloorsAboveGround", "number_of_floors_above_ground"],
    ),
    // ALKIS: Anzahl der oberirdischen Geschosse.
    (Storeys(None), &["AnzahlDerOberirdischenGeschosse", "aog"]),
    // IGN BD TOPO 3, columns of the GeoPackage and of the Shapefile.
    (Storeys(None), &["nombre_d_etages", "NB_ETAGES", "nombre_d_e"]),
    // Overture buildings schema.
    (Storeys(None), &["num_floors"]),
    // NYC PLUTO and other cadastres of the United States.
    (
        Storeys(None),
        &["numfloors", "num_stories", "no_stories", "stories"],
    ),
    // 3DBAG.
    (Storeys(None), &["b3_bouwlagen"]),
    // Swiss GWR: Anzahl Geschosse.
    (Storeys(None), &["GASTW"]),
    // Korean road-name address map (TL_SPBD_BULD): storeys above ground.
    (Storeys(None), &["GRO_FLO_CO"]),
    // Chinese city vectors (AutoNavi, Baidu), and plain words for storeys.
    (Storeys(None), &["floor", "floors", "storeys", "levels"]),
    // OpenMapTiles schema, layer building: from height and levels, with 5 where neither is known.
    (Metres, &["render_height"]),
];

/// Keys that OSM's `other_tags` may hold.
const OSM_KEYS: [&str; 4] = ["height", "building:height", "est_height", "building:levels"];

/// Units that a name may end in, and their metres.
const NAME_UNITS: [(&str, f64); 6] = [
    ("_m", 1.0),
    ("_metres", 1.0),
    ("_meters", 1.0),
    ("_ft", FOOT_M),
    ("_feet", FOOT_M),
    ("_foot", FOOT_M),
];

impl FootprintSource {
    /// The fields of the layer whose names are known to give heights, best first; the default height when there are none.
    ///
    /// # Errors
    /// When the layer's definition cannot be read.
    pub fn known_height_rule(&self, storey_height_m: f64) -> Result<HeightRule, SourceError> {
        let fields = known_fields(&self.field_names()?, storey_height_m);
        Ok(if fields.is_empty() {
            HeightRule::Default
        } else {
            HeightRule::KnownFields { fields }
        })
    }
}

/// The known ones among a layer's fields, best first.
fn known_fields(names: &[String], storey_height_m: f64) -> Vec<HeightField> {
    let has_tags = names.iter().any(|name| name == super::heights::OTHER_TAGS);
    let find = |wanted: &str| {
        let wanted = plain(wanted);
        let column = names.iter().find(|name| plain(name) == wanted);
        let tag = || {
            OSM_KEYS
                .iter()
                .chain(&["roof:levels"])
                .find(|key| has_tags && plain(key) == wanted)
                .map(|key| (*key).to_owned())
        };
        column.cloned().or_else(tag)
    };
    let mut fields: Vec<HeightField> = Vec::new();
    for (known, spellings) in KNOWN {
        for spelling in *spellings {
            let found: Vec<(String, Option<f64>)> = match known {
                Metres | Feet => with_units(names, spelling)
                    .chain(find(spelling).map(|name| (name, None)))
                    .collect(),
                RoofAbove(_) | Storeys(_) => find(spelling).map(|name| (name, None)).into_iter().collect(),
            };
            for (field, unit_m) in found {
                let reading = match known {
                    Metres => HeightReading::Height {
                        unit_m: unit_m.unwrap_or(1.0),
                    },
                    Feet => HeightReading::Height {
                        unit_m: unit_m.unwrap_or(FOOT_M),
                    },
                    Storeys(plus) => HeightReading::Storeys {
                        plus: plus.and_then(find),
                        storey_height_m,
                    },
                    RoofAbove(ground) => match find(ground) {
                        Some(ground) => HeightReading::RoofLessGround { ground },
                        None => continue,
                    },
                };
                if fields.iter().all(|known| known.field != field) {
                    fields.push(HeightField { field, reading });
                }
            }
        }
    }
    fields
}

/// Fields that are a spelling with a unit behind it, and the unit's metres.
fn with_units(names: &[String], spelling: &str) -> impl Iterator<Item = (String, Option<f64>)> {
    names.iter().filter_map(move |name| {
        let rest = plain(name);
        let unit = rest.strip_prefix(&plain(spelling))?;
        let (_, metres) = NAME_UNITS.iter().find(|(ending, _)| *ending == unit)?;
        Some((name.clone(), Some(*metres)))
    })
}

/// A name without case and with one kind of separator.
pub(super) fn plain(name: &str) -> String {
    name.trim().to_lowercase().replace([':', '-', '.', ' '], "_")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(names: &[&str]) -> Vec<String> {
        let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
        let fields = known_fields(&names, 3.2);
        fields.iter().map(ToString::to_string).collect()
    }

    #[test]
    fn publishers_fields_are_known() {
        for (publisher, names, expected) in [
            (
                "BD TOPO 2",
                &["ID", "z_min", "hauteur"][..],
                &["\"hauteur\" (metres)"][..],
            ),
            (
                "BD TOPO 3",
                &["NB_ETAGES", "HAUTEUR", "Z_MIN_SOL", "Z_MIN_TOIT"],
                &[
                    "\"HAUTEUR\" (metres)",
                    "\"Z_MIN_TOIT\" - \"Z_MIN_SOL\" (metres)",
                    "\"NB_ETAGES\" x 3.2 m",
                ],
            ),
            ("NYC", &["heightroof", "groundelev"], &["\"heightroof\" (feet)"]),
            (
                "named unit",
                &["height_ft", "hgt_m"],
                &["\"height_ft\" (feet)", "\"hgt_m\" (metres)"],
            ),
            (
                "Overture",
                &["num_floors", "height"],
                &["\"height\" (metres)", "\"num_floors\" x 3.2 m"],
            ),
            (
                "OSM table",
                &["Building:Levels", "roof:levels"],
                &["\"Building:Levels\" (+ \"roof:levels\") x 3.2 m"],
            ),
            ("Shapefile of OSM", &["building_l"], &["\"building_l\" x 3.2 m"]),
            (
                "3DBAG",
                &["b3_h_dak_70p", "b3_h_maaiveld"],
                &["\"b3_h_dak_70p\" - \"b3_h_maaiveld\" (metres)"],
            ),
            ("half a pair", &["b3_h_dak_70p"], &[]),
            ("absolute heights", &["AbsHMax", "AbsH2", "z_max"], &[]),
            (
                "MasterMap",
                &["AbsHMax", "RelH2", "RelHMax"],
                &["\"RelHMax\" (metres)", "\"RelH2\" (metres)"],
            ),
            (
                "nothing",
                &["maxheight", "level", "height_source", "roof:height"],
                &[],
            ),
        ] {
            assert_eq!(said(names), expected, "{publisher}");
        }
        let osm = said(&["osm_id", "other_tags"]);
        assert_eq!(osm.len(), 4, "{osm:?}");
        assert_eq!(osm[3], "\"building:levels\" (+ \"roof:levels\") x 3.2 m");
    }
}
