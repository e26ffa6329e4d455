//! Which crate may know which.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use cargo_metadata::{DependencyKind, Metadata, MetadataCommand, Package};

use crate::support::workspace_root;

/// What a crate may depend on.
enum May {
    Know(&'static [&'static str]),
    KnowEverything,
}

/// Every crate of the workspace.
const RULES: [(&str, May); 15] = [
    ("mesh", May::Know(&[])),
    ("linalg", May::Know(&[])),
    ("datasets", May::Know(&["mesh"])),
    ("geodesics", May::Know(&["mesh", "linalg"])),
    ("nmds", May::Know(&["linalg"])),
    ("retrieval", May::Know(&["linalg"])),
    ("descriptors", May::Know(&["mesh", "linalg", "nmds"])),
    ("pipeline", May::Know(&["mesh", "linalg", "geodesics", "nmds", "retrieval", "descriptors"])),
    ("report", May::Know(&["mesh", "linalg", "retrieval"])),
    ("terminal", May::Know(&["pipeline"])),
    ("server", May::Know(&["pipeline", "report", "mesh"])),
    ("cli", May::Know(&["pipeline", "report", "retrieval", "mesh", "server", "terminal"])),
    ("browser", May::Know(&[])),
    ("experiments", May::KnowEverything),
    ("tests", May::KnowEverything),
];

fn metadata() -> Metadata {
    MetadataCommand::new()
        .manifest_path(workspace_root().join("Cargo.toml"))
        .no_deps()
        .other_options(["--offline".to_owned()])
        .exec()
        .unwrap()
}

fn normal_dependencies(package: &Package) -> BTreeSet<&str> {
    let normal = package.dependencies.iter().filter(|d| d.kind == DependencyKind::Normal);
    normal.map(|d| d.name.as_str()).collect()
}

#[test]
fn crates_know_only_what_they_may() {
    let metadata = metadata();
    let rules = BTreeMap::from(RULES.map(|(name, may)| (name, may)));
    let members = metadata.workspace_packages();
    let names: BTreeSet<&str> = members.iter().map(|p| p.name.as_str()).collect();
    let mut faults = Vec::new();
    for package in &members {
        let name = package.name.as_str();
        match rules.get(name) {
            None => faults.push(format!(
                "the crate `{name}` has no line in the table of dependencies; say there what it may know"
            )),
            Some(May::KnowEverything) => {}
            Some(May::Know(allowed)) => {
                let forbidden = normal_dependencies(package);
                let forbidden = forbidden.into_iter().filter(|d| names.contains(d) && !allowed.contains(d));
                faults.extend(forbidden.map(|d| {
                    let rule =
                        if allowed.is_empty() { "no other crate".to_owned() } else { allowed.join(", ") };
                    format!("the crate `{name}` depends on `{d}`; it may depend on {rule}")
                }));
            }
        }
    }
    let gone = rules.keys().filter(|name| !names.contains(*name));
    faults.extend(gone.map(|name| format!("the table of dependencies names `{name}`, which is no crate")));
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn one_crate_names_the_numerical_backend() {
    let metadata = metadata();
    for package in metadata.workspace_packages() {
        let uses_faer = package.dependencies.iter().any(|d| d.name == "faer");
        assert!(
            !uses_faer || package.name.as_str() == "linalg",
            "the crate `{}` depends on `faer`; only `linalg` may",
            package.name
        );
    }
}

/// Geodesics sees edge lengths alone: that is what makes isometry invariance hold by construction.
#[test]
fn geodesics_reads_no_coordinates() {
    let mut faults = Vec::new();
    for path in source_files(&workspace_root().join("crates/geodesics/src")) {
        // Tests may make surfaces from coordinates.
        if path
            .iter()
            .rev()
            .take_while(|part| *part != "src")
            .any(|part| part == "tests" || part == "tests.rs" || part == "testing.rs")
        {
            continue;
        }
        let source = fs::read_to_string(&path).unwrap();
        let shipped = source.lines().take_while(|line| *line != "#[cfg(test)]");
        for (number, line) in shipped.enumerate() {
            let code = line.split("//").next().unwrap_or_default();
            let found = ["TriMesh", "positions", "Point3"].into_iter().filter(|word| code.contains(word));
            faults.extend(found.map(|word| {
                let place = format!("{}:{}", path.display(), number + 1);
                format!("{place}: `geodesics` mentions `{word}`; it must see edge lengths only")
            }));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

fn source_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(source_files(&path));
        } else if path.extension().is_some_and(|e| e == "rs") {
            files.push(path);
        }
    }
    assert!(!files.is_empty(), "no source in {}", folder.display());
    files
}
