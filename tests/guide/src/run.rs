//! Running the blocks of a chapter.

use std::env;
use std::ffi::OsString;
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::Command;

use tempfile::TempDir;

use crate::block::{Chapter, CodeBlock, Language};
use crate::output::{matches, without_progress};

/// A command that was run.
#[derive(Debug, Clone)]
pub struct Ran {
    /// The line of the chapter.
    pub line: usize,
    /// The command.
    pub command: String,
    /// What it printed, to standard output and standard error.
    pub printed: String,
    /// Whether this is not what the chapter shows.
    pub differs: bool,
    /// The lines of the chapter that show its output, counted from 0.
    shown: Range<usize>,
}

/// What became of the commands of a chapter.
#[derive(Debug)]
pub struct Run {
    /// The folder in which they ran; removed on drop.
    pub folder: TempDir,
    /// All commands, in order.
    pub ran: Vec<Ran>,
    /// What is wrong with the chapter, as `file:line: ...`.
    pub faults: Vec<String>,
}

impl Run {
    /// The text of the chapter with what its commands printed in place of what it shows, where this differs.
    #[must_use]
    pub fn updated(&self, chapter: &Chapter) -> String {
        let lines: Vec<&str> = chapter.text.lines().collect();
        let (mut text, mut next) = (String::new(), 0);
        let copy = |from: usize, to: usize, text: &mut String| {
            lines[from..to].iter().for_each(|line| *text += &format!("{line}\n"));
        };
        for ran in self.ran.iter().filter(|ran| ran.differs) {
            copy(next, ran.shown.start, &mut text);
            without_progress(&ran.printed).for_each(|line| text += &format!("{}\n", line.trim_end()));
            next = ran.shown.end;
        }
        copy(next, lines.len(), &mut text);
        text
    }
}

/// Runs all commands of a chapter with these programs, in a new folder with links to these files or folders.
///
/// # Errors
/// If the shell cannot be started, or a folder not be written.
pub fn run(chapter: &Chapter, programs: &[&Path], links: &[&Path]) -> io::Result<Run> {
    let programs_folder = TempDir::new()?;
    let mut run = Run { folder: TempDir::new()?, ran: Vec::new(), faults: Vec::new() };
    for (targets, folder) in [(programs, programs_folder.path()), (links, run.folder.path())] {
        for target in targets {
            link(target, &folder.join(target.file_name().unwrap_or_default()))?;
        }
    }
    let path = search_path(programs_folder.path());
    for (mut ran, shown) in chapter.blocks().iter().flat_map(steps) {
        let mut command = Command::new("bash");
        command.current_dir(run.folder.path()).env("PATH", &path).env("LC_ALL", "C.UTF-8");
        let output =
            command.args(["-c", &format!("set -euo pipefail; exec 2>&1\n{}", ran.command)]).output()?;
        ran.printed = String::from_utf8_lossy(&output.stdout).into_owned();
        ran.differs = shown.is_some_and(|shown| !matches(&shown, &ran.printed));
        let expected = exit_code(&ran.command);
        let fault = match output.status.code() == Some(expected) {
            true => ran.differs.then(|| "printed something else than the chapter shows".to_owned()),
            false => Some(format!("ended with {}, not {expected}", output.status)),
        };
        let place = format!("{}:{}: `{}`", chapter.path.display(), ran.line, ran.command.trim());
        run.faults.extend(fault.map(|fault| format!("{place} {fault}:\n{}", ran.printed)));
        run.ran.push(ran);
    }
    Ok(run)
}

/// The exit code that a command announces in a comment.
fn exit_code(command: &str) -> i32 {
    let comment = command.trim_end().rsplit_once("# exit code ");
    comment.and_then(|(_, code)| code.trim().parse().ok()).unwrap_or(0)
}

/// The commands of a block, and what it shows of their output.
fn steps(block: &CodeBlock) -> Vec<(Ran, Option<String>)> {
    let step = |line: usize, command: &str| Ran {
        line,
        command: command.to_owned(),
        printed: String::new(),
        differs: false,
        shown: line..line,
    };
    match block.language {
        Language::Script => vec![(step(block.line, &block.text), None)],
        Language::Console => {
            let mut steps: Vec<(Ran, Option<String>)> = Vec::new();
            for (number, line) in block.text.lines().enumerate() {
                match (line.strip_prefix("$ "), steps.last_mut()) {
                    (Some(command), _) => {
                        steps.push((step(block.line + number, command), Some(String::new())));
                    }
                    (None, Some((ran, Some(shown)))) => {
                        ran.shown.end += 1;
                        if shown.is_empty() && ran.command.ends_with('\\') {
                            ran.command += &format!("\n{}", line.strip_prefix("> ").unwrap_or(line));
                            ran.shown.start += 1;
                        } else {
                            *shown += &format!("{line}\n");
                        }
                    }
                    _ => {}
                }
            }
            steps
        }
        Language::Unrun | Language::Other => Vec::new(),
    }
}

/// The folders in which the shell looks for programs: ours first.
fn search_path(first: &Path) -> OsString {
    let others = env::var_os("PATH").unwrap_or_default();
    let folders = std::iter::once(PathBuf::from(first)).chain(env::split_paths(&others));
    env::join_paths(folders).unwrap_or_default()
}

#[cfg(unix)]
fn link(from: &Path, to: &Path) -> io::Result<()> {
    std::os::unix::fs::symlink(from, to)
}

#[cfg(not(unix))]
fn link(from: &Path, to: &Path) -> io::Result<()> {
    std::fs::copy(from, to).map(drop)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_run_in_one_folder_and_a_wrong_one_is_a_fault_with_its_place() {
        for (page, place) in [
            ("```sh\necho 1 > a\n```\n```console\n$ cat a\n1\n$ exit 3 # exit code 3\n```\n", None),
            ("```console\n$ echo \\\n>   a\na\n```\n", None),
            ("```sh,norun\nexit 7\n```\n", None),
            ("\n```sh\nno-such-program\n```\n", Some("page.md:3:")),
            ("```sh\nfalse\ntrue\n```\n", Some("page.md:2:")),
            ("```console\n$ true\n$ echo a\nb\n```\n", Some("page.md:3:")),
            ("```console\n$ echo a\n```\n", Some("page.md:2:")),
            ("```console\n$ true # exit code 1\n```\n", Some("page.md:2:")),
            ("```console\n$ cat missing | sort\n```\n", Some("page.md:2:")),
        ] {
            let chapter = Chapter { path: "page.md".into(), text: page.to_owned() };
            let faults = run(&chapter, &[], &[]).unwrap().faults;
            assert_eq!(faults.len(), usize::from(place.is_some()), "{page}: {faults:?}");
            assert!(faults.iter().zip(place).all(|(fault, place)| fault.starts_with(place)), "{faults:?}");
        }
    }
}
