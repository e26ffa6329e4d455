//! Errors: each names the file, what is wrong and what to do, and leaves nothing behind.

use std::fs;

use crate::support::{Workplace, broken_ring, one_object, ring};

/// An intact mesh, and a broken one with a very short name.
fn place() -> Workplace {
    let place = Workplace::new();
    place.add("ring.off", &ring());
    place.add("a.off", &broken_ring());
    place
}

#[test]
fn errors_name_files_that_are_not_meshes() {
    let place = place();
    fs::write(place.path("empty.off"), "").unwrap();
    fs::write(place.path("notes.md"), "no mesh").unwrap();
    fs::create_dir(place.path("void")).unwrap();
    fs::write(place.path("garbage.obj"), "v 0 0\nf 1 2 x\n").unwrap();
    let before = place.names();
    for (file, fault, remedy) in [
        ("missing.off", "No such file", "check"),
        ("empty.off", "empty", "export it again"),
        ("notes.md", "unknown mesh format `.md`", "use .off, .obj, .ply"),
        ("garbage.obj", "line 1", ""),
    ] {
        place.refused(&["info", file], &[file, fault, remedy]);
        place.refused(&["embed", file, "-o", "form.ply"], &[file, fault, remedy]);
        place.refused(&["geodesic", file, "--source", "0", "-o", "d.npy"], &[file, fault, remedy]);
        place.refused(&["compare", "ring.off", file], &[file, fault, remedy]);
    }
    for command in ["embed void -o forms", "info void"] {
        place.refused(command, &["void", "no mesh found"]);
    }
    assert_eq!(place.names(), before);
}

#[test]
fn info_continues_after_an_unreadable_file() {
    let place = place();
    let outcome = place.run("info missing.off ring.off --json");
    let json = one_object(&outcome.out);
    assert_eq!(outcome.code, 2);
    assert_eq!(json["meshes"].as_array().unwrap().len(), 1);
    assert_eq!(json["failed"][0]["path"], "missing.off");
}

#[test]
fn errors_name_missing_vertices_and_their_file() {
    let place = place();
    let before = place.names();
    // A short name occurs in messages by chance: the file must be named all the same.
    place.refused("embed a.off --first-sample 170 -o f.npy", &["a.off: vertex 170"]);
    place.refused("embed a.off --first-sample 169 -o f.npy", &["a.off: vertex 169"]);
    place.refused(
        "embed a.off --components error -o f.npy",
        &["a.off: the mesh is disconnected", "9 of 169", "--components bridge"],
    );
    assert_eq!(place.names(), before);
    // The remedy works.
    place.done("geodesic a.off --source 165 --components bridge -o d.npy");
}

#[test]
fn errors_name_options_out_of_range() {
    let place = place();
    let before = place.names();
    let embed = |options: &[&'static str], words: &[&str]| {
        place.refused(&[&["embed", "ring.off"], options].concat(), words);
    };
    embed(&["-n", "0", "-o", "f.npy"], &["--samples", "`0`", "positive", "auto"]);
    embed(&["-n", "many", "-o", "f.npy"], &["`many`", "auto"]);
    embed(&["--dim", "4", "-o", "f.ply"], &["f.ply", "3 dimensions, not 4", "--dim"]);
    embed(&["--dim", "0", "-o", "f.npy"], &["dimension", "0"]);
    embed(&["--dim", "30", "-n", "20", "-o", "f.npy"], &["30", "20"]);
    embed(&["--rank", "21", "-n", "20", "-o", "f.npy"], &["rank", "21", "20"]);
    embed(&["-o", "f.stl"], &["f.stl", ".npy, .ply, .obj or .off"]);
    embed(&["-o", "f"], &["f: ", ".npy, .ply, .obj or .off"]);
    embed(&[], &["--output"]);
    place.refused("geodesic ring.off --source 0 -o d.stl", &["d.stl", ".npy, .csv, .off, .obj or .ply"]);
    place.refused("geodesic ring.off --source -1 -o d.npy", &["-1"]);
    place.refused("geodesic ring.off -o d.npy", &["--source"]);
    place.refused("compare ring.off ring.off --dim 2", &["3 dimensions", "--dim"]);
    place.refused("completions tcsh", &["tcsh", "bash"]);
    place.refused("no-such-command", &["no-such-command"]);
    assert_eq!(place.names(), before);
}

#[test]
fn errors_name_options_that_do_not_apply_together() {
    let place = place();
    let before = place.names();
    for (options, words) in [
        ("--method mds --rank 5", ["--rank", "--method mds", "nmds or kpca or smacof"]),
        ("--regularization none --rank 5", ["--rank", "--regularization none", "low-rank or cur"]),
        ("--alpha 0 --regularization rpi", ["ring.off", "alpha", "not 0; 1e-10"]),
        ("--alpha much --regularization rpi", ["--alpha", "`much`", "`paper`"]),
        ("--sigma wide --method kpca", ["--sigma", "`wide`", "`median`"]),
        (
            "--sigma=-1 --method kpca",
            ["ring.off", "width", "positive number in the unit of the distances, not -1"],
        ),
        ("--tolerance nan --method smacof", ["ring.off", "tolerance", "not NaN; 1e-6"]),
        ("--mu=-1 --method spectral", ["ring.off", "mu", "must be positive (it may be infinite), not -1"]),
        ("--eigenvectors 3 --method spectral", ["ring.off", "3 dimensions", "1 to 2"]),
        ("--method landmark -n 3", ["ring.off", "3 dimensions", "1 to 2"]),
    ] {
        let options: Vec<&str> = options.split(' ').collect();
        place.refused(&[&["embed", "ring.off", "-o", "f.npy"], &options[..]].concat(), &words);
        place.refused(&[&["compare", "ring.off", "ring.off"], &options[..]].concat(), &words);
    }
    assert_eq!(place.names(), before);
    let noted = place.done("embed ring.off --method mds -n 20 -o f.npy");
    assert!(noted.err.contains("-n has no effect"), "{}", noted.err);
}

#[test]
fn errors_name_unwritable_outputs_once_and_leave_nothing() {
    let place = place();
    // A folder in place of the output: writing fails at the very end, for any user.
    for name in ["taken.npy", "taken.csv", "taken.ply", "taken.off"] {
        fs::create_dir(place.path(name)).unwrap();
    }
    let before = place.names();
    for file in ["nowhere/form.npy", "nowhere/form.ply", "taken.npy", "taken.ply", "taken.off"] {
        let outcome = place.run(&["embed", "ring.off", "-n", "20", "-o", file]);
        assert_eq!((outcome.code, outcome.out.as_str()), (2, ""), "{file}");
        assert_eq!(outcome.err.matches(&format!("cannot write {file}")).count(), 1, "{}", outcome.err);
    }
    for file in ["nowhere/d.npy", "nowhere/d.csv", "nowhere/d.ply", "taken.npy", "taken.csv", "taken.ply"] {
        place.refused(&["geodesic", "ring.off", "--source", "0", "-o", file], &["cannot write", file]);
    }
    assert_eq!(place.names(), before);
}

#[test]
fn a_failure_keeps_existing_files() {
    let place = place();
    fs::write(place.path("form.npy"), "precious").unwrap();
    place.refused("embed ring.off --rank 99 -n 20 -o form.npy", &["99"]);
    place.refused("geodesic ring.off --source 0,500 -o form.npy", &["500"]);
    assert_eq!(fs::read(place.path("form.npy")).unwrap(), b"precious");
}
