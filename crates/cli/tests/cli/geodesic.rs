//! `geodesic`: sources, limits, paths, all pairs, interruption.

use std::fs;
use std::time::Duration;

use canonform::mesh::{TriMesh, shapes};
use canonform::surface::VertexId;
use nalgebra::Point3;

use crate::support::{Workplace, assert_keys, broken_ring, program, read_npy, ring};

/// A sheet of 9 x 7 vertices after a small component, which is dropped: vertex 0 of the sheet is vertex 9 of the file,
/// face 0 is face 8.
fn sheet() -> TriMesh {
    let mut small = shapes::grid(3, 3, 0.01);
    small.positions.iter_mut().for_each(|p| p.z += 5.0);
    shapes::disjoint(&[small, shapes::jittered_grid(9, 7, 1.0, 0.2, 3)])
}

fn place() -> Workplace {
    let place = Workplace::new();
    place.add("sheet.off", &sheet());
    place
}

/// Distances on the flat sheet equal straight-line distances.
fn assert_measured_from(row: &[f64], from: &Point3<f64>) {
    for (v, (distance, at)) in row.iter().zip(&sheet().positions).enumerate() {
        let expected = if v < 9 { f64::INFINITY } else { (at - from).norm() };
        assert!((distance - expected).abs() < 1e-12 || *distance == expected, "{v}: {distance} {expected}");
    }
}

#[test]
fn sources_use_the_numbers_of_the_input() {
    let place = place();
    let mesh = sheet();
    let at = |v: usize| mesh.positions[v].coords;
    let [a, b, c] = mesh.faces[20].map(|v| v.index());
    let edge = format!("{a}-{b}@0.25");
    let back = format!("{b}-{a}@0.75");
    let sources = format!("30,{edge},{back},{a}-{b},f20@1:2:5,f20");
    let json =
        place.json(&["geodesic", "sheet.off", "--source", &sources, "--method", "exact", "-o", "d.npy"]);
    let middle = format!("{a}-{b}@0.5");
    assert_eq!(json["sources"], serde_json::json!([30, edge, back, middle, "f20@1:2:5", "f20@1:1:1"]));
    let (shape, rows) = read_npy(&place.path("d.npy"));
    assert_eq!(shape, [6, 72]);
    let quarter = at(a) * 0.75 + at(b) * 0.25;
    let expected = [
        at(30),
        quarter,
        quarter,
        (at(a) + at(b)) / 2.0,
        (at(a) + at(b) * 2.0 + at(c) * 5.0) / 8.0,
        (at(a) + at(b) + at(c)) / 3.0,
    ];
    for (row, expected) in rows.chunks(72).zip(expected) {
        assert_measured_from(row, &Point3::from(expected));
    }
}

#[test]
fn the_nearest_of_several_sources_is_one_row() {
    let place = place();
    let run = |options: &[&str]| {
        let words = ["geodesic", "sheet.off", "--source", "9,f60,71", "--method", "exact"];
        place.json(&[&words, options].concat())
    };
    let json = run(&["--nearest", "-o", "near.npy"]);
    assert_eq!(json["seconds"]["per_source"].as_array().unwrap().len(), 1);
    let (shape, near) = read_npy(&place.path("near.npy"));
    assert_eq!((shape, near[9], near[71]), (vec![1, 72], 0.0, 0.0));
    run(&["--nearest", "-o", "near.ply"]);
    run(&["-o", "each.ply"]);
    assert!(["each-9.ply", "each-71.ply", "each-f60@1_1_1.ply"].iter().all(|name| place.path(name).exists()));
    let text = place.done("geodesic sheet.off --source 9,71 --nearest -o n.csv").out;
    assert!(text.contains("nearest of 2 sources") && text.lines().count() <= 5, "{text}");
}

#[test]
fn beyond_a_limit_distances_are_infinite_and_counted() {
    let place = place();
    let json = place.json("geodesic sheet.off --source 40,9 --max-distance 2.5 -o near.npy");
    let (_, near) = read_npy(&place.path("near.npy"));
    assert!(near.iter().all(|d| *d <= 2.5 || d.is_infinite()));
    let beyond =
        [0, 1].map(|row| near[row * 72 + 9..(row + 1) * 72].iter().filter(|d| d.is_infinite()).count());
    assert_eq!(json["beyond"], serde_json::json!(beyond));
    assert_eq!(json["unreached"], serde_json::json!((0..9).collect::<Vec<_>>()));
}

