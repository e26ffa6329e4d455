//! Errors: each names the file, what is wrong and what to do, and leaves nothing behind.

use std::fs;

use canonform::mesh::shapes;

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
        ("empty.off", "the file is empty", "empty"),
        ("notes.md", "unknown mesh format `.md`", "use .off, .obj, .ply"),
        ("garbage.obj", "line 1", ""),
    ] {
        place.refused(&["info", file], &[file, fault, remedy]);
    }
    for (command, words) in [
        ("embed empty.off -o form.ply", ["empty.off", "the file is empty"]),
        ("geodesic garbage.obj --source 0 -o d.npy", ["garbage.obj", "line 1"]),
        ("compare ring.off missing.off", ["missing.off", "No such file"]),
        ("embed void -o forms", ["void", "no mesh found"]),
        ("info void", ["void", "no mesh found"]),
    ] {
        place.refused(command, &words);
    }
    assert_eq!(place.names(), before);
}

#[test]
fn negative_numbers_are_errors_of_the_value() {
    let place = place();
    place.done("field build ring.off --landmarks 10 -o x.field");
    for (command, words) in [
        ("geodesic ring.off -o d.npy --source -1", "counted from 0"),
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
fn tables_of_spreadsheets_are_read_by_every_command() {
    let place = place();
    place.add("s/a0.off", &ring());
    place.add("s/b0.off", &shapes::icosphere(2));
    let utf16: Vec<u8> = "\u{feff}0,1\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
    let row = |i: usize| (0..6).map(|j| if i / 3 == j / 3 { "0,5;" } else { "9;" }).collect::<String>();
    let rows: Vec<String> = (0..6).map(|i| row(i).trim_end_matches(';').to_owned()).collect();
    let matrix = format!("\u{feff}a1;a2;a3;b1;b2;b3\n{}\n", rows.join("\n"));
    for (name, text) in [
        ("pairs.csv", "\u{feff}a;b\n0;1\n"),
        ("labels.csv", "\u{feff}Name;Label\na0;x\nb0.off;y\n"),
        ("matrix.csv", &matrix),
        ("list.txt", "\u{feff}s/a0.off\r\ns/b0.off\r\n"),
        ("none.csv", "c0,x\n"),
        ("names.csv", "a,b\n"),
    ] {
        fs::write(place.path(name), text).unwrap();
    }
    fs::write(place.path("utf16.csv"), &utf16).unwrap();
    place.done("field build ring.off --landmarks 10 -o x.field");
    assert_eq!(place.json("field query x.field --pairs pairs.csv")["pairs"][0]["b"], 1);
    assert_eq!(place.json("index build s --labels labels.csv -o i -n 20")["n_classes"], 2);
    assert_eq!(place.json("evaluate matrix.csv")["classes"], serde_json::json!(["a", "b"]));
    assert_eq!(place.json("info list.txt")["meshes"].as_array().unwrap().len(), 2);
    for command in ["index build s --labels none.csv -o j -n 20", "evaluate i --labels none.csv"] {
        place.refused(command, &["none.csv: none of its lines names a shape: line 1 has `c0`", "`a0`"]);
    }
    place.refused("field query x.field --pairs names.csv", &["names.csv, line 1", "no rows"]);
    for command in ["field query x.field --pairs utf16.csv", "evaluate utf16.csv"] {
        place.refused(command, &["utf16.csv", "UTF-16", "save the file as UTF-8"]);
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
    for (command, words) in [
        ("embed ring.off -n 0 -o f.npy", &["--samples", "`0`", "positive", "auto"][..]),
        ("embed ring.off -n many -o f.npy", &["`many`", "auto"]),
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
    ] {
        place.refused(command, words);
    }
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
        ("--geodesic exact --obtuse flip", ["--obtuse has no effect", "--geodesic exact", "fast-marching"]),
    ] {
        let options: Vec<&str> = options.split(' ').collect();
        place.refused(&[&["embed", "ring.off", "-o", "f.npy"], &options[..]].concat(), &words);
    }
    place.refused("compare ring.off ring.off --alpha much --regularization rpi", &["--alpha", "`much`"]);
    for command in ["geodesic ring.off --source 0 -o x.npy", "field build ring.off -o x.field"] {
        let wrong = format!("{command} --method heat --update planar");
        place.refused(&*wrong, &["--update has no effect with --method heat", "--method fast-marching"]);
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
