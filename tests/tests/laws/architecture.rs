//! Which crate may depend on which, by the table of `ARCHITECTURE.md`.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;

use cargo_metadata::DependencyKind;

use crate::support::{metadata, workspace_root};

/// The folder of a package, as the table names it.
fn folder(package: &str) -> &str {
    package.strip_prefix("canonform-").unwrap_or(package)
}

/// The crates that each crate may depend on besides `base`, or `None` for all.
fn rules(page: &str) -> BTreeMap<&str, Option<BTreeSet<&str>>> {
    let mut rules = BTreeMap::new();
    let table = page.split("| crate | may depend on |").nth(1).unwrap().split("\n\n").next().unwrap();
    for row in table.lines().skip(2) {
        let [_, names, may, ..] = row.split('|').map(str::trim).collect::<Vec<_>>()[..] else {
            panic!("{row}")
        };
        let may = match may {
            "everything" => None,
            "nothing" => Some(BTreeSet::new()),
            "all above" => Some(rules.keys().copied().collect()),
            list => Some(list.split(", ").collect()),
        };
        rules.extend(names.split(", ").map(|name| (name, may.clone())));
    }
    rules
}

#[test]
fn crates_depend_only_on_allowed_crates() {
    let (metadata, page) =
        (metadata(), fs::read_to_string(workspace_root().join("ARCHITECTURE.md")).unwrap());
    let (members, rules) = (metadata.workspace_packages(), rules(&page));
    let names: BTreeSet<&str> = members.iter().map(|package| folder(package.name.as_str())).collect();
    let listed = rules.keys().chain(rules.values().flatten().flatten()).copied();
    assert_eq!(listed.collect::<BTreeSet<_>>(), names, "the table of ARCHITECTURE.md lists every crate");
    for package in members {
        let name = folder(package.name.as_str());
        for dependency in package.dependencies.iter().filter(|d| d.kind == DependencyKind::Normal) {
            let to = folder(dependency.name.as_str());
            let may = rules[name].as_ref().is_none_or(|may| may.contains(to)) || to == "base";
            assert!(may || !names.contains(to), "`{name}` may not depend on `{to}`: see ARCHITECTURE.md");
            assert!(to != "faer" || name == "linalg", "`{name}` depends on `faer`; only `linalg` may");
            let knows_arguments = to == "clap" && !dependency.optional;
            let is_program = ["cli", "experiments"].contains(&name);
            assert!(is_program || !knows_arguments, "`{name}` depends on `clap`; make that a feature");
        }
    }
}
