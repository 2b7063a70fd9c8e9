//! Progress bars on standard error, when that is a terminal.

use indicatif::{ProgressBar, ProgressStyle};

/// A bar of `total` steps; a counter when `total` is 0.
pub fn progress(what: &'static str, total: u64) -> ProgressBar {
    let bar = ProgressBar::new(total);
    let template = if total > 0 {
        "{prefix:12} {wide_bar} {pos}/{len} {eta}"
    } else {
        "{prefix:12} {pos}"
    };
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar.set_prefix(what);
    bar
}
