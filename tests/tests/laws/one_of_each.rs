//! One name for one thing.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;

use crate::support::{files, metadata};

/// The public type that a line declares.
fn declared(line: &str) -> Option<&str> {
    let keywords = ["pub struct ", "pub enum ", "pub trait ", "pub type "];
    let rest = keywords.iter().find_map(|keyword| line.trim_start().strip_prefix(keyword))?;
    rest.split(|c: char| !c.is_alphanumeric() && c != '_').next().filter(|name| !name.is_empty())
}

#[test]
fn a_public_type_name_means_one_thing() {
    let mut places: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for package in metadata().workspace_packages() {
        let folder = package.manifest_path.with_file_name("src");
        // The classes of Python have the names of what they wrap.
        if package.name.as_str() == "canonform-py" || !folder.is_dir() {
            continue;
        }
        for file in files(folder.as_std_path(), "rs") {
            let text = fs::read_to_string(&file).unwrap();
            let code = text.split("\n#[cfg(test)]\n").next().unwrap_or_default();
            for name in code.lines().filter_map(declared) {
                places.entry(name.to_owned()).or_default().insert(file.display().to_string());
            }
        }
    }
    places.retain(|_, files| files.len() > 1);
    assert!(places.is_empty(), "public types with the same name: {places:#?}");
}
