//! Whether each package contains everything that it needs outside this workspace. `make package` checks its manifest.

use std::fs;

use crate::support::{files, metadata, workspace_root};

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
        assert!(!package.keywords.is_empty() && !package.categories.is_empty(), "{name}");
        for licence in ["LICENSE-MIT", "LICENSE-APACHE"] {
            assert!(folder.join(licence).is_file(), "{name} has no {licence}: link to that of the workspace");
        }
        let folder = folder.canonicalize().unwrap();
        for source in files(&folder, "rs") {
            for path in included(&fs::read_to_string(&source).unwrap()) {
                let path = source.with_file_name(path);
                let target =
                    path.canonicalize().unwrap_or_else(|error| panic!("{}: {error}", path.display()));
                assert!(target.starts_with(&folder), "{name}: {} is outside the package", path.display());
            }
        }
    }
}

/// A file of the workspace.
fn page(path: &str) -> String {
    fs::read_to_string(workspace_root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// The value of a key at the beginning of a line, without quotes.
fn stated<'a>(text: &'a str, key: &str) -> &'a str {
    let line = text.lines().find_map(|line| line.trim().strip_prefix(key));
    line.unwrap_or_else(|| panic!("no line begins with {key:?}")).trim().trim_matches('"')
}

#[test]
fn all_that_is_published_states_the_version_and_the_address_of_the_workspace() {
    let root: toml::Table = page("Cargo.toml").parse().unwrap();
    let shared = |key: &str| root["workspace"]["package"][key].as_str().unwrap().to_owned();
    let [version, repository, rust] = ["version", "repository", "rust-version"].map(shared);
    let (citation, recipe) = (page("CITATION.cff"), page("packaging/conda-forge/recipe.yaml"));
    assert_eq!([stated(&citation, "version:"), stated(&recipe, "version:")], [&version; 2]);
    assert_eq!([stated(&citation, "repository-code:"), stated(&recipe, "repository:")], [&repository; 2]);
    let python: toml::Table = page("crates/py/pyproject.toml").parse().unwrap();
    let least = format!(">={}", stated(&recipe, "python_min:"));
    assert_eq!(python["project"]["requires-python"].as_str(), Some(least.as_str()));
    for (name, url) in python["project"]["urls"].as_table().unwrap() {
        assert!(url.as_str().unwrap().starts_with(&repository), "{name} of crates/py/pyproject.toml");
    }
    for place in ["Dockerfile", ".github/workflows/ci.yml"] {
        assert!(page(place).contains(&format!("rust:{rust}-")), "{place}");
    }
}
