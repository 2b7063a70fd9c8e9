//! Catalogue glasses of six makers: `data/glasses.csv`, whose origin stands in its head and in `data/README.md`.

use std::sync::OnceLock;

use serde::Deserialize;

use super::glass::{D_LINE_UM, Dispersion, Glass};

/// A glass of a maker.
#[derive(Clone, Debug)]
pub struct Entry {
    /// The maker, in capitals.
    pub catalogue: String,
    /// As the maker writes it.
    pub name: String,
    /// Published index at the d line.
    pub n_d: f64,
    /// Its equation.
    pub dispersion: Dispersion,
}

#[derive(Deserialize)]
struct Row {
    catalogue: String,
    name: String,
    formula: u32,
    n_d: f64,
    coefficients: String,
}

const TABLE: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/data/glasses.csv"));

/// All of them.
pub fn glasses() -> &'static [Entry] {
    static GLASSES: OnceLock<Vec<Entry>> = OnceLock::new();
    GLASSES.get_or_init(|| {
        let mut reader = csv::ReaderBuilder::new()
            .comment(Some(b'#'))
            .from_reader(TABLE.as_bytes());
        // A row that cannot be read is found by the test below.
        reader
            .deserialize::<Row>()
            .filter_map(|row| entry(row.ok()?))
            .collect()
    })
}

fn entry(row: Row) -> Option<Entry> {
    let numbers: Option<Vec<f64>> = row
        .coefficients
        .split(' ')
        .map(|word| word.parse().ok())
        .collect();
    let (&constant, rest) = numbers.as_deref()?.split_first()?;
    let pairs = rest.as_chunks::<2>().0.to_vec();
    let dispersion = match row.formula {
        2 => Dispersion::Sellmeier {
            constant: 1.0 + constant,
            terms: pairs,
        },
        3 => Dispersion::Powers {
            constant,
            terms: pairs,
        },
        _ => return None,
    };
    Some(Entry {
        catalogue: row.catalogue,
        name: row.name,
        n_d: row.n_d,
        dispersion,
    })
}

fn plain(name: &str) -> String {
    name.to_uppercase().replace(['-', ' ', '_'], "")
}

/// A glass by name, hyphens or not. Where several makers have one of that name: of the first of `catalogues` that does, else
/// the one whose index is nearest to `n_d`, else the first of the table. A name that no maker has may lack the N of
/// lead-free glass.
pub fn find(name: &str, catalogues: &[&str], n_d: Option<f64>) -> Option<Glass> {
    let named = |wanted: String| -> Vec<&'static Entry> {
        let is_it = |entry: &&Entry| plain(&entry.name) == wanted;
        glasses().iter().filter(is_it).collect()
    };
    let wanted = plain(name);
    let mut found = named(wanted.clone());
    if found.is_empty() {
        found = named(format!("N{wanted}"));
    }
    let of_catalogue = catalogues.iter().find_map(|catalogue| {
        found
            .iter()
            .find(|entry| entry.catalogue == catalogue.to_uppercase())
    });
    let entry = match (of_catalogue, n_d) {
        (Some(entry), _) => entry,
        (None, Some(n_d)) => found
            .iter()
            .min_by(|a, b| (a.n_d - n_d).abs().total_cmp(&(b.n_d - n_d).abs()))?,
        (None, None) => found.first()?,
    };
    Some(Glass::Catalogue {
        name: entry.name.clone(),
        dispersion: entry.dispersion.clone(),
        offset: 0.0,
    })
}

/// A named glass. Of stated index: where a catalogue knows it, its dispersion through the stated n_d, else by index and
/// dispersion alone. Without: the catalogue's.
///
/// # Errors
/// A sentence, for a name in no catalogue without an index.
pub fn named(name: &str, n_d: Option<f64>, v_d: f64) -> Result<Glass, String> {
    match (find(name, &[], n_d), n_d) {
        (Some(glass), Some(n_d)) if (glass.index(D_LINE_UM) - n_d).abs() < 1e-3 => Ok(glass.with_index(n_d)),
        (_, Some(n_d)) => Ok(Glass::model(n_d, v_d)),
        (Some(glass), None) => Ok(glass),
        (None, None) => Err(format!(
            "the glass {name} is in no catalogue here; write its n_d and V_d beside it"
        )),
    }
}

/// Whether a glass is of one of some makers.
pub fn is_of(glass: &Glass, catalogues: &[&str]) -> bool {
    let is_it = |entry: &Entry| glass.name() == Some(&entry.name) && glass.is_by(&entry.dispersion);
    let is_theirs = |entry: &&Entry| {
        catalogues
            .iter()
            .any(|maker| entry.catalogue == maker.to_uppercase())
    };
    glasses().iter().filter(is_theirs).any(is_it)
}

/// Whether a maker of that name is in the table.
pub fn has_catalogue(name: &str) -> bool {
    glasses()
        .iter()
        .any(|entry| entry.catalogue == name.to_uppercase())
}

/// A glass by a code of six digits, `620603`, or with a point between those of n_d - 1 and those of V_d, `516800.641673`.
pub fn from_code(code: &str) -> Option<Glass> {
    if !code.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.') {
        return None;
    }
    let (index, abbe) = match code.split_once('.') {
        Some((index, abbe)) => (index, abbe),
        None if code.len() == 6 => code.split_at(3),
        None => return None,
    };
    if abbe.len() < 2 || index.len() < 3 {
        return None;
    }
    let n_d: f64 = format!("1.{index}").parse().ok()?;
    let v_d: f64 = format!("{}.{}", &abbe[..2], &abbe[2..]).parse().ok()?;
    Some(Glass::model(n_d, v_d))
}

/// Whether an index and an Abbe number are what Zemax writes where it knows none.
pub fn is_placeholder(n_d: f64, v_d: f64) -> bool {
    n_d == 1.5 && v_d == 40.0 || n_d <= 0.0
}

#[cfg(test)]
mod tests {
    use super::{D_LINE_UM, TABLE, find, glasses};

    #[test]
    fn coefficients_give_the_published_index() {
        let lines = TABLE.lines().filter(|line| !line.starts_with('#')).count();
        assert_eq!(glasses().len(), lines - 1, "a row could not be read");
        for entry in glasses() {
            let glass = find(&entry.name, &[&entry.catalogue], None);
            let index = glass.map(|glass| glass.index(D_LINE_UM));
            // One maker publishes four digits.
            assert!(
                index.is_some_and(|index| (index - entry.n_d).abs() < 4e-5),
                "{} {}: {index:?}, published {}",
                entry.catalogue,
                entry.name,
                entry.n_d
            );
        }
    }

    #[test]
    fn makers_and_indices_tell_glasses_of_one_name_apart() {
        let index =
            |catalogues: &[&str], n_d| find("F2", catalogues, n_d).map(|glass| glass.index(D_LINE_UM));
        let near = |value: Option<f64>, wanted: f64| value.is_some_and(|value| (value - wanted).abs() < 2e-5);
        assert!(near(index(&["SCHOTT"], None), 1.62004));
        assert!(near(index(&["CDGM"], None), 1.61293));
        assert!(near(index(&[], Some(1.61293)), 1.61293));
    }
}
