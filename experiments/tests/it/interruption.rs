//! Interrupted runs: what is finished stays, and a later run continues.

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

/// Names of experiments and options; the first experiment takes seconds, `scaling` takes minutes.
fn run(folder: &Path, more: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_experiments"));
    command.args(["run", "figure5a", "--families", "creatures:1x2", "--vertices", "1000", "--quiet"]);
    command.args(more).arg("--output").arg(folder).stdout(Stdio::null()).stderr(Stdio::piped());
    command
}

/// Runs a command until a condition holds, and interrupts it.
#[cfg(unix)]
fn interrupted(mut command: Command, is_time: impl FnOnce(&mut std::process::Child)) -> Output {
    let mut run = command.spawn().unwrap();
    is_time(&mut run);
    assert!(run.try_wait().unwrap().is_none(), "the run ended");
    assert!(Command::new("kill").args(["-INT", &run.id().to_string()]).status().unwrap().success());
    run.wait_with_output().unwrap()
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_keeps_what_is_finished_and_can_be_continued() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("out");
    let record = folder.join("figure5a.json");
    let output = interrupted(run(&folder, &["scaling"]), |run| {
        let start = Instant::now();
        while !record.exists() {
            assert!(start.elapsed() < Duration::from_secs(300), "{} does not appear", record.display());
            assert!(run.try_wait().unwrap().is_none(), "the run ended");
            std::thread::sleep(Duration::from_millis(20));
        }
        // The record of the first experiment is the last of its files.
        std::thread::sleep(Duration::from_millis(200));
    });
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(130), "{said}");
    for words in ["finished: figure5a", "run figure5a scaling", "--resume"] {
        assert!(said.contains(words), "{said}");
    }
    let page = fs::read_to_string(folder.join("report.html")).unwrap();
    assert!(page.contains("Not run: ") && page.contains("href=\"figure5a-curves.svg\""));
    assert!(names(&folder).iter().all(|name| !name.starts_with(".unfinished")));

    // The second run keeps the first experiment: its record does not change.
    let before = fs::metadata(&record).unwrap().modified().unwrap();
    let mut said = String::new();
    interrupted(run(&folder, &["scaling", "--resume"]), |run| {
        BufReader::new(run.stderr.take().unwrap()).read_line(&mut said).unwrap();
    });
    assert!(said.contains("figure5a is there already"), "{said}");
    assert_eq!(fs::metadata(&record).unwrap().modified().unwrap(), before);

    // With other options it is run again.
    let output = interrupted(run(&folder, &["--resume", "--seed", "1"]), |_| {
        std::thread::sleep(Duration::from_secs(1));
    });
    assert!(!String::from_utf8_lossy(&output.stderr).contains("is there already"));
}
