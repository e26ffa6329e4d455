//! Which crate may depend on which.

use cargo_metadata::{DependencyKind, Package};
use std::collections::{BTreeMap, BTreeSet};

use crate::support::{metadata, workspace_root};

/// The crates of the workspace that a crate may depend on.
enum May {
    Know(&'static [&'static str]),
    KnowEverything,
}

/// Budgets, progress and files reach everything.
const EVERYWHERE: [&str; 1] = ["base"];

/// All crates of the workspace, by folder name; packages are called `canonform-FOLDER`.
const RULES: [(&str, May); 25] = [
    ("base", May::Know(&[])),
    ("surface", May::Know(&[])),
    ("linalg", May::Know(&[])),
    ("mesh", May::Know(&["surface"])),
    ("datasets", May::Know(&["mesh", "surface"])),
    ("geodesics", May::Know(&["surface", "linalg"])),
    ("nmds", May::Know(&["linalg"])),
    ("retrieval", May::Know(&["linalg"])),
    ("collection", May::Know(&["mesh"])),
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
    ("report", May::Know(&["mesh", "surface", "retrieval", "linalg"])),
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

/// The files with this extension below a folder.
fn files_below(folder: &std::path::Path, extension: &str) -> Vec<std::path::PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let files = entries.flat_map(|path| match path.is_dir() {
        true => files_below(&path, extension),
        false => vec![path],
    });
    files.filter(|path| path.extension().is_some_and(|found| found == extension)).collect()
}

/// The names of options that are also words of commands or of reports.
const WORDS: [&str; 19] = [
    "method",
    "samples",
    "dim",
    "geodesic",
    "update",
    "obtuse",
    "components",
    "weld",
    "rank",
    "sampling",
    "regularization",
    "alpha",
    "iterations",
    "tolerance",
    "stress",
    "points",
    "size",
    "distance",
    "eigenfunctions",
];

#[test]
fn programs_take_options_from_the_schema() {
    let names: Vec<&str> = canonform::settings::SCHEMA.iter().map(|option| option.name).collect();
    for program in ["cli", "py", "server"] {
        for file in files_below(&workspace_root().join("crates").join(program).join("src"), "rs") {
            let text = std::fs::read_to_string(&file).unwrap();
            let is_word = |c: char| c.is_alphanumeric() || c == '_';
            let words: BTreeSet<&str> = text.split(|c| !is_word(c)).collect();
            for name in names.iter().filter(|name| !WORDS.contains(name)) {
                let file = file.display();
                assert!(!words.contains(name), "{file} names the option `{name}`; the schema declares it");
            }
        }
    }
}
