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
    place.all_refused(&[
        ("info missing.off", &["missing.off", "No such file", "check"]),
        ("info empty.off", &["empty.off", "the file is empty"]),
        ("info notes.md", &["notes.md", "unknown mesh format `.md`", "use .off, .obj, .ply"]),
        ("info garbage.obj", &["garbage.obj", "line 1"]),
        ("embed empty.off -o form.ply", &["empty.off", "the file is empty"]),
        ("geodesic garbage.obj --source 0 -o d.npy", &["garbage.obj", "line 1"]),
        ("compare ring.off missing.off", &["missing.off", "No such file"]),
        ("embed void -o forms", &["void", "no mesh found"]),
        ("info void", &["void", "no mesh found"]),
    ]);
}

#[test]
fn negative_numbers_are_errors_of_the_value() {
    let place = place();
    place.done("field build ring.off --landmarks 10 -o x.field");
    for (command, words) in [
        ("geodesic ring.off -o d.npy --source -1,2", "counted from 0"),
        ("geodesic ring.off -o d.ply --source 0 --path-to -1", "counted from 0"),
        ("geodesic ring.off -o d.npy --source 0 --max-distance -1", "`-1` is not a distance"),
        ("field query x.field --source -1", "counted from 0"),
        ("embed ring.off -o f.npy --at -1", "counted from 0"),
        ("render ring.off -o p.png --distance-from -1", "counted from 0"),
        ("render ring.off -o p.png --field f.csv --row -1", "counted from 0"),
        ("embed ring.off -o f.npy -n -5", "-5"),
        ("info ring.off --weld -1", "-1"),
    ] {
        let outcome = place.run(command);
        assert_eq!(outcome.code, 2, "{command}");
        assert!(outcome.err.contains(words) && !outcome.err.contains("tip"), "{command}: {}", outcome.err);
    }
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
fn errors_name_missing_vertices_and_options_out_of_range() {
    let place = place();
    place.all_refused(&[
        // A short name occurs in messages by chance: the file must be named all the same.
        ("embed a.off --first-sample 170 -o f.npy", &["a.off: vertex 170"]),
        ("embed a.off --first-sample 169 -o f.npy", &["a.off: vertex 169"]),
        (
            "embed a.off --components error -o f.npy",
            &["a.off: the mesh is disconnected", "9 of 169", "--components bridge"],
        ),
        ("embed ring.off -n 0 -o f.npy", &["--samples", "`0`", "positive", "auto"]),
        ("embed ring.off -n many -o f.npy", &["`many`", "auto"]),
        ("embed ring.off -n auto --method kpca -o f.npy", &["kpca", "give --samples"]),
        ("embed ring.off --dim 4 -o f.ply", &["f.ply", "3 dimensions, not 4", "--dim"]),
        ("embed ring.off --dim 0 -o f.npy", &["dimension", "0"]),
        ("embed ring.off --dim 30 -n 20 -o f.npy", &["30", "20"]),
        ("embed ring.off --rank 21 -n 20 -o f.npy", &["rank", "21", "20"]),
        ("embed ring.off -o f.stl", &["f.stl", ".npy, .ply, .obj or .off"]),
        ("embed ring.off -o f", &["f: ", ".npy, .ply, .obj or .off"]),
        ("embed ring.off", &["--output"]),
        ("geodesic ring.off --source 0 -o d.stl", &["d.stl", ".npy, .csv, .off, .obj or .ply"]),
        ("geodesic ring.off -o d.npy", &["--source"]),
        ("compare ring.off ring.off --dim 2", &["3 dimensions", "--dim"]),
        ("completions tcsh", &["tcsh", "bash"]),
        ("no-such-command", &["no-such-command"]),
    ]);
    // The remedy works.
    place.done("geodesic a.off --source 165 --components bridge -o d.npy");
}

#[test]
fn errors_name_options_that_do_not_apply_together() {
    let place = place();
    place.all_refused(&[
        (
            "embed ring.off -o f.npy --method mds --rank 5",
            &["--rank", "--method mds", "nmds or kpca or smacof"],
        ),
        ("embed ring.off -o f.npy --alpha 0 --regularization rpi", &["ring.off", "alpha", "not 0; 1e-10"]),
        ("embed ring.off -o f.npy --alpha much --regularization rpi", &["--alpha", "`much`", "`paper`"]),
        ("embed ring.off -o f.npy --sigma wide --method kpca", &["--sigma", "`wide`", "`median`"]),
        (
            "embed ring.off -o f.npy --eigenvectors 3 --method spectral",
            &["ring.off", "3 dimensions", "1 to 2"],
        ),
        ("embed ring.off -o f.npy --method landmark -n 3", &["ring.off", "3 dimensions", "1 to 2"]),
        (
            "embed ring.off -o f.npy --geodesic exact --obtuse flip",
            &["--obtuse has no effect", "--geodesic exact", "fast-marching"],
        ),
        ("compare ring.off ring.off --alpha much --regularization rpi", &["--alpha", "`much`"]),
        (
            "geodesic ring.off --source 0 -o x.npy --method heat --update planar",
            &["--update has no effect with --method heat", "--method fast-marching"],
        ),
        (
            "field build ring.off -o x.field --method heat --update planar",
            &["--update has no effect with --method heat", "--method fast-marching"],
        ),
    ]);
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
    for (command, files) in [
        (
            "embed ring.off -n 20",
            &["nowhere/form.npy", "nowhere/form.ply", "taken.npy", "taken.ply", "taken.off"][..],
        ),
        (
            "geodesic ring.off --source 0",
            &["nowhere/d.npy", "nowhere/d.ply", "taken.npy", "taken.csv", "taken.ply"],
        ),
    ] {
        for file in files {
            let outcome = place.run(format!("{command} -o {file}"));
            assert_eq!((outcome.code, outcome.out.as_str()), (2, ""), "{file}");
            assert_eq!(outcome.err.matches(&format!("cannot write {file}")).count(), 1, "{}", outcome.err);
        }
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
