//! Checks the licences in the bundle of plotly.js against `deny.toml`. `make deny` checks those of all dependencies.

use std::fs;

use crate::support::workspace_root;

#[test]
fn every_package_in_the_bundle_of_plotly_has_an_allowed_licence() {
    let rules = fs::read_to_string(workspace_root().join("deny.toml")).unwrap();
    let rules: toml::Table = rules.parse().unwrap();
    let allowed = rules["licenses"]["allow"].as_array().unwrap();
    let text = fs::read_to_string(workspace_root().join("crates/report/assets/plotly/LICENSES")).unwrap();
    let headings: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("== ")).collect();
    assert!(headings.iter().any(|heading| heading.starts_with("plotly.js ")), "{headings:?}");
    for heading in headings {
        let (_, licence) = heading.split_once(": ").unwrap();
        assert!(allowed.iter().any(|a| a.as_str() == Some(licence)), "not allowed by deny.toml: {heading}");
    }
}
