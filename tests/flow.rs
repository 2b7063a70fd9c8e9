//! The tree is the flow: a module imports only what stands before it in `lib.rs`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn modules_in_order() -> Vec<String> {
    let text = fs::read_to_string(root().join("src/lib.rs")).unwrap();
    text.lines()
        .filter_map(|line| line.strip_prefix("pub mod ")?.strip_suffix(';'))
        .map(str::to_owned)
        .collect()
}

fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// Names of modules that a text refers to as `crate::name`.
fn imports(text: &str) -> Vec<String> {
    text.split("crate::")
        .skip(1)
        .map(|rest| {
            rest.chars()
                .take_while(|c| c.is_alphanumeric() || *c == '_')
                .collect()
        })
        .collect()
}

#[test]
fn no_module_imports_what_comes_after_it() {
    let modules = modules_in_order();
    assert!(modules.len() >= 10, "{modules:?}");
    let place = |name: &str| modules.iter().position(|module| module == name);
    let mut checked = 0;
    for (own, module) in modules.iter().enumerate() {
        let mut files = Vec::new();
        rust_files(&root().join("src").join(module), &mut files);
        for file in files {
            for import in imports(&fs::read_to_string(&file).unwrap()) {
                let Some(other) = place(&import) else { continue };
                assert!(
                    other <= own,
                    "{} imports {import}, which comes later",
                    file.display()
                );
                checked += 1;
            }
        }
    }
    assert!(checked > 50, "the test found only {checked} imports");
}

#[test]
fn the_top_level_is_what_the_design_fixes() {
    let allowed = [
        "Cargo.toml",
        "Cargo.lock",
        "src",
        "shaders",
        "data",
        "tools",
        "tests",
        "README.md",
        "LICENSE-MIT",
        "LICENSE-APACHE",
        "NOTICE",
        "target",
        "demo",
    ];
    for entry in fs::read_dir(root()).unwrap() {
        let name = entry.unwrap().file_name().to_string_lossy().into_owned();
        assert!(
            name.starts_with('.') || allowed.contains(&name.as_str()),
            "{name}"
        );
    }
}

#[test]
fn no_layer_below_the_command_line_names_a_flag() {
    let mut files = Vec::new();
    rust_files(&root().join("src"), &mut files);
    let below = files
        .iter()
        .filter(|file| !file.starts_with(root().join("src/cli")));
    let is_flag = |text: &str| {
        text.match_indices("--").any(|(at, _)| {
            let (before, after) = (&text[..at], &text[at + 2..]);
            !before.ends_with('-') && after.starts_with(|c: char| c.is_ascii_lowercase())
        })
    };
    let mut checked = 0;
    for file in below {
        for (number, line) in (1..).zip(fs::read_to_string(file).unwrap().lines()) {
            assert!(!is_flag(line), "{}:{number} names a flag: {line}", file.display());
        }
        checked += 1;
    }
    assert!(checked > 50, "the test found only {checked} files");
    assert!(is_flag("give --texel 2") && !is_flag("a --- b") && !is_flag("x - -y"));
}

#[test]
fn shader_libraries_have_no_entry_points() {
    for entry in fs::read_dir(root().join("shaders/lib")).unwrap() {
        let path = entry.unwrap().path();
        let text = fs::read_to_string(&path).unwrap();
        let entries = ["@vertex", "@fragment", "@compute"]
            .iter()
            .any(|mark| text.contains(mark));
        assert!(!entries, "{} has an entry point", path.display());
    }
}
