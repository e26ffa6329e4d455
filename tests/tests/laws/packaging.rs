//! Whether each package contains everything that it needs outside this workspace. `make package` checks its manifest.

use std::fs;

use crate::support::{metadata, rust_files};

/// The paths in the `include` macros of a file.
fn included(text: &str) -> impl Iterator<Item = &str> {
    let calls = ["include_str!(\"", "include_bytes!(\"", "include!(\""].into_iter();
    calls.flat_map(move |call| text.split(call).skip(1)).filter_map(|rest| rest.split('"').next())
}

#[test]
fn published_packages_describe_themselves_and_contain_what_they_include() {
    for package in metadata().workspace_packages() {
        if package.publish.as_ref().is_some_and(Vec::is_empty) {
            continue;
        }
        let (name, folder) = (&package.name, package.manifest_path.parent().unwrap());
        assert!(package.description.is_some() && package.license.is_some(), "{name}");
        assert!(!package.keywords.is_empty() && !package.categories.is_empty(), "{name}");
        for licence in ["LICENSE-MIT", "LICENSE-APACHE"] {
            assert!(folder.join(licence).is_file(), "{name} has no {licence}: link to that of the workspace");
        }
        let folder = folder.canonicalize().unwrap();
        for source in rust_files(&folder) {
            for path in included(&fs::read_to_string(&source).unwrap()) {
                let path = source.with_file_name(path);
                let target =
                    path.canonicalize().unwrap_or_else(|error| panic!("{}: {error}", path.display()));
                assert!(target.starts_with(&folder), "{name}: {} is outside the package", path.display());
            }
        }
    }
}
