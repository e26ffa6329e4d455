//! Whether the tests that `docs/robustness.md` names exist.

use std::fs;
use std::path::Path;

use crate::support::workspace_root;

/// The sources of all crates below a folder, one after the other.
fn sources(folder: &Path, text: &mut String) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() {
            if name != "target" {
                sources(&path, text);
            }
        } else if name.ends_with(".rs") {
            *text += &fs::read_to_string(&path).unwrap();
        }
    }
}

#[test]
fn every_guarantee_names_tests_that_exist() {
    let root = workspace_root();
    let mut text = String::new();
    for folder in ["crates", "datasets", "experiments", "tests"] {
        sources(&root.join(folder), &mut text);
    }
    let page = fs::read_to_string(root.join("docs/robustness.md")).unwrap();
    let rows = page.lines().filter(|line| line.starts_with("| ") && !line.starts_with("| guarantee "));
    let mut n_tests = 0;
    for row in rows {
        let cell = row.trim_end_matches('|').rsplit('|').next().unwrap();
        let names: Vec<&str> = cell.split('`').skip(1).step_by(2).collect();
        assert!(!names.is_empty(), "no test for: {row}");
        for name in names {
            assert!(text.contains(&format!("fn {name}(")), "there is no test `{name}`");
            n_tests += 1;
        }
    }
    assert!(n_tests >= 10, "only {n_tests} tests were found in the page");
}
