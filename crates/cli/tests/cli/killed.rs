//! Killed programs.

use std::fs;
use std::process::Stdio;
use std::time::{Duration, Instant};

use canonform::index::{Index, log_path};

use crate::index::body;
use crate::support::Workplace;

const SHAPES: usize = 12;

fn collection() -> Workplace {
    let place = Workplace::new();
    (0..SHAPES).for_each(|i| place.add(&format!("meshes/s{i}.off"), &body(i % 3, i / 3)));
    place
}

fn build(output: &str) -> String {
    format!("index build meshes -n 20 --threads 1 -o {output}")
}

/// Number of shapes in an index, and whether it is finished.
fn kept(place: &Workplace, index: &str) -> (usize, bool) {
    let path = place.path(index);
    if !path.exists() {
        return (0, false);
    }
    // Works on a copy, which opening may change.
    let look = place.path("look");
    fs::copy(&path, &look).unwrap();
    let _ = fs::copy(log_path(&path), log_path(&look));
    let found = Index::open(&look).map_or((0, false), |index| (index.len(), index.is_finished));
    let _ = fs::remove_file(log_path(&look));
    found
}

/// How often programs are killed; `make test-all` does it 200 times.
fn n_kills() -> u32 {
    std::env::var("CANONFORM_KILLS").ok().and_then(|n| n.parse().ok()).unwrap_or(12)
}

/// Starts the program and kills it after `time`, unless it ends before. Returns whether it was killed.
fn kill_after(place: &Workplace, command: &str, time: Duration) -> bool {
    let mut child = place.command(command).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    std::thread::sleep(time);
    child.kill().unwrap();
    !child.wait().unwrap().success()
}

#[test]
fn a_killed_build_continues_and_loses_nothing() {
    let kills = n_kills() / 4;
    let place = collection();
    let start = Instant::now();
    place.done(build("whole"));
    let usual = start.elapsed();
    let whole = place.done("index export whole").out;
    let mut killed = 0;
    for round in 0.. {
        if killed >= kills {
            break;
        }
        // Kills several times in a row, at different moments, until the build is done.
        let index = format!("cut{round}");
        let mut before = 0;
        for turn in 0..4 {
            let share = f64::from((7 * killed + 3 * turn) % 20) / 20.0;
            let time = usual.mul_f64(share * 0.9) + Duration::from_millis(u64::from(killed % 5));
            killed += u32::from(kill_after(&place, &build(&index), time));
            let (now, is_finished) = kept(&place, &index);
            if is_finished {
                break;
            }
            assert!(now >= before, "{before} shapes were finished, {now} are left");
            before = now;
        }
        place.done(build(&index));
        assert_eq!(place.done(format!("index export {index}")).out, whole, "round {round}");
        assert!(!log_path(&place.path(&index)).exists(), "one file is left");
    }
}
