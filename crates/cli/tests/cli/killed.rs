//! Killed programs.

use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};

use canonform::index::{Index, log_path};
use testkit::tree;

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

fn is_leftover(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(".unfinished-"))
}

#[test]
#[ignore = "slow: make test-all"]
fn killed_commands_leave_whole_files_and_the_next_run_tidies_up() {
    let place = collection();
    place.add("a.off", &canonform::mesh::shapes::icosphere(5));
    place.add("b.off", &body(0, 3));
    place.done(build("all"));
    let commands = [
        "index export all -o out/all.jsonl",
        "embed a.off -o out/a.npy --stress skip",
        "embed a.off -o out/a.ply --stress skip",
        "embed meshes -n 20 -o out --format obj",
        "render a.off -o out/a.png",
        "compare a.off b.off -n 20 --residual-mesh out/residual.ply",
        "geodesic a.off --source 7 -o out/distances.npy",
        "geodesic b.off --all-pairs -o out/pairs.npy",
    ];
    let out = place.path("out");
    let turns = (3 * n_kills() / 4).div_ceil(commands.len() as u32);
    for command in commands {
        fs::create_dir(&out).unwrap();
        let start = Instant::now();
        place.done(command);
        let usual = start.elapsed();
        let whole = tree(&out);
        assert!(!whole.is_empty(), "{command:?}");
        for turn in 0..turns {
            fs::remove_dir_all(&out).unwrap();
            fs::create_dir(&out).unwrap();
            kill_after(&place, command, usual.mul_f64(f64::from(turn + 1) / f64::from(turns + 1)));
            for (path, bytes) in tree(&out) {
                assert!(is_leftover(&path) || whole.get(&path) == Some(&bytes), "{command:?}: {path:?}");
            }
            place.done(command);
            assert!(tree(&out) == whole, "{command:?}: {:?}", tree(&out).keys());
        }
        fs::remove_dir_all(&out).unwrap();
    }
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
