//! Which triggers of a GeoPackage do no more than keep its spatial index and its count of features, as GDAL writes them after the
//! standard (OGC 12-128r18, annex F.3): a change of a footprint runs them.

/// All words of such triggers but names with a table in them, in lower case. None of them reads another row, and without others no
/// function can be called that takes long.
const WORDS: [&str; 50] = [
    "create",
    "temp",
    "trigger",
    "if",
    "not",
    "exists",
    "before",
    "after",
    "insert",
    "update",
    "delete",
    "of",
    "on",
    "for",
    "each",
    "row",
    "when",
    "begin",
    "end",
    "or",
    "and",
    "replace",
    "into",
    "values",
    "from",
    "where",
    "set",
    "in",
    "is",
    "null",
    "notnull",
    "isnull",
    "new",
    "old",
    "id",
    "fid",
    "ogc_fid",
    "geom",
    "geometry",
    "the_geom",
    "st_isempty",
    "st_minx",
    "st_maxx",
    "st_miny",
    "st_maxy",
    "minx",
    "maxx",
    "miny",
    "maxy",
    "lower",
];
/// The table of the count, and its columns.
const COUNT: [&str; 3] = ["gpkg_ogr_contents", "feature_count", "table_name"];
/// How the names of a spatial index and of a counting trigger begin.
const NAMES: [&str; 3] = [
    "rtree_",
    "trigger_insert_feature_count_",
    "trigger_delete_feature_count_",
];

/// Whether a table can be written to by a trigger of those words, or by a change of the layer, which writes to `written`.
pub fn is_reachable(table: &str, written: &[&str]) -> bool {
    let table = table.to_lowercase();
    written.contains(&table.as_str()) || is_known(&table)
}

/// Whether a trigger has those words alone, and its statements do not name the layer but to find its count.
pub fn is_own_trigger(sql: &str, layer: &str) -> bool {
    let sql = sql.to_lowercase();
    let words: Vec<&str> = sql
        .split(|letter: char| !(letter.is_alphanumeric() || letter == '_'))
        .filter(|word| !word.is_empty())
        .collect();
    let Some(begin) = words.iter().position(|word| *word == "begin") else {
        return false;
    };
    let is_number = |word: &str| word.bytes().all(|byte| byte.is_ascii_digit());
    let all_known = words
        .iter()
        .all(|word| *word == layer || is_known(word) || is_number(word));
    let leaves_layer = words[begin..]
        .windows(2)
        .all(|pair| pair[1] != layer || pair[0] == "lower");
    // `x IN name` would read all of a table or view.
    let reads_none = sql.match_indices("in").all(|(at, word)| {
        let is_letter = |letter: char| letter.is_alphanumeric() || letter == '_';
        let (before, after) = (&sql[..at], &sql[at + word.len()..]);
        let is_word = !before.ends_with(is_letter) && !after.starts_with(is_letter);
        !is_word || after.trim_start().starts_with('(')
    });
    let has_comment = sql.contains("--") || sql.contains("/*");
    all_known && leaves_layer && reads_none && !has_comment
}

fn is_known(word: &str) -> bool {
    WORDS.contains(&word) || COUNT.contains(&word) || NAMES.iter().any(|start| word.starts_with(start))
}

#[cfg(test)]
mod tests {
    use super::{is_own_trigger, is_reachable};

    #[test]
    fn triggers_that_keep_index_and_count_are_told_from_others() {
        let own = [
            r#"CREATE TRIGGER "rtree_buildings_geom_insert" AFTER INSERT ON "buildings" WHEN (new."geom" NOT NULL AND NOT ST_IsEmpty(NEW."geom")) BEGIN INSERT OR REPLACE INTO "rtree_buildings_geom" VALUES (NEW."fid",ST_MinX(NEW."geom"), ST_MaxX(NEW."geom"),ST_MinY(NEW."geom"), ST_MaxY(NEW."geom")); END"#,
            r#"CREATE TRIGGER "rtree_buildings_geom_update4" AFTER UPDATE ON "buildings" WHEN OLD."fid" != NEW."fid" AND (NEW."geom" ISNULL OR ST_IsEmpty(NEW."geom")) BEGIN DELETE FROM "rtree_buildings_geom" WHERE id IN (OLD."fid", NEW."fid"); END"#,
            r#"CREATE TRIGGER "trigger_insert_feature_count_buildings" AFTER INSERT ON "buildings" BEGIN UPDATE gpkg_ogr_contents SET feature_count = feature_count + 1 WHERE lower(table_name) = lower('buildings'); END"#,
        ];
        for sql in own {
            assert!(is_own_trigger(sql, "buildings"), "{sql}");
        }
        let begun = r#"CREATE TRIGGER "rtree_buildings_geom_delete" AFTER DELETE ON "buildings" "#;
        for body in [
            "BEGIN DELETE FROM buildings WHERE fid > 2; END",
            "BEGIN UPDATE OR REPLACE buildings SET geom = NULL; END",
            "BEGIN INSERT INTO rtree_more VALUES (randomblob(900000000)); END",
            "BEGIN INSERT INTO rtree_more SELECT 1; END",
            "WHEN (SELECT count(*) FROM buildings) BEGIN DELETE FROM rtree_more; END",
            r#"BEGIN INSERT INTO rtree_more VALUES ("zeroblob"(1000000000)); END"#,
            "BEGIN DELETE FROM gpkg_contents; END",
            "BEGIN DELETE FROM rtree_buildings_geom WHERE old.fid IN rtree_v; END",
            "BEGIN DELETE FROM rtree_buildings_geom WHERE id = 1 /* '; END",
        ] {
            assert!(!is_own_trigger(&format!("{begun}{body}"), "buildings"), "{body}");
        }
        let written = ["buildings", "gpkg_contents"];
        assert!(is_reachable("Buildings", &written) && is_reachable("gpkg_ogr_contents", &written));
        assert!(is_reachable("gpkg_contents", &written) && !is_reachable("roads", &written));
        assert!(!is_reachable("gpkg_tile_matrix", &written));
    }
}
