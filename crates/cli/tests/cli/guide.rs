//! The user guide and the page of the program: commands print what is shown and draw the pictures, and tables of JSON keys are
//! complete. Chapters that run `experiments` are tested beside that program.
//!
//! `CANONFORM_WRITE_DOCS=1 cargo test -p canonform-cli --test cli guide` writes pictures, and outputs that differ, again.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use canonform::Remedy;
use guide::{Chapter, CodeBlock, Language, Ran, Run};
use rayon::prelude::*;
use serde_json::Value;
use strum::VariantArray;

use crate::support::program;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn is_writing() -> bool {
    std::env::var_os("CANONFORM_WRITE_DOCS").is_some()
}

/// The names of the pictures that a chapter shows.
fn pictures(chapter: &Chapter) -> Vec<&str> {
    let targets = chapter.text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    targets.filter_map(|target| target.rsplit_once("images/")).map(|(_, name)| name).collect()
}

/// Looks for the pictures of a chapter among those that its commands drew, and takes them over if asked to.
fn check_pictures(chapter: &Chapter, run: &mut Run) {
    for name in pictures(chapter) {
        let drawn = run.folder.path().join(name);
        if !drawn.exists() {
            run.faults.push(format!("{}: no command draws {name}", chapter.path.display()));
        } else if is_writing() {
            fs::copy(&drawn, root().join("docs/guide/images").join(name)).unwrap();
        }
    }
}

/// The paths of the keys of an object: `stress.value`, `results[].id`. Keys that are names, of signatures or of classes, are
/// `*` if the guide says so.
fn key_paths(value: &Value, prefix: &str, paths: &mut BTreeSet<String>) {
    match value {
        Value::Object(object) => {
            for (key, value) in object {
                let path = if prefix.is_empty() { key.clone() } else { format!("{prefix}.{key}") };
                paths.insert(path.clone());
                key_paths(value, &path, paths);
            }
        }
        Value::Array(items) => items.iter().for_each(|item| key_paths(item, &format!("{prefix}[]"), paths)),
        _ => {}
    }
}

/// Whether `path` is described by `row`: the key itself, or a key below one whose row ends with `.*`.
fn describes(row: &str, path: &str) -> bool {
    match row.strip_suffix(".*") {
        Some(parent) => {
            path.strip_prefix(parent).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
        }
        None => row == path,
    }
}

/// Compares the tables of keys in a chapter with the output of the commands above them. A table belongs to the last command
/// with `--json` before it.
fn check_keys(chapter: &Chapter, ran: &[Ran], faults: &mut Vec<String>) {
    let mut tables: BTreeMap<usize, Vec<String>> = BTreeMap::new();
    let commands: Vec<&Ran> = ran.iter().filter(|ran| ran.command.contains("--json")).collect();
    let mut in_table = false;
    for (number, line) in chapter.text.lines().enumerate() {
        in_table = line.starts_with("| key |") || (in_table && line.starts_with('|'));
        let Some(i) = commands.iter().rposition(|ran| ran.line <= number) else { continue };
        if let Some(row) = line.strip_prefix("| `").filter(|_| in_table) {
            let cell = row.split(" |").next().unwrap_or(row);
            tables
                .entry(i)
                .or_default()
                .extend(cell.split('`').step_by(2).map(str::to_owned).filter(|s| !s.is_empty()));
        }
    }
    for (i, rows) in tables {
        let place = format!("{}:{}", chapter.path.display(), commands[i].line);
        let Some(value) = commands[i].printed.lines().last().and_then(|line| serde_json::from_str(line).ok())
        else {
            faults.push(format!("{place} did not print an object: {}", commands[i].printed));
            continue;
        };
        let mut paths = BTreeSet::new();
        key_paths(&value, "", &mut paths);
        let missing = paths.iter().filter(|path| !rows.iter().any(|row| describes(row, path)));
        faults.extend(missing.map(|path| format!("{place}: the table does not describe `{path}`")));
        let gone = rows.iter().filter(|row| !paths.iter().any(|path| describes(row, path)));
        faults.extend(gone.map(|row| format!("{place}: the output has no `{row}`")));
    }
}

