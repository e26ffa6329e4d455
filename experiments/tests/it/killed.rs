//! Killed runs of experiments: results are whole or absent, and the next run works.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;

fn run(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_experiments"));
    command.args(["run", "figure1", "--vertices", "1000", "--quiet", "--output", "out"]).current_dir(folder);
    command.stdout(Stdio::null()).stderr(Stdio::null());
    command
}

#[test]
fn a_killed_run_leaves_whole_results_and_the_next_run_works() {
    let kills: u32 = std::env::var("CANONFORM_KILLS").ok().and_then(|n| n.parse().ok()).unwrap_or(12);
    let kills = kills.div_ceil(24);
    let place = tempfile::tempdir().unwrap();
    let out = place.path().join("out");
    let start = Instant::now();
    assert!(run(place.path()).status().unwrap().success());
    let usual = start.elapsed();
    let names = |folder: &Path| -> Vec<String> {
        let entries = std::fs::read_dir(folder).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    };
    let whole = names(&out);
    for turn in 0..kills {
        std::fs::remove_dir_all(&out).unwrap();
        let mut child = run(place.path()).spawn().unwrap();
        std::thread::sleep(usual.mul_f64(f64::from(turn + 1) / f64::from(kills + 1)));
        child.kill().unwrap();
        child.wait().unwrap();
        if out.exists() {
            for name in names(&out).iter().filter(|name| name.ends_with(".json") && !name.starts_with('.')) {
                let text = std::fs::read(out.join(name)).unwrap();
                assert!(serde_json::from_slice::<serde_json::Value>(&text).is_ok(), "{name}");
            }
        }
        assert!(run(place.path()).status().unwrap().success());
        assert_eq!(names(&out), whole);
    }
}
