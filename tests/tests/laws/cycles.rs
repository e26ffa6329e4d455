//! No module of a crate imports, directly or through others, a module that imports it.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use crate::support::{files, metadata};

/// The segments of a path, without `crate`.
type ModulePath = Vec<String>;

/// The text of each module of a crate, without comments and tests.
type Modules = BTreeMap<ModulePath, String>;

fn path(text: &str) -> ModulePath {
    text.split("::").map(str::trim).filter(|s| !s.is_empty()).map(str::to_owned).collect()
}

/// The modules below a `src` folder. Modules of tests do not count.
fn modules(src: &Path) -> Modules {
    let mut modules = Modules::new();
    for file in files(src, "rs") {
        let relative = file.strip_prefix(src).unwrap().with_extension("");
        let mut module: ModulePath = relative.iter().map(|part| part.to_str().unwrap().to_owned()).collect();
        module.pop_if(|name| ["lib", "main", "mod"].contains(&name.as_str()));
        if !module.iter().any(|name| ["tests", "testing"].contains(&name.as_str())) {
            let text = fs::read_to_string(&file).unwrap();
            let text = text.split("\n#[cfg(test)]\nmod tests {").next().unwrap();
            let lines = text.lines().map(|line| line.split("//").next().unwrap_or_default());
            // A visibility is not an import.
            let lines = lines.map(|line| line.replace("pub(in crate", "pub(in "));
            modules.entry(module).or_default().push_str(&lines.collect::<Vec<_>>().join("\n"));
        }
    }
    modules
}

/// Splits `a::{b, c::{d, e}}` into `a::b`, `a::c::d` and `a::c::e`.
fn expand(tree: &str, start: &ModulePath, paths: &mut Vec<ModulePath>) {
    let Some((head, rest)) = tree.split_once('{') else {
        let name = tree.split(" as ").next().unwrap_or_default();
        return paths.push([start.as_slice(), &path(name)].concat());
    };
    let start = [start.as_slice(), &path(head)].concat();
    let inside = &rest[..rest.rfind('}').unwrap_or(rest.len())];
    let mut depth = 0;
    let parts = inside.split(|c| {
        depth += i32::from(c == '{') - i32::from(c == '}');
        c == ',' && depth == 0
    });
    parts.filter(|part| !part.trim().is_empty()).for_each(|part| expand(part, &start, paths));
}

/// The paths that a module re-exports, and those that it uses.
fn mentioned(text: &str) -> [Vec<ModulePath>; 2] {
    let (mut exported, mut used) = (Vec::new(), Vec::new());
    let mut lines = text.lines().map(str::trim);
    while let Some(line) = lines.next() {
        let import =
            line.split_once("use ").filter(|(before, _)| before.is_empty() || before.starts_with("pub"));
        if let Some((visibility, tree)) = import {
            let mut tree = tree.to_owned();
            while !tree.contains(';') {
                tree += lines.next().unwrap_or(";");
            }
            let paths = if visibility.is_empty() { &mut used } else { &mut exported };
            expand(tree.trim_end_matches(';'), &ModulePath::new(), paths);
        } else {
            let words = line.split(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':'));
            used.extend(words.filter(|word| word.contains("::")).map(path));
        }
    }
    [exported, used]
}

/// The path from the root of the crate; `None` for other crates and local names.
fn absolute(path: &[String], module: &ModulePath, modules: &Modules) -> Option<ModulePath> {
    let (first, rest) = path.split_first()?;
    let child = [module.as_slice(), std::slice::from_ref(first)].concat();
    match first.as_str() {
        "crate" => Some(rest.to_vec()),
        "self" => Some([module.as_slice(), rest].concat()),
        "super" if rest.first().is_some_and(|next| next == "super") => {
            absolute(rest, &module[..module.len().saturating_sub(1)].to_vec(), modules)
        }
        "super" => Some([&module[..module.len().saturating_sub(1)], rest].concat()),
        _ if modules.contains_key(&child) => Some([child.as_slice(), rest].concat()),
        _ => None,
    }
}

