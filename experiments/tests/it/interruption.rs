//! An interrupted run keeps what is finished, and a later one continues it.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

fn command(folder: &Path, more: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_experiments"));
    command.args(["run", "figure1", "scaling", "--vertices", "1000", "--quiet", "--output"]).arg(folder);
    command.args(more);
    command
}

/// Interrupts a run once it has written a file.
fn interrupted_after(mut run: Child, file: &Path) -> Output {
    let start = Instant::now();
    while !file.exists() {
        assert!(start.elapsed() < Duration::from_secs(300), "{} does not appear", file.display());
        assert!(run.try_wait().unwrap().is_none(), "the run ended");
        std::thread::sleep(Duration::from_millis(50));
    }
    // The record of the first experiment is the last of its files.
    std::thread::sleep(Duration::from_millis(200));
    interrupted(run)
}

fn interrupted(run: Child) -> Output {
    assert!(Command::new("kill").args(["-INT", &run.id().to_string()]).status().unwrap().success());
    run.wait_with_output().unwrap()
}

/// What a run says in some seconds, after which it is interrupted.
fn said_in(seconds: u64, folder: &Path, more: &[&str]) -> String {
    let run = command(folder, more).stderr(Stdio::piped()).spawn().unwrap();
    std::thread::sleep(Duration::from_secs(seconds));
    String::from_utf8_lossy(&interrupted(run).stderr).into_owned()
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_keeps_what_is_finished_and_can_be_continued() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("interrupted");
    let _ = std::fs::remove_dir_all(&folder);
    let record = folder.join("figure1.json");
    let run = command(&folder, &[]).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let output = interrupted_after(run, &record);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(130), "{said}");
    assert!(
        said.contains("finished: figure1")
            && said.contains("run figure1 scaling")
            && said.contains("--resume"),
        "{said}"
    );
    let page = std::fs::read_to_string(folder.join("report.html")).unwrap();
    assert!(page.contains("Not run: ") && page.contains("href=\"figure1-forms.svg\""));
    let names = || std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name());
    assert!(names().all(|name| !name.to_string_lossy().starts_with(".unfinished")));

    // The second run keeps the first experiment: its record does not change.
    let before = std::fs::metadata(&record).unwrap().modified().unwrap();
    let said = said_in(2, &folder, &["--resume"]);
    assert!(said.contains("figure1 is there already"), "{said}");
    assert_eq!(std::fs::metadata(&record).unwrap().modified().unwrap(), before);

    // Other options make another record.
    let said = said_in(1, &folder, &["--resume", "--seed", "1"]);
    assert!(!said.contains("is there already"), "{said}");
}
