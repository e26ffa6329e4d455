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

/// A command and what the chapter shows of its output.
struct GuideStep {
    line: usize,
    command: String,
    shown: Option<String>,
    /// The lines of the chapter behind the command, counted from 0.
    lines: Range<usize>,
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
    for step in chapter.blocks().iter().flat_map(steps) {
        let mut command = Command::new("bash");
        command.current_dir(run.folder.path()).env("PATH", &path).env("LC_ALL", "C.UTF-8");
        let output =
            command.args(["-c", &format!("set -euo pipefail; exec 2>&1\n{}", step.command)]).output()?;
        let printed = String::from_utf8_lossy(&output.stdout).into_owned();
        let place = format!("{}:{}: `{}`", chapter.path.display(), step.line, step.command.trim());
        let expected = exit_code(&step.command);
        if output.status.code() != Some(expected) {
            run.faults.push(format!("{place} ended with {}, not {expected}:\n{printed}", output.status));
        }
        let differs = step.shown.as_ref().is_some_and(|shown| !matches(shown, &printed));
        if differs && output.status.code() == Some(expected) {
            run.faults.push(format!("{place} printed something else than the chapter shows:\n{printed}"));
        }
        run.ran.push(Ran { line: step.line, command: step.command, printed, differs, shown: step.lines });
    }
    Ok(run)
}

/// The exit code that a command announces in a comment.
fn exit_code(command: &str) -> i32 {
    let comment = command.trim_end().rsplit_once("# exit code ");
    comment.and_then(|(_, code)| code.trim().parse().ok()).unwrap_or(0)
}

fn steps(block: &CodeBlock) -> Vec<GuideStep> {
    match block.language {
        Language::Script => {
            vec![GuideStep { line: block.line, command: block.text.clone(), shown: None, lines: 0..0 }]
        }
        Language::Console => {
            let mut steps: Vec<GuideStep> = Vec::new();
            for (number, line) in block.text.lines().enumerate() {
                match (line.strip_prefix("$ "), steps.last_mut()) {
                    (Some(command), _) => {
                        let next = block.line + number;
                        let (command, shown) = (command.to_owned(), Some(String::new()));
                        steps.push(GuideStep { line: next, command, shown, lines: next..next });
                    }
                    (None, Some(GuideStep { command, shown: Some(shown), lines, .. })) => {
                        lines.end += 1;
                        if shown.is_empty() && command.ends_with('\\') {
                            *command += &format!("\n{}", line.strip_prefix("> ").unwrap_or(line));
                            lines.start += 1;
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

    fn faults(text: &str) -> Vec<String> {
        run(&Chapter { path: "page.md".into(), text: text.to_owned() }, &[], &[]).unwrap().faults
    }

    #[test]
    fn commands_run_in_one_folder_and_their_output_is_compared() {
        let page = "```sh\necho 1 > a\n```\n```console\n$ cat a\n1\n$ wc -l \\\n>   a\n1 a\n$ exit 3 # exit code 3\n```\n";
        assert!(faults(page).is_empty(), "{:?}", faults(page));
        assert!(faults("```sh,norun\nexit 7\n```\n").is_empty());
    }

    #[test]
    fn a_wrong_command_is_a_fault_with_its_place() {
        for (page, place) in [
            ("\n```sh\nno-such-program\n```\n", "page.md:3:"),
            ("```sh\nfalse\ntrue\n```\n", "page.md:2:"),
            ("```console\n$ true\n$ echo a\nb\n```\n", "page.md:3:"),
            ("```console\n$ echo a\n```\n", "page.md:2:"),
            ("```console\n$ true # exit code 1\n```\n", "page.md:2:"),
            ("```console\n$ cat missing | sort\n```\n", "page.md:2:"),
        ] {
            let faults = faults(page);
            assert_eq!(faults.len(), 1, "{page}: {faults:?}");
            assert!(faults[0].starts_with(place), "{faults:?}");
        }
    }
}
