//! Killed programs, and full disks.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use canonform::index::{Index, log_path};

use crate::hostile::tree;
use crate::index::body;
use crate::support::{Workplace, program};

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
    let found = Index::open(&look).map_or((0, false), |index| (index.len(), index.is_finished()));
    let _ = fs::remove_file(log_path(&look));
    found
}

/// How often programs are killed; `make test-all` does it 200 times.
fn n_kills() -> u32 {
    std::env::var("CANONFORM_KILLS").ok().and_then(|n| n.parse().ok()).unwrap_or(12)
}

/// Starts the program and kills it after `time`, unless it ends before. Returns whether it was killed.
fn kill_after(place: &Workplace, command: &str, time: Duration) -> bool {
    let mut child = Command::new(program())
        .args(command.split(' '))
        .current_dir(place.path(""))
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    std::thread::sleep(time);
    child.kill().unwrap();
    !child.wait().unwrap().success()
}

/// The shapes of an export.
fn lines(export: &str) -> BTreeSet<&str> {
    export.lines().skip(1).collect()
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
fn a_killed_change_leaves_the_old_index_or_the_new_one() {
    let place = collection();
    place.done(build("whole"));
    (0..6).for_each(|i| place.add(&format!("more/t{i}.off"), &body(i % 3, 30 + i)));
    let changes =
        ["index add all more --threads 1", "index add all more/t0.off --threads 1", "index remove all s3 s7"];
    let turns = (n_kills() / 4).div_ceil(3);
    for change in changes {
        let renew = || fs::copy(place.path("whole"), place.path("all")).unwrap();
        let export = || place.done("index export all").out;
        renew();
        let before = export();
        let start = Instant::now();
        place.done(change);
        let usual = start.elapsed();
        let after = export();
        for turn in 0..turns {
            renew();
            kill_after(&place, change, usual.mul_f64(f64::from(turn + 1) / f64::from(turns + 1)));
            place.done("index verify all");
            // Every shape of the old index and of the new one is whole, and the same work can be done again.
            let now = export();
            let [old, new, kept] = [&before, &after, &now].map(|text| lines(text));
            assert!(kept.iter().all(|line| old.contains(line) || new.contains(line)), "{change:?}");
            assert!(old.intersection(&new).all(|line| kept.contains(line)), "{change:?}: a shape is lost");
            if now != after {
                place.done(change);
            }
            assert_eq!(export(), after, "{change:?}");
        }
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

/// Runs the program with files limited to this many blocks of 512 bytes.
#[cfg(unix)]
fn run_limited(place: &Workplace, blocks: usize, command: &str) -> (Option<i32>, String) {
    let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$@\"");
    let output = Command::new("bash")
        .args(["-c", &script, "bash", program()])
        .args(command.split(' '))
        .current_dir(place.path(""))
        .output()
        .unwrap();
    (output.status.code(), String::from_utf8(output.stderr).unwrap())
}

#[cfg(unix)]
#[test]
fn a_full_disk_is_reported_and_the_old_index_stays() {
    let place = collection();
    place.done(build("whole"));
    let whole = place.done("index export whole").out;
    place.add("meshes/s99.off", &body(1, 40));
    let size = fs::metadata(place.path("whole")).unwrap().len() as usize / 512;
    let mut failures = 0;
    for blocks in [1, 70, size / 2, size - 20] {
        let (code, err) = run_limited(&place, blocks, &build("whole"));
        // What is committed may stay in the log, if only the file itself cannot grow.
        if code != Some(0) {
            assert_eq!(code, Some(2), "{blocks}: {err}");
            assert!(err.contains("cannot write whole") && err.contains("free some space"), "{blocks}: {err}");
            failures += 1;
        }
        place.done("index verify whole");
        let now = place.done("index export whole").out;
        assert!(lines(&whole).is_subset(&lines(&now)), "{blocks}: a shape is lost");
    }
    assert!(failures > 1, "{failures}");
    // Without the limit the build continues.
    place.done(build("whole"));
    fs::remove_file(place.path("meshes/s99.off")).unwrap();
    place.done(build("whole"));
    assert_eq!(place.done("index export whole").out, whole);
}
