//! Broken meshes: what `info`, `embed` and `geodesic` make of each of them, held to `tests/contracts/broken-meshes.tsv`. To add
//! one, put its file into `tests/contracts/meshes` and a row with its name and its defect into the table.
//!
//! `CANONFORM_WRITE_DOCS=1 cargo test -p canonform-cli --test cli zoo` writes the rest of the table again.

use std::fs;
use std::path::Path;

use rayon::prelude::*;
use serde_json::Value;

use crate::support::{Outcome, Workplace, one_object};

/// The columns of the table. The exit codes are those of `embed -n 20` and `geodesic --source 0`, with the message of an error.
const HEAD: &str =
    "mesh\tdefect\tfound by info\trepaired\texit of embed, geodesic\tdropped share of the area\n";

/// The message of an error without the name of the file, which is in the row.
fn short(outcome: &Outcome, name: &str) -> String {
    let line = outcome.err.lines().find_map(|line| line.strip_prefix("error: ")).unwrap_or_default();
    line.replacen(&format!("{name}, "), "", 1).replacen(&format!("{name}: "), "", 1)
}

/// What `info` found.
fn found(info: &Value) -> String {
    let mesh = &info["mesh"];
    let mut facts = vec![format!("vertices: {}, faces: {}", mesh["n_vertices"], mesh["n_faces"])];
    let count = |name: &str| mesh[name].as_u64().unwrap_or(0);
    if count("n_components") > 1 {
        facts.push(format!("components: {}", count("n_components")));
    }
    for (key, name) in [
        ("n_boundary_loops", "boundary loops"),
        ("degenerate_faces", "degenerate faces"),
        ("duplicate_faces", "duplicate faces"),
        ("zero_area_faces", "faces without area"),
        ("unreferenced_vertices", "stray vertices"),
        ("duplicate_vertices", "duplicate vertices"),
        ("non_manifold_edges", "non-manifold edges"),
        ("non_manifold_vertices", "non-manifold vertices"),
        ("flipped_faces", "flipped faces"),
    ] {
        if count(key) > 0 {
            facts.push(format!("{name}: {}", count(key)));
        }
    }
    if mesh["orientable"] == false {
        facts.push("not orientable".to_owned());
    }
    facts.join(", ")
}

/// The lines on standard error about a repair, without the name of the file.
fn repaired(outcome: &Outcome, name: &str) -> String {
    let lines = outcome.err.lines().filter_map(|line| line.strip_prefix(&format!("{name}: ")));
    let lines: Vec<&str> = lines.filter(|line| !line.contains("no positive eigenvalue")).collect();
    if lines.is_empty() { "-".to_owned() } else { lines.join("; ") }
}

/// The row of a mesh of the folder.
fn row(place: &Workplace, name: &str, defect: &str) -> String {
    let info = place.run(format!("info {name} --json"));
    let embed = place.run(format!("embed {name} -n 20 -o {name}.npy --json"));
    let geodesic = place.run(format!("geodesic {name} --source 0 -o {name}.csv --json"));
    for outcome in [&info, &embed, &geodesic] {
        assert!((0..=2).contains(&outcome.code), "{name}: {}: {}", outcome.code, outcome.err);
    }
    let report = one_object(&info.out);
    let meshes = report["meshes"].as_array().unwrap();
    let found = meshes.first().map_or_else(|| short(&info, name), found);
    let (exit, dropped) = if embed.code == 2 {
        let reason = short(&embed, name);
        let reason = if reason == found { String::new() } else { format!(": {reason}") };
        (format!("{}{reason}, {}", embed.code, geodesic.code), "-".to_owned())
    } else {
        let share = one_object(&embed.out)["repair"]["dropped_area_share"].as_f64().unwrap();
        let share = if share > 0.0 { format!("{:.1} %", 100.0 * share) } else { "-".to_owned() };
        (format!("{}, {}", embed.code, geodesic.code), share)
    };
    let exit = match geodesic.code {
        2 if embed.code != 2 => format!("{exit}: {}", short(&geodesic, name)),
        _ => exit,
    };
    format!("{name}\t{defect}\t{found}\t{}\t{exit}\t{dropped}\n", repaired(&embed, name))
}

#[test]
fn the_table_of_broken_meshes_is_true() {
    let contracts = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/contracts");
    let path = contracts.join("broken-meshes.tsv");
    let committed = fs::read_to_string(&path).unwrap();
    let names: Vec<(&str, &str)> =
        committed.lines().skip(1).map(|row| row.split_once('\t').unwrap()).collect();
    let place = Workplace::new();
    for file in fs::read_dir(contracts.join("meshes")).unwrap().map(Result::unwrap) {
        let name = file.file_name().into_string().unwrap();
        assert!(names.iter().any(|(other, _)| *other == name), "{name} is not in the table");
        fs::copy(file.path(), place.path(&name)).unwrap();
    }
    let rows = names.par_iter().map(|(name, rest)| row(&place, name, rest.split('\t').next().unwrap()));
    let table = HEAD.to_owned() + &rows.collect::<Vec<_>>().concat();
    if std::env::var_os("CANONFORM_WRITE_DOCS").is_some() {
        fs::write(&path, &table).unwrap();
    }
    for (line, (expected, actual)) in committed.lines().zip(table.lines()).enumerate() {
        assert_eq!(expected, actual, "broken-meshes.tsv, line {}: write it again, see zoo.rs", line + 1);
    }
    assert!(names.len() > 70 && committed.len() == table.len(), "{} rows", names.len());
}
