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
        assert!(package.description.is_some() && package.license.is_some(), "{name}");
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
    assert_eq!(stated(&page("CITATION.cff"), "version:"), version);
    assert_eq!(stated(&page("packaging/conda-forge/recipe.yaml"), "version:"), version);
    for (name, dependency) in root["workspace"]["dependencies"].as_table().unwrap() {
        if let Some(stated) = dependency.get("path").and(dependency.get("version")) {
            assert_eq!(stated.as_str(), Some(version.as_str()), "{name}");
        }
    }
    let python: toml::Table = page("crates/py/pyproject.toml").parse().unwrap();
    assert_eq!(python["project"]["dynamic"].as_array().unwrap()[0].as_str(), Some("version"));
    for (name, url) in python["project"]["urls"].as_table().unwrap() {
        assert!(url.as_str().unwrap().starts_with(&repository), "{name} of crates/py/pyproject.toml");
    }
    let least = stated(&page("packaging/conda-forge/recipe.yaml"), "python_min:").to_owned();
    assert_eq!(python["project"]["requires-python"].as_str(), Some(format!(">={least}").as_str()));
    assert_eq!(stated(&page("CITATION.cff"), "repository-code:"), repository);
    assert_eq!(stated(&page("packaging/conda-forge/recipe.yaml"), "repository:"), repository);
    assert!(page("Dockerfile").contains(&format!("image.source=\"{repository}\"")));
    let text = page("crates/py/README.md");
    assert!(text.matches("](https://").count() == text.matches(&format!("]({repository}/")).count());
    for place in ["Dockerfile", ".github/workflows/ci.yml"] {
        assert!(page(place).contains(&format!("rust:{rust}-")), "{place}");
    }
    for place in [".github/workflows/wheels.yml", ".github/workflows/release.yml"] {
        assert!(page(place).contains(&rust), "{place}");
    }
}

#[test]
fn releases_hold_the_archives_that_binstall_looks_for() {
    let program: toml::Table = page("crates/cli/Cargo.toml").parse().unwrap();
    let binstall = &program["package"]["metadata"]["binstall"];
    let release = page(".github/workflows/release.yml");
    let targets: Vec<&str> =
        release.lines().filter_map(|line| line.split_once("target: ")?.1.strip_suffix(" }")).collect();
    assert_eq!(targets.len(), 6);
    for target in targets {
        let form = binstall["overrides"].get(target).unwrap_or(binstall)["pkg-fmt"].as_str();
        assert_eq!(form, Some(if target.contains("windows") { "zip" } else { "tgz" }), "{target}");
    }
    assert!(binstall["pkg-url"].as_str().unwrap().starts_with("{ repo }/releases/download/v{ version }/"));
}
