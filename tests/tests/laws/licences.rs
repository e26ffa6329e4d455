//! Checks the licences of all dependencies against `deny.toml`.
//!
//! `make deny` checks the same and more with cargo-deny; this test needs no other program.

use std::fs;
use std::process::Command;

use cargo_metadata::{Metadata, MetadataCommand};

use crate::support::workspace_root;

/// All packages that are built on this platform, without access to the registry.
fn metadata() -> Metadata {
    let version = Command::new("rustc").arg("-vV").output().unwrap();
    let version = String::from_utf8(version.stdout).unwrap();
    let host = version.lines().find_map(|line| line.strip_prefix("host: ")).unwrap();
    MetadataCommand::new()
        .manifest_path(workspace_root().join("Cargo.toml"))
        .other_options(["--offline", "--filter-platform", host].map(str::to_owned))
        .exec()
        .unwrap()
}

/// The licences that a package may have by `deny.toml`; those of every package if it has none of its own.
fn allowed(package: &str) -> Vec<String> {
    let text = fs::read_to_string(workspace_root().join("deny.toml")).unwrap();
    let licences = &text.parse::<toml::Table>().unwrap()["licenses"];
    let own = licences["exceptions"].as_array().unwrap().iter();
    let own = own.filter(|exception| exception["crate"].as_str() == Some(package)).chain([licences]);
    own.flat_map(|list| list["allow"].as_array().unwrap().clone())
        .map(|licence| licence.as_str().unwrap().to_owned())
        .collect()
}

/// Whether an SPDX expression is satisfied: each part joined by AND has an allowed alternative.
fn permits(expression: &str, allowed: &[String]) -> bool {
    let expression = expression.replace('/', " OR ");
    expression.split(" AND ").all(|part| {
        let part = part.replace(['(', ')'], "");
        part.split(" OR ").any(|licence| allowed.iter().any(|a| a == licence.trim()))
    })
}

#[test]
fn every_package_has_an_allowed_licence() {
    let is_allowed = |licence: &str, package: &str| permits(licence, &allowed(package));
    let faults: Vec<String> = metadata()
        .packages
        .iter()
        .filter(|package| !package.license.as_deref().is_some_and(|l| is_allowed(l, &package.name)))
        .map(|package| format!("{} {}: {:?}", package.name, package.version, package.license))
        .collect();
    assert!(faults.is_empty(), "not allowed by deny.toml:\n{}", faults.join("\n"));
}

#[test]
fn every_package_in_the_bundle_of_plotly_has_an_allowed_licence() {
    let allowed = allowed("plotly.js");
    let text = fs::read_to_string(workspace_root().join("crates/report/assets/plotly/LICENSES")).unwrap();
    let headings: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("== ")).collect();
    assert!(headings.iter().any(|heading| heading.starts_with("plotly.js ")), "{headings:?}");
    for heading in headings {
        let (_, licence) = heading.split_once(": ").unwrap();
        assert!(permits(licence, &allowed), "not allowed by deny.toml: {heading}");
    }
}
