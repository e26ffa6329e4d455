//! Killed programs.

use std::process::Stdio;
use std::time::{Duration, Instant};

use canonform::index::log_path;

use crate::index::body;
use crate::support::Workplace;

/// Starts the program and kills it after `time`, unless it ends before. Returns whether it was killed.
fn kill_after(place: &Workplace, command: &str, time: Duration) -> bool {
    let mut child = place.command(command).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    std::thread::sleep(time);
    child.kill().unwrap();
    !child.wait().unwrap().success()
}

#[test]
fn a_killed_build_continues_and_loses_nothing() {
    // `make test-all` does it 200 times.
    let kills = std::env::var("CANONFORM_KILLS").map_or(3, |n| n.parse::<u32>().unwrap() / 4);
    let place = Workplace::new();
    (0..12).for_each(|i| place.add(&format!("meshes/s{i}.off"), &body(i % 3, i / 3)));
    let build = |index: &str| format!("index build meshes -n 20 --threads 1 -o {index}");
    let start = Instant::now();
    place.done(build("whole"));
    let usual = start.elapsed();
    let whole = place.done("index export whole").out;
    let (mut killed, mut has_continued) = (0, false);
    for round in 0.. {
        if killed >= kills {
            break;
        }
        // Kills several times in a row, at different moments.
        let index = format!("cut{round}");
        for turn in 0..4 {
            let share = f64::from((7 * killed + 3 * turn) % 20) / 20.0;
            let time = usual.mul_f64(share * 0.9) + Duration::from_millis(u64::from(killed % 5));
            killed += u32::from(kill_after(&place, &build(&index), time));
        }
        has_continued |= place.json(build(&index))["described"] != 12;
        assert_eq!(place.done(format!("index export {index}")).out, whole, "round {round}");
        assert!(!log_path(&place.path(&index)).exists(), "one file is left");
    }
    assert!(has_continued, "what was described before a kill is described again");
}
