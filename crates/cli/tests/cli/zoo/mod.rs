//! Broken meshes: what `info`, `embed` and `geodesic` make of each of them, held to the table in `tests/broken-meshes.tsv`.
//!
//! `CANONFORM_WRITE_DOCS=1 cargo test -p canonform-cli --test cli zoo` writes the table again.

mod defects;
mod file;
pub(crate) use file::off;
mod files;
mod numbers;

use std::fs;
use std::path::Path;

use serde_json::Value;

use self::file::BrokenFile;
use crate::support::{Outcome, Workplace, one_object};

/// All broken meshes, in the order of the table: damaged files, defects of the surface, limits of numbers.
fn broken_meshes() -> Vec<BrokenFile> {
    let mut all = files::damaged();
    all.extend(defects::defective());
    all.extend(numbers::extreme());
    all
}

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

#[test]
fn the_table_of_broken_meshes_is_true() {
    let place = Workplace::new();
    let mut table = HEAD.to_owned();
    let zoo = broken_meshes();
    assert!(zoo.len() >= 60, "{}", zoo.len());
    for file in &zoo {
        fs::write(place.path(file.name), &file.content).unwrap();
        let info = place.run(format!("info {} --json", file.name));
        let embed = place.run(format!("embed {} -n 20 -o form.npy --json", file.name));
        let geodesic = place.run(format!("geodesic {} --source 0 -o rows.npy --json", file.name));
        for outcome in [&info, &embed, &geodesic] {
            assert!((0..=2).contains(&outcome.code), "{}: {}: {}", file.name, outcome.code, outcome.err);
        }
        let report = one_object(&info.out);
        let meshes = report["meshes"].as_array().unwrap();
        let found = meshes.first().map_or_else(|| short(&info, file.name), found);
        let (exit, dropped) = if embed.code == 2 {
            let reason = short(&embed, file.name);
            let reason = if reason == found { String::new() } else { format!(": {reason}") };
            (format!("{}{reason}, {}", embed.code, geodesic.code), "-".to_owned())
        } else {
            let share = one_object(&embed.out)["repair"]["dropped_area_share"].as_f64().unwrap();
            let share = if share > 0.0 { format!("{:.1} %", 100.0 * share) } else { "-".to_owned() };
            (format!("{}, {}", embed.code, geodesic.code), share)
        };
        let exit = match geodesic.code {
            2 if embed.code != 2 => format!("{exit}: {}", short(&geodesic, file.name)),
            _ => exit,
        };
        table += &format!(
            "{}\t{}\t{found}\t{}\t{exit}\t{dropped}\n",
            file.name,
            file.defect,
            repaired(&embed, file.name)
        );
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/broken-meshes.tsv");
    if std::env::var_os("CANONFORM_WRITE_DOCS").is_some() {
        fs::write(&path, &table).unwrap();
    }
    let committed = fs::read_to_string(&path).unwrap_or_default();
    for (line, (expected, actual)) in committed.lines().zip(table.lines()).enumerate() {
        assert_eq!(expected, actual, "broken-meshes.tsv, line {}: write it again, see zoo/mod.rs", line + 1);
    }
    assert_eq!(committed.len(), table.len(), "broken-meshes.tsv lacks rows, see zoo/mod.rs");
}
