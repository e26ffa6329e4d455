//! A later run keeps what is finished.

use std::process::Command;

#[test]
fn a_later_run_keeps_what_is_made_with_its_options() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("out");
    let run = |more: &[&str]| -> (String, Vec<u8>) {
        let mut command = Command::new(env!("CARGO_BIN_EXE_experiments"));
        command.args(["run", "figure5a", "--families", "creatures:1x2", "--vertices", "1000", "--quiet"]);
        let output = command.args(more).arg("--output").arg(&folder).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{said}");
        (said, std::fs::read(folder.join("figure5a.json")).unwrap())
    };
    let (_, first) = run(&[]);
    let (said, kept) = run(&["--resume"]);
    assert!(said.contains("figure5a is there already") && kept == first, "{said}");
    let (said, other) = run(&["--resume", "--seed", "1"]);
    assert!(!said.contains("is there already") && other != first, "{said}");
}
