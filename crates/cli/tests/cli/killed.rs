//! Killed builds of an index, and full disks.

use std::fs;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use index::{Index, IndexWriter, Job, work_path};

use crate::index::body;
use crate::support::{Workplace, program};

const SHAPES: usize = 20;

fn collection() -> Workplace {
    let place = Workplace::new();
    (0..SHAPES).for_each(|i| place.add(&format!("meshes/s{i}.off"), &body(i % 3, i / 3)));
    place
}

fn build(output: &str) -> [&str; 9] {
    ["index", "build", "meshes", "-n", "20", "--threads", "1", "-o", output]
}

/// Number of shapes in the unfinished work of an index like `whole`.
fn kept(place: &Workplace, index: &str) -> usize {
    let work = place.path(&format!("{index}.work"));
    if !work.exists() {
        return 0;
    }
    // Works on a copy, which opening may change.
    let look = place.path("look");
    fs::copy(work, work_path(&look)).unwrap();
    let options = Index::open(&place.path("whole")).unwrap().options().to_owned();
    let writer = IndexWriter::open(&look, Job::Build, Some(&options)).unwrap();
    let n = writer.len().unwrap();
    writer.discard().unwrap();
    n
}

/// `CANONFORM_KILLS=50 cargo test -p canonform-cli killed` kills more often.
#[test]
fn a_killed_build_continues_and_loses_nothing() {
    let kills: u32 = std::env::var("CANONFORM_KILLS").ok().and_then(|n| n.parse().ok()).unwrap_or(8);
    let place = collection();
    let start = Instant::now();
    place.done(&build("whole"));
    let usual = start.elapsed();
    let whole = place.done(&["index", "export", "whole"]).out;
    let mut killed = 0;
    for round in 0.. {
        if killed >= kills {
            break;
        }
        // Kills several times in a row, at different moments, until the build is done.
        let index = format!("cut{round}");
        let mut before = 0;
        for turn in 0..4 {
            let mut child = Command::new(program())
                .args(build(&index))
                .current_dir(place.path(""))
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .spawn()
                .unwrap();
            let share = f64::from((7 * killed + 3 * turn) % 20) / 20.0;
            std::thread::sleep(usual.mul_f64(share * 0.9) + Duration::from_millis(u64::from(killed % 5)));
            child.kill().unwrap();
            killed += u32::from(!child.wait().unwrap().success());
            if place.path(&index).exists() {
                break;
            }
            let now = kept(&place, &index);
            assert!(now >= before, "{before} shapes were finished, {now} are left");
            before = now;
        }
        place.done(&build(&index));
        assert_eq!(place.done(&["index", "export", &index]).out, whole, "round {round}");
        assert!(!place.path(&format!("{index}.work")).exists());
    }
}

/// Runs the program with files limited to this many blocks of 512 bytes.
#[cfg(unix)]
fn run_limited(place: &Workplace, blocks: usize, arguments: &[&str]) -> (Option<i32>, String) {
    let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$@\"");
    let output = Command::new("bash")
        .args(["-c", &script, "bash", program()])
        .args(arguments)
        .current_dir(place.path(""))
        .output()
        .unwrap();
    (output.status.code(), String::from_utf8(output.stderr).unwrap())
}

#[cfg(unix)]
#[test]
fn a_full_disk_is_reported_and_the_old_index_stays() {
    let place = collection();
    place.done(&build("whole"));
    let whole = place.done(&["index", "export", "whole"]).out;
    place.add("meshes/t1.off", &body(1, 40));
    let old = fs::read(place.path("whole")).unwrap();
    let size = old.len() / 1024;
    for blocks in [1, size / 4, size / 2, size - 20, size] {
        let (code, err) = run_limited(&place, blocks, &build("whole"));
        assert_eq!(code, Some(2), "{blocks}: {err}");
        assert!(
            err.contains("cannot write whole.work") && err.contains("free some space"),
            "{blocks}: {err}"
        );
        assert_eq!(fs::read(place.path("whole")).unwrap(), old, "{blocks}");
    }
    // Without the limit the build continues.
    place.done(&build("whole"));
    fs::remove_file(place.path("meshes/t1.off")).unwrap();
    place.done(&build("whole"));
    assert_eq!(place.done(&["index", "export", "whole"]).out, whole);
}
