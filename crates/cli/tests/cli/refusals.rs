//! What the program refuses, by the table in `tests/contracts`.

use std::fs;
#[cfg(not(unix))]
use std::fs::hard_link as link;
#[cfg(unix)]
use std::os::unix::fs::symlink as link;
use std::path::Path;

use canonform::mesh::shapes;
use canonform::surface::VertexId;
use rayon::prelude::*;
use testkit::tree;

use crate::index::{BUILD, body, collection};
use crate::support::{Workplace, broken_ring, ring};

/// The folder in which the commands of the table run.
fn place() -> Workplace {
    let place = collection(3);
    place.done(BUILD);
    // One shape has changed since.
    place.add("meshes/ring0.off", &body(0, 3));
    place.done("index build meshes -n 20 -o new");
    place.done("index build meshes -n 21 --labels none -o other");
    // Vertices 160 to 169 and face 328 are dropped.
    let mut broken = broken_ring();
    broken.faces.push([3, 3, 4].map(VertexId));
    for (name, mesh) in [
        ("ring.off", &ring()),
        ("ring.ply", &ring()),
        ("a.off", &broken),
        ("b.off", &shapes::icosphere(0)),
        // Names that results might take.
        ("x.ply", &ring()),
        ("x-0.ply", &ring()),
        ("x-source.ply", &ring()),
        ("pair.vert", &ring()),
        ("sub/ring.off", &ring()),
        ("ball.ply", &shapes::icosphere(6)),
        ("large.ply", &shapes::icosphere(7)),
    ] {
        place.add(name, mesh);
    }
    link(place.path("ring.off"), place.path("link.off")).unwrap();
    fs::hard_link(place.path("ring.off"), place.path("hard.off")).unwrap();
    ["void", "taken.npy", "taken.csv"].iter().for_each(|name| fs::create_dir(place.path(name)).unwrap());
    place.done("geodesic ring.off --source 3,90 -o two.npy");
    place.done("field build ring.off --method exact --landmarks 20 -o x.field");
    let mut damaged = fs::read(place.path("x.field")).unwrap();
    damaged[200] ^= 1;
    fs::write(place.path("damaged.field"), damaged).unwrap();
    let mut damaged = fs::read(place.path("all.canonform")).unwrap();
    damaged[4096..].iter_mut().for_each(|byte| *byte ^= 1);
    fs::write(place.path("damaged.canonform"), damaged).unwrap();
    for (name, text) in [
        ("empty.off", ""),
        ("garbage.obj", "v 0 0\nf 1 2 x\n"),
        ("points.off", "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n"),
        ("notes.md", "no mesh"),
        ("notes.txt", "dear diary"),
        ("meshes.tar.xz", "x"),
        ("taken", ""),
        ("form.npy", "precious"),
        ("ring0", ""),
        ("bad.csv", "1,2\n3\n"),
        ("far.csv", "1,2\n3,999\n"),
        ("three.csv", "1,2,3"),
        ("ragged.csv", "1,2\n3"),
        ("words.csv", "1,two"),
        ("no.npy", "numbers"),
        ("bare.csv", "0,1\n1,0\n"),
        ("half.csv", "1.5,2\n"),
        ("twice.csv", "3,1\n3,90\n"),
        ("labels.csv", "a\nb\n"),
    ] {
        fs::write(place.path(name), text).unwrap();
    }
    fs::write(place.path("parts.csv"), "part\n".repeat(160)).unwrap();
    let meshes = ["a.off", "b.off"].map(|name| (name, fs::read(place.path(name)).unwrap()));
    fs::write(place.path("two.zip"), testkit::zip_of(&meshes)).unwrap();
    place
}

/// What is wrong with a refusal.
fn fault(place: &Workplace, row: &str) -> Option<String> {
    let (command, words) = row.split_once(" | ").unwrap();
    let outcome = place.run(command);
    let is_told = |words: &str| match words.strip_prefix('!') {
        Some(words) => !outcome.err.contains(words),
        None => outcome.err.contains(words),
    };
    let is_refused = outcome.code == 2 && outcome.out.is_empty() && words.split(" | ").all(is_told);
    (!is_refused).then(|| format!("{row}\n{} {}{}", outcome.code, outcome.out, outcome.err))
}

#[test]
fn every_refusal_names_what_is_wrong_and_leaves_nothing() {
    let place = place();
    let before = tree(&place.path(""));
    let contracts = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/contracts");
    let table = fs::read_to_string(contracts.join("refusals.txt")).unwrap();
    let rows: Vec<&str> = table.lines().filter(|row| row.contains(" | ") && !row.starts_with('#')).collect();
    let faults: Vec<String> = rows.par_iter().filter_map(|row| fault(&place, row)).collect();
    assert!(rows.len() > 190 && faults.is_empty(), "{}", faults.join("\n"));
    assert!(tree(&place.path("")) == before);
    // The remedy works, and an option that changes nothing is only noted.
    place.done("geodesic a.off --source 165 --components bridge -o d.npy");
    let noted = place.done("embed ring.off --method mds -n 20 -o f.npy");
    assert!(noted.err.contains("-n has no effect"), "{}", noted.err);
}
