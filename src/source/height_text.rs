//! Heights and storeys as people write them: `12`, `12.5 m`, `12,5`, `40 ft`, `12 ft 6 in`, `40'6"`, `3 storeys`.

/// Metres in a foot.
pub const FOOT_M: f64 = 0.3048;

/// What may stand behind a length, and its metres.
const LENGTH_UNITS: [(&str, f64); 12] = [
    ("m", 1.0),
    ("m.", 1.0),
    ("metre", 1.0),
    ("metres", 1.0),
    ("meter", 1.0),
    ("meters", 1.0),
    ("ft", FOOT_M),
    ("ft.", FOOT_M),
    ("feet", FOOT_M),
    ("foot", FOOT_M),
    ("'", FOOT_M),
    ("′", FOOT_M),
];

/// What may stand behind the inches that follow feet.
const INCH_UNITS: [&str; 6] = ["\"", "″", "''", "in", "in.", "inches"];

/// What may stand behind a number of storeys.
const STOREY_UNITS: [&str; 8] = [
    "storey", "storeys", "story", "stories", "floor", "floors", "level", "levels",
];

/// A length in metres; a number without a unit counts `unit_m` metres. None for anything else.
pub fn length_from_text(text: &str, unit_m: f64) -> Option<f64> {
    let (number, rest) = leading_number(text)?;
    if rest.is_empty() {
        return finite(number * unit_m);
    }
    let unit_end = rest
        .find(|c: char| c.is_ascii_digit() || c.is_whitespace())
        .unwrap_or(rest.len());
    let (unit, rest) = rest.split_at(unit_end);
    let unit = unit.to_lowercase();
    let (_, factor) = LENGTH_UNITS.iter().find(|(known, _)| *known == unit)?;
    let inches = match rest.trim() {
        "" => 0.0,
        rest if *factor == FOOT_M => {
            let (inches, unit) = leading_number(rest)?;
            INCH_UNITS
                .contains(&unit.to_lowercase().as_str())
                .then_some(inches)?
        }
        _ => return None,
    };
    finite((number + inches / 12.0) * factor)
}

/// A number of storeys. None for anything else.
pub fn storeys_from_text(text: &str) -> Option<f64> {
    let (number, unit) = leading_number(text)?;
    (unit.is_empty() || STOREY_UNITS.contains(&unit.to_lowercase().as_str()))
        .then_some(number)
        .and_then(finite)
}

/// The number that a text begins with, a comma counting as a point, and what follows it, trimmed.
fn leading_number(text: &str) -> Option<(f64, &str)> {
    let text = text.trim();
    let end = text
        .find(|c: char| !(c.is_ascii_digit() || matches!(c, '.' | ',' | '-' | '+' | 'e' | 'E')))
        .unwrap_or(text.len());
    let number = text[..end].replace(',', ".").parse().ok()?;
    Some((number, text[end..].trim()))
}

fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_people_write_are_read() {
        for (text, metres) in [
            ("12", Some(12.0)),
            ("12.5 m", Some(12.5)),
            ("12.5m", Some(12.5)),
            ("12,5", Some(12.5)),
            (" 40 ft", Some(40.0 * FOOT_M)),
            ("40'", Some(40.0 * FOOT_M)),
            ("12 ft 6 in", Some(12.5 * FOOT_M)),
            ("12'6\"", Some(12.5 * FOOT_M)),
            ("12' 6\"", Some(12.5 * FOOT_M)),
            ("-3", Some(-3.0)),
            ("2;3", None),
            ("12 m 6 in", None),
            ("12 ft 6", None),
            ("unknown", None),
            ("", None),
            ("3 floors", None),
            ("nan", None),
            ("1e400", None),
        ] {
            assert_eq!(length_from_text(text, 1.0), metres, "{text:?}");
        }
        assert_eq!(
            length_from_text("40", FOOT_M),
            Some(40.0 * FOOT_M),
            "a field in feet"
        );
        assert_eq!(
            length_from_text("40 m", FOOT_M),
            Some(40.0),
            "the value's own unit wins"
        );
        assert_eq!(storeys_from_text("3 floors"), Some(3.0));
        assert_eq!(storeys_from_text("40 ft"), None);
    }
}