/// The module that defines the item at a path, found by following re-exports.
fn definition(
    item: &ModulePath,
    exports: &BTreeMap<ModulePath, ModulePath>,
    modules: &Modules,
) -> ModulePath {
    let mut item = item.clone();
    // No chain of re-exports is longer.
    for _ in 0..8 {
        let length = (0..=item.len()).rev().find(|&n| modules.contains_key(&item[..n])).unwrap_or(0);
        let Some(name) = item.get(..=length).and_then(|name| exports.get(name)) else {
            return item[..length].to_vec();
        };
        item = [name.as_slice(), &item[length + 1..]].concat();
    }
    item
}

/// All modules that import themselves through others, with their imports.
fn cycles(modules: &Modules) -> Vec<String> {
    let mut exports = BTreeMap::new();
    let mut uses = BTreeMap::new();
    for (module, text) in modules {
        let [exported, used] = mentioned(text);
        let absolute = |path: ModulePath| absolute(&path, module, modules);
        for target in exported.into_iter().filter_map(absolute) {
            let name = target.last().cloned();
            exports.insert(module.iter().cloned().chain(name).collect::<ModulePath>(), target);
        }
        uses.insert(module, used.into_iter().filter_map(absolute).collect::<Vec<_>>());
    }
    let imports: BTreeMap<&ModulePath, BTreeSet<ModulePath>> = uses
        .into_iter()
        .map(|(module, used)| {
            let defined = used.iter().map(|item| definition(item, &exports, modules));
            (module, defined.filter(|other| other != module).collect())
        })
        .collect();
    let reached = |start: &ModulePath| {
        let (mut seen, mut stack) = (BTreeSet::new(), vec![start]);
        while let Some(next) = stack.pop() {
            stack.extend(
                imports.get(next).into_iter().flatten().filter(|other| seen.insert((*other).clone())),
            );
        }
        seen
    };
    let in_cycles = imports.iter().filter(|(module, _)| reached(module).contains(**module));
    let name = |module: &ModulePath| format!("crate::{}", module.join("::"));
    in_cycles
        .map(|(m, others)| {
            format!("{} -> {}", name(m), others.iter().map(name).collect::<Vec<_>>().join(", "))
        })
        .collect()
}

#[test]
fn modules_have_no_import_cycles() {
    let mut faults = Vec::new();
    for package in metadata().workspace_packages() {
        let src = package.manifest_path.parent().unwrap().join("src");
        if src.is_dir() {
            let found = cycles(&modules(src.as_std_path()));
            faults.extend(found.into_iter().map(|cycle| format!("{}: {cycle}", package.name)));
        }
    }
    assert!(faults.is_empty(), "modules that import each other:\n{}", faults.join("\n"));
}

#[test]
fn a_cycle_through_a_re_export_is_found() {
    let crate_with = |b: &str| {
        let texts = [
            ("", "mod a;\nmod b;\npub use a::First;\npub use b::{\n    Second,\n    Third as Other,\n};"),
            ("a", "use std::fs;\nuse crate::Second;\npub struct First;"),
            ("b", b),
            ("b::c", "use super::Second;"),
        ];
        texts.map(|(module, text)| (path(module), text.to_owned())).into()
    };
    assert_eq!(cycles(&crate_with("mod c;\npub struct Second(Vec<u8>);")), Vec::<String>::new());
    let cycle = cycles(&crate_with("mod c;\npub struct Second(crate::First);"));
    assert_eq!(cycle, ["crate::a -> crate::b", "crate::b -> crate::a"]);
    let cycle = cycles(&crate_with("mod c;\nfn f() { c::g() }"));
    assert_eq!(cycle, ["crate::b -> crate::b::c", "crate::b::c -> crate::b"]);
}