#[test]
fn errors_name_missing_points() {
    let place = Workplace::new();
    let mut mesh = broken_ring();
    // Face 328 is degenerate.
    mesh.faces.push([3, 3, 4].map(VertexId));
    fs::write(place.path("a.off"), crate::zoo::off(&mesh)).unwrap();
    let before = place.names();
    for (point, words) in [
        ("170", &["a.off: vertex 170", "170 vertices, counted from 0"][..]),
        ("160", &["a.off: vertex 160", "left out", "--components bridge"]),
        ("f328", &["a.off: face 328", "left out", "--components bridge"]),
        ("f321", &["a.off: face 321", "left out"]),
        ("f999", &["a.off: face 999", "329 faces"]),
        ("0-80@0.5", &["a.off: edge 0-80 does not exist"]),
        ("161-162", &["vertex 161", "left out"]),
        ("seven", &["`seven`", "17-42@0.3"]),
        ("3@0.5", &["`3@0.5`"]),
        ("3-4@1.5", &["`3-4@1.5`"]),
        ("3-3", &["`3-3`"]),
        ("3-4@nan", &["`3-4@nan`"]),
        ("f3@1:1", &["`f3@1:1`"]),
        ("f3@0:0:0", &["`f3@0:0:0`"]),
        ("f3@1:-1:1", &["`f3@1:-1:1`"]),
        ("f3@1:1:1:1", &["`f3@1:1:1:1`"]),
        ("-4", &["-4"]),
    ] {
        place.refused(&["geodesic", "a.off", "--source", point, "-o", "d.npy"], words);
    }
    for (point, words) in [("160", "a.off: vertex 160"), ("3-4@nan", "`3-4@nan`")] {
        place.refused(&["geodesic", "a.off", "--source", "0", "--path-to", point, "-o", "p.obj"], &[words]);
    }
    for (options, words) in [
        ("--source 0 --max-distance nan", &["`nan`", "mesh units"][..]),
        ("--all-pairs --source 0", &["--all-pairs", "--source"]),
        ("--all-pairs --nearest", &["--all-pairs", "--nearest"]),
        ("--all-pairs --memory 1", &["a.off", "170 vertices", "2720 bytes", "--memory"]),
        ("--all-pairs --memory much", &["`much`", "2G"]),
        ("--source 0 --path-to 80 --max-distance 0.1", &["d.npy", ".obj, .ply, .csv or .json"]),
    ] {
        let options: Vec<&str> = options.split(' ').collect();
        place.refused(&[&["geodesic", "a.off", "-o", "d.npy"], &options[..]].concat(), words);
    }
    place.refused(
        "geodesic a.off --source 0 --path-to 80 --max-distance 0.1 -o p.obj",
        &["a.off: there is no path", "to 80", "--max-distance"],
    );
    place.refused("geodesic a.off --all-pairs -o d.csv", &["d.csv", "use .npy"]);
    assert_eq!(place.names(), before);
}

#[test]
fn paths_are_straight_lines_in_every_format() {
    let place = place();
    let mesh = sheet();
    let words =
        ["geodesic", "sheet.off", "--source", "9,f20", "--path-to", "71,10-19@0.5", "--method", "exact"];
    let json = place.json(&[&words[..], &["-o", "p.json"]].concat());
    assert_keys(&json, "method sources targets paths path_seconds seconds repair");
    let paths = json["paths"].as_array().unwrap();
    assert_eq!(paths.len(), 4);
    assert_eq!((&paths[1]["source"], &paths[1]["target"]), (&9.into(), &"10-19@0.5".into()));
    let corner = (mesh.positions[71] - mesh.positions[9]).norm();
    for field in ["length", "distance"] {
        assert!((paths[0][field].as_f64().unwrap() - corner).abs() < 1e-12);
    }
    assert!(paths[1]["distance"].is_null());

    let file: serde_json::Value = serde_json::from_slice(&fs::read(place.path("p.json")).unwrap()).unwrap();
    for (path, known) in file["paths"].as_array().unwrap().iter().zip(paths) {
        let points = path["points"].as_array().unwrap();
        assert_eq!(points.len() as u64, known["n_points"].as_u64().unwrap());
        assert_eq!(points[0]["at"], known["source"]);
        let last = &points[points.len() - 1];
        assert_eq!((&last["at"], points[0]["distance"].as_f64()), (&known["target"], Some(0.0)));
        let length = known["length"].as_f64().unwrap();
        assert!((last["distance"].as_f64().unwrap() - length).abs() < 1e-12);
    }
    // The written place of a point is accepted as a source.
    let points = file["paths"][0]["points"].as_array().unwrap();
    let middle = points[points.len() / 2]["at"].to_string().replace('"', "");
    place.done(&["geodesic", "sheet.off", "--source", &middle, "-o", "d.npy"]);
    place.done(&[&words[..], &["-o", "p.csv"]].concat());
    let text = fs::read_to_string(place.path("p.csv")).unwrap();
    let n_points: u64 = paths.iter().map(|path| path["n_points"].as_u64().unwrap()).sum();
    assert!(text.starts_with("path,x,y,z,distance,at\n0,"));
    assert_eq!(text.lines().count() as u64, n_points + 1);
    place.done(&[&words[..], &["-o", "p.obj"]].concat());
    let text = fs::read_to_string(place.path("p.obj")).unwrap();
    assert_eq!(text.lines().filter(|line| line.starts_with("l ")).count(), 4);
    place.done(&[&words[..], &["-o", "p.ply"]].concat());
    assert!(fs::read(place.path("p.ply")).unwrap().starts_with(b"ply\n"));

    let json = place.json(&[&words[..], &["--nearest", "-o", "p.json"]].concat());
    assert_eq!(json["paths"].as_array().unwrap().len(), 2);
    assert_eq!(json["paths"][0]["source"], "f20@1:1:1");
    assert_eq!(json["paths"][1]["source"], 9);
}

