//! Which crate may depend on which.

use cargo_metadata::{DependencyKind, Metadata, MetadataCommand, Package};
use std::collections::{BTreeMap, BTreeSet};

use crate::support::workspace_root;

/// The crates of the workspace that a crate may depend on.
enum May {
    Know(&'static [&'static str]),
    KnowEverything,
}

/// Limits on time and memory reach every computation.
const EVERYWHERE: [&str; 1] = ["budget"];

/// All crates of the workspace, by folder name; packages are called `canonform-FOLDER`.
const RULES: [(&str, May); 23] = [
    ("budget", May::Know(&[])),
    ("files", May::Know(&[])),
    ("surface", May::Know(&[])),
    ("linalg", May::Know(&[])),
    ("mesh", May::Know(&["surface", "files"])),
    ("datasets", May::Know(&["mesh", "surface"])),
    ("geodesics", May::Know(&["surface", "linalg"])),
    ("nmds", May::Know(&["linalg"])),
    ("retrieval", May::Know(&["linalg"])),
    ("index", May::Know(&["retrieval", "files"])),
    ("descriptors", May::Know(&["mesh", "surface", "linalg", "nmds"])),
    (
        "canonform",
        May::Know(&[
            "files",
            "surface",
            "mesh",
            "linalg",
            "geodesics",
            "nmds",
            "retrieval",
            "index",
            "descriptors",
        ]),
    ),
    ("view", May::Know(&["mesh", "surface", "files"])),
    ("report", May::Know(&["view", "mesh", "surface", "retrieval", "linalg", "files"])),
    ("terminal", May::Know(&["canonform", "files"])),
    ("server", May::Know(&["canonform", "view", "report", "index", "mesh", "surface"])),
    (
        "cli",
        May::Know(&[
            "canonform",
            "view",
            "report",
            "index",
            "retrieval",
            "mesh",
            "surface",
            "files",
            "server",
            "terminal",
            "datasets",
        ]),
    ),
    ("py", May::Know(&["canonform", "datasets", "files", "index", "mesh", "surface", "view"])),
    ("bench", May::Know(&[])),
    ("browser", May::Know(&[])),
    ("guide", May::Know(&[])),
    ("experiments", May::KnowEverything),
    ("tests", May::KnowEverything),
];

pub(crate) fn metadata() -> Metadata {
    MetadataCommand::new()
        .manifest_path(workspace_root().join("Cargo.toml"))
        .no_deps()
        .other_options(["--offline".to_owned()])
        .exec()
        .unwrap()
}

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
