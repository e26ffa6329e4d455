//! Whether the tests that `docs/robustness.md` names exist.

use std::fs;

use crate::support::{files, workspace_root};

#[test]
fn every_guarantee_names_tests_that_exist() {
    let root = workspace_root();
    let all = ["crates", "datasets", "experiments", "tests"].map(|folder| files(&root.join(folder), "rs"));
    let text: String = all.iter().flatten().map(|file| fs::read_to_string(file).unwrap()).collect();
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
