//! One name for one thing, and the packages that the project is built on.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::PathBuf;

use crate::support::{files, metadata, workspace_root};

/// The sources of all members, without their tests: path and lines.
fn sources() -> Vec<(PathBuf, String)> {
    let root = workspace_root();
    let metadata = metadata();
    let folders = metadata.workspace_packages().into_iter().map(|package| {
        package.manifest_path.parent().map(|folder| folder.as_std_path().join("src")).unwrap_or_default()
    });
    let sources = folders.filter(|folder| folder.is_dir()).flat_map(|folder| files(&folder, "rs"));
    sources
        .map(|file| {
            let text = fs::read_to_string(&file).unwrap();
            let code = text.split("\n#[cfg(test)]\n").next().unwrap_or_default().to_owned();
            (file.strip_prefix(root.canonicalize().unwrap()).unwrap_or(&file).to_owned(), code)
        })
        .collect()
}

/// The name behind one of these keywords at the start of a line.
fn declared<'t>(line: &'t str, keywords: &[&str]) -> Option<&'t str> {
    let rest = keywords.iter().find_map(|keyword| line.trim_start().strip_prefix(keyword))?;
    rest.split(|c: char| !c.is_alphanumeric() && c != '_').next().filter(|name| !name.is_empty())
}

#[test]
fn a_public_type_name_means_one_thing() {
    let mut places: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for (file, text) in sources() {
        // The classes of Python have the names of what they wrap.
        if file.starts_with("crates/py") {
            continue;
        }
        let keywords = ["pub struct ", "pub enum ", "pub trait ", "pub type "];
        for name in text.lines().filter_map(|line| declared(line, &keywords)) {
            places.entry(name.to_owned()).or_default().insert(file.display().to_string());
        }
    }
    places.retain(|_, files| files.len() > 1);
    assert!(places.is_empty(), "public types with the same name: {places:#?}");
}

/// The packages that the project is built on, and the crate whose work they do.
const PACKAGES: [(&str, &str); 8] = [
    ("nalgebra", "descriptors"),
    ("rayon", "geodesics"),
    ("tobj", "mesh-io"),
    ("serde", "canonform"),
    ("rusqlite", "index"),
    ("kiddo", "rigid"),
    ("plotters", "report"),
    ("clap", "cli"),
];

#[test]
fn the_packages_that_the_project_is_built_on_are_used() {
    let sources = sources();
    for (package, user) in PACKAGES {
        let folder = PathBuf::from("crates").join(user);
        let uses = |text: &str| text.contains(&format!("{package}::"));
        assert!(
            sources.iter().any(|(file, text)| file.starts_with(&folder) && uses(text)),
            "`{user}` does not use `{package}`"
        );
    }
}