#[test]
fn the_guide_shows_what_its_commands_do() {
    let mut chapters = Chapter::all(&root().join("docs/guide")).unwrap();
    chapters.push(Chapter::read(&root().join("docs/program.md")).unwrap());
    let pending: Vec<&Chapter> = chapters.iter().filter(|chapter| !chapter.runs("experiments")).collect();
    let examples = root().canonicalize().unwrap().join("examples");
    let check = |chapter: &&Chapter| {
        let mut run = guide::run(chapter, &[Path::new(program())], &[&examples]).unwrap();
        if is_writing() {
            fs::write(&chapter.path, run.updated(chapter)).unwrap();
        }
        check_pictures(chapter, &mut run);
        check_keys(chapter, &run.ran, &mut run.faults);
        (run.ran.len(), run.faults)
    };
    let checked: Vec<(usize, Vec<String>)> = pending.par_iter().map(check).collect();
    let n_commands: usize = checked.iter().map(|(n, _)| n).sum();
    let mut faults: Vec<String> = checked.into_iter().flat_map(|(_, faults)| faults).collect();
    let shown: BTreeSet<&str> = chapters.iter().flat_map(pictures).collect();
    for entry in fs::read_dir(root().join("docs/guide/images")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        faults
            .extend((!shown.contains(&*name)).then(|| format!("no chapter shows docs/guide/images/{name}")));
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(n_commands >= 40, "only {n_commands} commands");
}

/// What is wrong with a call of the program: there is no such command, or it has no such option.
fn fault(words: &[&str]) -> Option<String> {
    let output = Command::new(program()).args(words).arg("--help-all").output().unwrap();
    let told = String::from_utf8(output.stderr).unwrap();
    let is_unknown = ["unrecognized subcommand", "unexpected argument '-"].iter().any(|it| told.contains(it));
    (is_unknown && words != ["index", "..."]).then_some(told)
}

/// The calls of the program in a script: their words, without comments, redirections and what follows a pipe.
fn calls<'a>(lines: &[&'a str]) -> Vec<Vec<&'a str>> {
    let mut calls = Vec::new();
    for line in lines {
        let line = line.trim().trim_start_matches("$ ");
        let line = line.split(" #").next().unwrap_or(line);
        for command in line.split([';', '|', '(', ')']).flat_map(|part| part.split("&&")) {
            let mut words = command.split_whitespace().skip_while(|word| *word != "canonform");
            if words.next().is_some() {
                calls.push(words.take_while(|word| !matches!(*word, "<" | ">" | "\\" | "&")).collect());
            }
        }
    }
    calls
}

#[test]
fn commands_on_every_page_exist_with_their_options() {
    let mut pages = Chapter::all(&root().join("docs")).unwrap();
    pages.push(Chapter::read(&root().join("README.md")).unwrap());
    let (mut faults, mut n_calls) = (Vec::new(), 0);
    for page in &pages {
        let blocks = page.blocks();
        let scripts = blocks.iter().filter(|block| block.language != Language::Other);
        for CodeBlock { line, text, language } in scripts {
            let is_command = |line: &&str| *language != Language::Console || line.starts_with("$ ");
            let commands: Vec<&str> = text.lines().filter(is_command).collect();
            for words in calls(&commands) {
                n_calls += 1;
                faults.extend(fault(&words).map(|fault| format!("{}:{line}: {fault}", page.path.display())));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(n_calls >= 40, "only {n_calls} calls were found");
    assert!(fault(&["embed", "a.off", "--no-such-option"]).is_some());
    assert!(fault(&["no-such-command", "a.off"]).is_some());
}

#[test]
fn the_guide_explains_every_remedy() {
    let page = fs::read_to_string(root().join("docs/guide/troubleshooting.md")).unwrap();
    let spelled = |name: &str, values: &[&str]| match name.contains(' ') {
        true => format!("'canonform {name}'"),
        false => format!("--{} {}", name.replace('_', "-"), values.join(" or ")).trim_end().to_owned(),
    };
    for remedy in Remedy::VARIANTS {
        let words = remedy.in_words(spelled);
        assert!(page.contains(&format!("`{words}`")), "troubleshooting.md does not explain `{words}`");
    }
}
