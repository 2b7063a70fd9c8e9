//! Lists of names in a message.

/// Names that a message shows; more are counted.
const MAX_NAMES: usize = 12;

/// `a, b, c`; after a dozen `and 23 more`. "none" for none.
pub fn listed(names: &[String]) -> String {
    if names.is_empty() {
        return "none".to_owned();
    }
    let shown = names[..names.len().min(MAX_NAMES)].join(", ");
    match names.len().checked_sub(MAX_NAMES) {
        Some(more) if more > 0 => format!("{shown} and {more} more"),
        _ => shown,
    }
}

#[cfg(test)]
mod tests {
    use super::listed;

    #[test]
    fn a_dozen_names_are_shown_and_the_rest_counted() {
        let names = |count: usize| (0..count).map(|k| format!("f{k}")).collect::<Vec<_>>();
        assert_eq!(listed(&names(0)), "none");
        assert_eq!(listed(&names(3)), "f0, f1, f2");
        assert!(listed(&names(12)).ends_with(", f11"));
        assert!(listed(&names(35)).ends_with(", f11 and 23 more"));
    }
}
