//! Which crate may depend on which.

use cargo_metadata::{DependencyKind, Package};
use std::collections::{BTreeMap, BTreeSet};

use crate::support::metadata;

/// The crates of the workspace that a crate may depend on.
enum May {
    Know(&'static [&'static str]),
    KnowEverything,
}

/// Budgets, progress and files reach everything.
const EVERYWHERE: [&str; 1] = ["base"];

/// All crates of the workspace, by folder name; packages are called `canonform-FOLDER`.
const RULES: [(&str, May); 26] = [
    ("base", May::Know(&[])),
    ("surface", May::Know(&[])),
    ("linalg", May::Know(&[])),
    ("mesh", May::Know(&["surface"])),
    ("mesh-io", May::Know(&["mesh", "surface"])),
    ("datasets", May::Know(&["mesh", "surface"])),
    ("geodesics", May::Know(&["surface", "linalg"])),
    ("nmds", May::Know(&["linalg"])),
    ("retrieval", May::Know(&["linalg"])),
    ("collection", May::Know(&["mesh", "mesh-io"])),
    ("fields", May::Know(&["mesh", "surface", "linalg", "geodesics", "nmds"])),
    ("rigid", May::Know(&["mesh", "surface"])),
    ("maps", May::Know(&["mesh", "surface", "linalg", "rigid", "descriptors"])),
    ("relations", May::Know(&["mesh", "surface", "linalg", "rigid", "descriptors"])),
    ("index", May::Know(&["retrieval"])),
    ("descriptors", May::Know(&["mesh", "surface", "linalg", "rigid", "nmds"])),
    (
        "canonform",
        May::Know(&[
            "surface",
            "mesh",
            "mesh-io",
            "linalg",
            "geodesics",
            "nmds",
            "retrieval",
            "index",
            "descriptors",
            "collection",
            "fields",
            "maps",
            "relations",
            "rigid",
        ]),
    ),
    ("report", May::Know(&["mesh", "surface"])),
    ("server", May::Know(&["canonform", "report"])),
    ("cli", May::Know(&["canonform", "report", "server", "datasets"])),
    ("py", May::Know(&["canonform", "datasets", "report"])),
    ("bench", May::Know(&[])),
    ("browser", May::Know(&[])),
    ("guide", May::Know(&[])),
    ("experiments", May::KnowEverything),
    ("tests", May::KnowEverything),
];

fn normal_dependencies(package: &Package) -> BTreeSet<&str> {
    let normal = package.dependencies.iter().filter(|d| d.kind == DependencyKind::Normal);
    normal.map(|d| folder(d.name.as_str())).collect()
}

/// The folder of a package, as rules and code name it.
fn folder(package: &str) -> &str {
    package.strip_prefix("canonform-").unwrap_or(package)
}

#[test]
fn crates_depend_only_on_allowed_crates() {
    let metadata = metadata();
    let rules = BTreeMap::from(RULES.map(|(name, may)| (name, may)));
    let members = metadata.workspace_packages();
    let names: BTreeSet<&str> = members.iter().map(|p| folder(p.name.as_str())).collect();
    let mut faults = Vec::new();
    for package in &members {
        let name = folder(package.name.as_str());
        match rules.get(name) {
            None => {
                faults.push(format!("the crate `{name}` has no line in the table of dependencies; add one"))
            }
            Some(May::KnowEverything) => {}
            Some(May::Know(allowed)) => {
                let forbidden = normal_dependencies(package);
                let forbidden = forbidden
                    .into_iter()
                    .filter(|d| names.contains(d) && !allowed.contains(d) && !EVERYWHERE.contains(d));
                faults.extend(forbidden.map(|d| {
                    let rule =
                        if allowed.is_empty() { "no other crate".to_owned() } else { allowed.join(", ") };
                    format!("the crate `{name}` depends on `{d}`; it may depend on {rule}")
                }));
            }
        }
    }
    let gone = rules.keys().filter(|name| !names.contains(*name));
    faults.extend(gone.map(|name| format!("the table of dependencies names `{name}`, which does not exist")));
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn only_linalg_depends_on_the_numerical_backend() {
    let metadata = metadata();
    for package in metadata.workspace_packages() {
        let uses_faer = package.dependencies.iter().any(|d| d.name == "faer");
        assert!(
            !uses_faer || folder(package.name.as_str()) == "linalg",
            "the crate `{}` depends on `faer`; only `linalg` may",
            package.name
        );
    }
}

#[test]
fn libraries_know_arguments_only_where_a_program_asks_for_them() {
    let metadata = metadata();
    for package in metadata.workspace_packages() {
        let is_program = ["cli", "experiments"].contains(&folder(package.name.as_str()));
        let clap = package.dependencies.iter().find(|d| d.name == "clap" && d.kind == DependencyKind::Normal);
        let is_optional = clap.is_none_or(|d| d.optional);
        assert!(
            is_program || is_optional,
            "the crate `{}` depends on `clap`; make that a feature",
            package.name
        );
    }
}
