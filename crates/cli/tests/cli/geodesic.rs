//! `geodesic`: sources, limits, paths, all pairs, interruption.

use std::fs;
use std::process::{Command, Stdio};
use std::time::Duration;

use canonform::mesh::{TriMesh, io, shapes};
use serde_json::{Value, json};

use crate::support::{Workplace, read_npy};

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

#[test]
fn sources_use_the_numbers_of_the_input() {
    let place = place();
    let mesh = sheet();
    let at = |v: usize| mesh.positions[v].coords;
    let [a, b, c] = mesh.faces[20].map(|v| v.index());
    let sources = format!("30,{b}-{a}@0.75,{a}-{b},f20@1:2:5");
    let json = place.json(format!("geodesic sheet.off --source {sources} --method exact -o d.npy"));
    let [edge, middle] = [format!("{b}-{a}@0.75"), format!("{a}-{b}@0.5")];
    assert_eq!(
        (&json["n_vertices"], &json["sources"]),
        (&72.into(), &json!([30, edge, middle, "f20@1:2:5"]))
    );
    assert_eq!(json["unreached"], json!((0..9).collect::<Vec<_>>()));
    assert_eq!(json["unreached"], json["repair"]["dropped_vertices"]);
    let (shape, rows) = read_npy(&place.path("d.npy"));
    assert_eq!(shape, [4, 72]);
    let middle = (at(a) + at(b)) / 2.0;
    let expected = [at(30), at(a) * 0.75 + at(b) * 0.25, middle, (at(a) + at(b) * 2.0 + at(c) * 5.0) / 8.0];
    for (row, from) in rows.chunks(72).zip(expected) {
        assert!(row[..9].iter().all(|d| d.is_infinite()));
        for (distance, at) in row.iter().zip(&mesh.positions).skip(9) {
            assert!((distance - (at.coords - from).norm()).abs() < 1e-12, "straight lines on the flat sheet");
        }
    }
    place.done(format!("geodesic sheet.off --source {sources} --method exact -o d.csv"));
    let text = fs::read_to_string(place.path("d.csv")).unwrap();
    let numbers = text.lines().flat_map(|line| line.split(',')).map(|x| x.parse::<f64>().unwrap());
    assert_eq!((text.lines().count(), numbers.collect::<Vec<_>>()), (4, rows));
}

#[test]
fn the_nearest_of_several_sources_is_one_row() {
    let place = place();
    let run =
        |options: &str| place.json(format!("geodesic sheet.off --source 9,f60,71 --method exact {options}"));
    let json = run("--nearest -o near.npy");
    assert_eq!(json["seconds"]["per_source"].as_array().unwrap().len(), 1);
    let (shape, near) = read_npy(&place.path("near.npy"));
    assert_eq!((shape, near[9], near[71]), (vec![1, 72], 0.0, 0.0));
    let outputs = run("-o each.ply.gz")["outputs"].take();
    assert_eq!(outputs, json!(["each-9.ply.gz", "each-f60@1_1_1.ply.gz", "each-71.ply.gz"]));
    assert_eq!(io::read(&place.path("each-71.ply.gz")).unwrap(), io::read(&place.path("sheet.off")).unwrap());
    // Beyond a limit distances are infinite and counted.
    let json = place.json("geodesic sheet.off --source 40,9 --max-distance 2.5 -o near.npy");
    let (_, near) = read_npy(&place.path("near.npy"));
    assert!(near.iter().all(|d| *d <= 2.5 || d.is_infinite()));
    let beyond = [0, 1].map(|row| near[row * 72 + 9..][..63].iter().filter(|d| d.is_infinite()).count());
    assert_eq!((&json["beyond"], &json["unreached"]), (&json!(beyond), &json!((0..9).collect::<Vec<_>>())));
}

#[test]
fn paths_are_written_in_every_format() {
    let place = place();
    let mesh = sheet();
    let run = |options: &str| {
        let asked = "geodesic sheet.off --source 9,f20 --path-to 71,10-19@0.5 --method exact";
        place.json(format!("{asked} {options}"))["paths"].as_array().unwrap().clone()
    };
    let paths = run("-o p.json");
    assert_eq!((paths.len(), &paths[1]["source"], &paths[1]["target"]), (4, &9.into(), &"10-19@0.5".into()));
    let corner = (mesh.positions[71] - mesh.positions[9]).norm();
    for field in ["length", "distance"] {
        assert!((paths[0][field].as_f64().unwrap() - corner).abs() < 1e-12);
    }
    let file: Value = serde_json::from_slice(&fs::read(place.path("p.json")).unwrap()).unwrap();
    let points = file["paths"][0]["points"].as_array().unwrap();
    assert_eq!(json!(points.len()), paths[0]["n_points"]);
    assert_eq!([&points[0]["at"], &points[points.len() - 1]["at"]], [&json!(9), &json!(71)]);
    // The written place of a point is accepted as a source.
    let middle = points[points.len() / 2]["at"].to_string().replace('"', "");
    place.done(format!("geodesic sheet.off --source {middle} -o d.npy"));
    for (name, start) in [("p.csv", "path,x,y,z,distance,at\n0,"), ("p.obj", "v "), ("p.ply", "ply\n")] {
        run(&format!("-o {name}"));
        assert!(fs::read(place.path(name)).unwrap().starts_with(start.as_bytes()), "{name}");
    }
    let nearest = run("--nearest -o p.json");
    assert_eq!([0, 1].map(|i| &nearest[i]["source"]), [&json!("f20@1:1:1"), &json!(9)]);
    place.done("geodesic sheet.off --components bridge --source 40 --path-to 4 -o p.csv");
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_leaves_nothing_behind() {
    let place = Workplace::new();
    // All pairs of these would be 3 GB.
    place.add("big.off", &shapes::torus(200, 100, 2.0, 0.6));
    (0..40).for_each(|i| place.add(&format!("models/{i}.off"), &crate::index::body(i % 3, i)));
    fs::create_dir(place.path("tmp")).unwrap();
    let n_files = |folder: &str| fs::read_dir(place.path(folder)).unwrap().count();
    for (signal, command, folder) in [
        ("-TERM", "geodesic big.off --all-pairs --memory 4M -o all.npy", "."),
        ("-INT", "geodesic big.off --all-pairs --memory 4M -o -", "tmp"),
        ("-INT", "duplicates models --threads 1", "tmp"),
    ] {
        let before = n_files(folder);
        let mut running = place.command(command);
        running.env("TMPDIR", place.path("tmp")).stdout(Stdio::null()).stderr(Stdio::piped());
        let mut child = running.spawn().unwrap();
        while n_files(folder) == before {
            assert!(child.try_wait().unwrap().is_none(), "it ended before it began");
            std::thread::sleep(Duration::from_millis(5));
        }
        let sent = Command::new("kill").args([signal, &child.id().to_string()]).status();
        assert!(sent.unwrap().success());
        let ended = child.wait_with_output().unwrap();
        assert_eq!(ended.status.code(), Some(130), "{command}");
        let said = String::from_utf8_lossy(&ended.stderr);
        assert!(said.ends_with("interrupted\n") && !said.contains("error"), "{command}: {said}");
        assert_eq!(n_files(folder), before, "{command}");
    }
}