#[test]
fn all_pairs_are_the_same_for_any_memory_and_threads() {
    let place = Workplace::new();
    place.add("broken.off", &broken_ring());
    let json = place.json("geodesic broken.off --all-pairs -o all.npy");
    assert_keys(&json, "method n_vertices asymmetry seconds unreached repair");
    assert!(json["asymmetry"]["largest"].as_f64() >= json["asymmetry"]["mean"].as_f64());
    let (shape, pairs) = read_npy(&place.path("all.npy"));
    assert_eq!(shape, [170, 170]);
    assert!((0..170).all(|i| pairs[i].is_finite() == (i < 160)));
    let bytes = fs::read(place.path("all.npy")).unwrap();
    for (memory, threads) in [("3K", "1"), ("100k", "3")] {
        let limits = format!("--memory {memory} --threads {threads}");
        place.done(format!("geodesic broken.off --all-pairs -o again.npy {limits}"));
        assert!(fs::read(place.path("again.npy")).unwrap() == bytes, "{memory} {threads}");
    }
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_leaves_nothing_behind() {
    let place = Workplace::new();
    // All pairs of these would be 3 GB.
    place.add("big.off", &shapes::torus(200, 100, 2.0, 0.6));
    fs::create_dir(place.path("tmp")).unwrap();
    let n_files = |folder: &str| fs::read_dir(place.path(folder)).unwrap().count();
    for (signal, output, folder) in [("-TERM", "all.npy", "."), ("-INT", "-", "tmp")] {
        let before = n_files(folder);
        let mut child = std::process::Command::new(program())
            .current_dir(place.path(""))
            .env("TMPDIR", place.path("tmp"))
            .args(["geodesic", "big.off", "--all-pairs", "--memory", "4M", "-o", output])
            .stdout(std::process::Stdio::null())
            .stderr(std::process::Stdio::piped())
            .spawn()
            .unwrap();
        while n_files(folder) == before {
            assert!(child.try_wait().unwrap().is_none());
            std::thread::sleep(Duration::from_millis(10));
        }
        let sent = std::process::Command::new("kill").args([signal, &child.id().to_string()]).status();
        assert!(sent.unwrap().success());
        let ended = child.wait_with_output().unwrap();
        assert_eq!(ended.status.code(), Some(130), "{signal}");
        let said = String::from_utf8_lossy(&ended.stderr);
        assert!(said.ends_with("interrupted\n") && !said.contains("error"), "{signal}: {said}");
        assert_eq!(n_files(folder), before, "{signal}");
    }
}

#[test]
fn a_path_over_a_bridge_joins_two_components() {
    let place = place();
    let words = ["geodesic", "sheet.off", "--components", "bridge", "--source", "40", "--path-to", "4"];
    let json = place.json(&[&words[..], &["-o", "p.csv"]].concat());
    let [length, distance] = ["length", "distance"].map(|field| json["paths"][0][field].as_f64().unwrap());
    assert!((length / distance - 1.0).abs() < 0.01 && length.is_finite());
    // A connected mesh has a path to every point.
    place.add("ring.off", &ring());
    place.done("geodesic ring.off --source 0 --path-to 0,80 -o p.obj");
}
