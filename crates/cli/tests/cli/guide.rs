//! The user guide: its commands print what it shows, its pictures are those that they draw, and its tables of JSON keys are
//! complete. Chapters that run `experiments` are tested beside that program. `docs/program.md` lists the commands of `--help`.
//!
//! `CANONFORM_WRITE_DOCS=1 cargo test -p canonform-cli --test cli guide` writes pictures, outputs and lists that differ again.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use canonform::Remedy;
use guide::{Chapter, CodeBlock, Language, Ran, Run};
use rayon::prelude::*;
use report::RgbaImage;
use serde_json::Value;
use strum::VariantArray;

use crate::support::program;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn chapters() -> Vec<Chapter> {
    let chapters = Chapter::all(&root().join("docs/guide")).unwrap();
    assert!(chapters.len() >= 8, "only {} chapters", chapters.len());
    chapters
}

fn is_writing() -> bool {
    std::env::var_os("CANONFORM_WRITE_DOCS").is_some()
}

/// The names of the pictures that a chapter shows.
fn pictures(chapter: &Chapter) -> Vec<&str> {
    let targets = chapter.text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    targets.filter_map(|target| target.rsplit_once("images/")).map(|(_, name)| name).collect()
}

/// Pixels of two pictures that differ visibly, as a share; 1 for different sizes.
fn difference(a: &Path, b: &Path) -> f64 {
    let [a, b] = [a, b].map(|path| RgbaImage::from_png(&fs::read(path).unwrap_or_default()).ok());
    let (Some(a), Some(b)) = (a, b) else { return 1.0 };
    if (a.width(), a.height()) != (b.width(), b.height()) {
        return 1.0;
    }
    let differs = |(a, b): &(&[u8; 4], &[u8; 4])| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 24);
    a.pixels().iter().zip(b.pixels()).filter(differs).count() as f64 / a.pixels().len() as f64
}

/// Compares the pictures of a chapter with those that its commands drew.
fn check_pictures(chapter: &Chapter, run: &mut Run) {
    let folder = root().join("docs/guide/images");
    for name in pictures(chapter) {
        let (shown, drawn) = (folder.join(name), run.folder.path().join(name));
        if is_writing() && drawn.exists() && difference(&shown, &drawn) > 0.0 {
            fs::create_dir_all(&folder).unwrap();
            fs::copy(&drawn, &shown).unwrap();
        }
        let share = difference(&shown, &drawn);
        if share > 0.01 {
            let path = chapter.path.display();
            run.faults
                .push(format!("{path}: {:.1} % of the pixels of {name} are not as drawn", 100.0 * share));
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
    let chapters = chapters();
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

/// What is wrong with a call of the program, told from its words and from what `--help-all` says.
fn fault(words: &[&str], helps: &mut BTreeMap<String, String>) -> Option<String> {
    let n_names = if matches!(words.first(), Some(&("index" | "field"))) { 2 } else { 1 };
    let Some((command, arguments)) = words.split_at_checked(n_names) else {
        return (n_names == 2).then(|| format!("`canonform {}` needs a command", words[0]));
    };
    if command[0].starts_with('-') || command == ["index", "..."] {
        return None;
    }
    let name = command.join(" ");
    let help = helps.entry(name.clone()).or_insert_with(|| {
        let output = Command::new(program()).args(command).arg("--help-all").output().unwrap();
        if output.status.success() { String::from_utf8(output.stdout).unwrap() } else { String::new() }
    });
    if help.is_empty() {
        return Some(format!("there is no command `{name}`"));
    }
    let options: BTreeSet<&str> = help.split(|c: char| !(c.is_ascii_alphanumeric() || c == '-')).collect();
    let is_number = |word: &str| word[1..].starts_with(|c: char| c.is_ascii_digit());
    let flags = arguments.iter().filter(|word| word.starts_with('-') && word.len() > 1 && !is_number(word));
    let unknown =
        flags.map(|word| word.split('=').next().unwrap_or(word)).find(|word| !options.contains(word));
    unknown.map(|option| format!("`{name}` has no option {option}"))
}

/// The commands of the program and of its groups, as `-h` lists them.
fn listed() -> String {
    let short = |arguments: &[&str]| {
        let output = Command::new(program()).args(arguments).arg("-h").output().unwrap();
        String::from_utf8(output.stdout).unwrap()
    };
    let commands = |arguments: &[&str]| {
        let help = short(arguments);
        let part = help.split("\n\n").find(|part| part.starts_with("Commands:")).unwrap();
        let lines = part.lines().skip(1).filter(|line| !line.starts_with("  help "));
        lines.map(|line| format!("{line}\n")).collect::<String>()
    };
    let groups = ["index", "field"].map(|group| format!("\ncanonform {group}\n{}", commands(&[group])));
    ["```text\ncanonform\n", &commands(&[]), &groups.concat(), "```\n"].concat()
}

#[test]
fn the_page_of_the_program_lists_its_commands() {
    let (begin, end) = ("<!-- help begins -->\n", "<!-- help ends -->\n");
    let path = root().join("docs/program.md");
    let page = fs::read_to_string(&path).unwrap();
    let (before, rest) = page.split_once(begin).unwrap();
    let (_, after) = rest.split_once(end).unwrap();
    let written = [before, begin, &listed(), end, after].concat();
    if is_writing() && written != page {
        fs::write(&path, &written).unwrap();
        return;
    }
    assert_eq!(page, written, "write docs/program.md again with CANONFORM_WRITE_DOCS=1");
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
    let (mut helps, mut faults, mut n_calls) = (BTreeMap::new(), Vec::new(), 0);
    for page in &pages {
        let blocks = page.blocks();
        let scripts = blocks.iter().filter(|block| block.language != Language::Other);
        for CodeBlock { line, text, language } in scripts {
            let is_command = |line: &&str| *language != Language::Console || line.starts_with("$ ");
            let commands: Vec<&str> = text.lines().filter(is_command).collect();
            for words in calls(&commands) {
                n_calls += 1;
                let fault = fault(&words, &mut helps);
                faults.extend(fault.map(|fault| format!("{}:{line}: {fault}", page.path.display())));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(n_calls >= 40, "only {n_calls} calls were found");
    assert!(fault(&["embed", "a.off", "--no-such-option"], &mut helps).is_some());
    assert!(fault(&["no-such-command", "a.off"], &mut helps).is_some());
    assert!(fault(&["index", "build", "a", "--shard", "1/2"], &mut helps).is_none());
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
