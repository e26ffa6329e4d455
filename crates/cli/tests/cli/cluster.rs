//! The scripts in `examples/cluster`: what they merge is what a single process would have built.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Command, Output};

use canonform::mesh::shapes;

use crate::support::{Workplace, program};

/// Four small shapes, one that cannot be read, and the export of the index that a single process builds of them.
fn collection() -> (Workplace, String) {
    let place = Workplace::new();
    for i in 0..2 {
        place.add(&format!("meshes/ball{i}.off"), &shapes::icosphere(2));
        place.add(&format!("meshes/ring{i}.off"), &shapes::torus(14 + i, 8, 2.0, 0.6));
    }
    fs::write(place.path("meshes/ring4.off"), "OFF\n3 1 0\n0 0 0\n").unwrap();
    assert_eq!(place.run("index build meshes -o single.canonform -q").code, 2);
    let export = place.done("index export single.canonform").out;
    (place, export)
}

/// Runs a script of the folder with our program in front of the others.
fn script(place: &Workplace, arguments: &[&str]) -> Output {
    let scripts = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/cluster");
    let path = std::env::var("PATH").unwrap();
    let ours = Path::new(program()).parent().unwrap().display();
    let mut command = Command::new("bash");
    command.arg(scripts.join(arguments[0])).args(&arguments[1..]).current_dir(place.path(""));
    command.env("PATH", format!("{}:{ours}:{path}", place.path("bin").display())).env("JOBS", "2");
    command.output().unwrap()
}

/// What a script that must succeed prints.
fn done(place: &Workplace, arguments: &[&str]) -> String {
    let output = script(place, arguments);
    let text =
        String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {text}");
    text
}

fn fake(place: &Workplace, name: &str, text: &str) {
    let path = place.path("bin").join(name);
    fs::create_dir_all(place.path("bin")).unwrap();
    fs::write(&path, text).unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
}

#[test]
fn parallel_shards_merge_into_what_one_process_builds() {
    let (place, single) = collection();
    // With xargs, whatever is installed; more parts than shapes, so that some are empty and one has the bad mesh alone.
    fake(&place, "parallel", "#!/bin/sh\nexit 1\n");
    let printed = done(&place, &["parallel.sh", "meshes", "7", "many.canonform"]);
    assert!(printed.contains("4 shapes") && printed.contains("\"failed\""), "{printed}");
    assert_eq!(place.done("index export many.canonform").out, single);
    // A second run, with GNU parallel if it is installed, takes up what has changed.
    fs::remove_file(place.path("bin/parallel")).unwrap();
    fs::remove_file(place.path("meshes/ring0.off")).unwrap();
    done(&place, &["parallel.sh", "meshes", "7", "many.canonform"]);
    assert_eq!(place.json("index info many.canonform")["n_shapes"], 3);
}

#[test]
fn a_missing_part_is_not_merged() {
    let (place, single) = collection();
    for shard in ["1/3", "3/3"] {
        done(&place, &["shard.sh", "meshes", shard, "parts"]);
    }
    let refused = script(&place, &["merge.sh", "parts", "3", "index.canonform"]);
    let message = String::from_utf8(refused.stderr).unwrap();
    assert!(refused.status.code() == Some(2) && message.contains("part 2 of 3"), "{message}");
    assert!(!place.path("index.canonform").exists());
    // Wrong options are an error, even if the part is there.
    let refused = script(&place, &["shard.sh", "meshes", "1/3", "parts", "-n", "20"]);
    assert_eq!(refused.status.code(), Some(2), "{refused:?}");
    assert!(!place.path("parts/1.json").exists());
    for shard in ["1/3", "2/3"] {
        done(&place, &["shard.sh", "meshes", shard, "parts"]);
    }
    done(&place, &["merge.sh", "parts", "3", "index.canonform"]);
    assert_eq!(place.done("index export index.canonform").out, single);
    assert_eq!(fs::read_dir(place.path("parts")).unwrap().count(), 6, "a part and its report each");
}

#[test]
#[ignore = "slow: make test-all"]
fn a_slurm_array_builds_what_one_process_builds() {
    let (place, single) = collection();
    // Runs the tasks of an array at once, and a job that depends on it after them, as Slurm would: from a copy of the script.
    let sbatch = r#"#!/usr/bin/env bash
set -euo pipefail
tasks=0
while [[ $1 == --* ]]; do
    case $1 in --array=1-*%*) tasks=${1#--array=1-} ;; --dependency=afterok:7) [ -e array-done ] ;; esac
    shift
done
copy=$(mktemp); cp "$1" "$copy"; shift
for i in $(seq "${tasks%\%*}"); do SLURM_ARRAY_TASK_ID=$i SLURM_CPUS_PER_TASK=1 bash "$copy" "$@"; done
if [ "$tasks" = 0 ]; then bash "$copy" "$@" > merged.txt; else touch array-done; fi
echo "7;cluster"
"#;
    fake(&place, "sbatch", sbatch);
    let printed = done(&place, &["slurm.sh", "meshes", "4", "array.canonform"]);
    assert!(printed.contains("array 7, then merge 7"), "{printed}");
    assert_eq!(place.done("index export array.canonform").out, single);
}
