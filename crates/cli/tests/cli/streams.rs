//! Standard input and output, several meshes, limits, and quiet runs.

use std::fs;

use canonform::mesh::{io, shapes};

use crate::support::{Arguments, Workplace, broken_ring, one_object, read_npy, ring};

/// Runs the program with a file as standard input.
fn piped(place: &Workplace, input: &str, arguments: impl Arguments) -> (i32, Vec<u8>, String) {
    place.piped(&fs::read(place.path(input)).unwrap(), arguments)
}

fn place() -> Workplace {
    let place = Workplace::new();
    for name in ["ring.off", "ring.ply", "ring.stl", "ring.obj", "ring.glb"] {
        place.add(name, &ring());
    }
    place
}

#[test]
fn meshes_come_from_standard_input_in_every_format_of_one_file() {
    let place = place();
    place.done("index build . -n 20 -o i");
    fs::write(place.path("bad.off"), "OFF\n3 1 0\n0 0 0\n").unwrap();
    for (input, arguments, code, start) in [
        ("ring.off", "info - --input-format off --json", 0, "{"),
        ("ring.obj", "info - --input-format obj --json", 0, "{"),
        ("ring.stl", "info - --format stl --json", 0, "{"),
        ("ring.glb", "info - --format glb --json", 0, "{"),
        ("ring.off", "search i - --format off --json", 0, "{"),
        ("ring.ply", "convert - - --format ply --output-format off", 0, "OFF"),
        // With --input-format, and without standard input, it is the format of forms.
        ("ring.off", "embed - --input-format off --format npy -n 20 -o -", 0, "\u{fffd}NUMPY"),
        ("ring.off", "embed - --format off -n 20 -o -", 0, "ply"),
        ("ring.off", "convert - - --format off", 2, "--output-format"),
        ("ring.off", "info - --format txt", 2, "`txt`"),
        ("bad.off", "info - --input-format off", 2, "standard input, line 3"),
    ] {
        let (found, out, err) = piped(&place, input, arguments);
        let out = String::from_utf8_lossy(&out).into_owned();
        assert_eq!(found, code, "{arguments}: {err}");
        assert!(if code == 0 { out.starts_with(start) } else { err.contains(start) }, "{arguments}: {err}");
    }
    place.done("embed ring.ply -n 20 -o named.npy");
    let stream = "embed - --input-format ply -n 20 -o streamed.npy -q";
    assert_eq!(piped(&place, "ring.ply", stream).0, 0);
    assert_eq!(read_npy(&place.path("named.npy")), read_npy(&place.path("streamed.npy")));
}

#[test]
fn results_go_to_standard_output_and_nothing_else_does() {
    let place = place();
    for (file, command) in [
        ("form.npy", "embed ring.off -n 20 --output-format npy"),
        ("form.ply", "embed ring.off -n 20"),
        ("rows.npy", "geodesic ring.off --source 0,9"),
        ("rows.csv", "geodesic ring.off --source 0,9 --output-format csv"),
        ("near.ply", "geodesic ring.off --source 0 --output-format ply"),
        ("pairs.npy", "geodesic ring.off --all-pairs"),
        ("path.obj", "geodesic ring.off --source 0 --path-to 9 --output-format obj"),
        ("x.png", "render ring.off --size 60"),
    ] {
        place.done(format!("{command} -o {file}"));
        let (code, out, err) = piped(&place, "ring.off", format!("{command} -o -"));
        assert_eq!((code, out), (0, fs::read(place.path(file)).unwrap()), "{command}: {err}");
        assert!(err.contains("holds") || err.contains("wrote"), "the answer goes to standard error: {err}");
        let (_, _, err) = piped(&place, "ring.off", format!("{command} -o - -q"));
        assert_eq!(err, "", "{command}");
    }
}

#[test]
fn lists_folders_and_patterns_are_embedded_and_drawn() {
    let place = Workplace::new();
    for name in ["scans/ring2.off", "scans/ring10.off", "more/sheet.ply"] {
        place.add(name, &ring());
    }
    fs::write(place.path("scans/notes.txt"), "no mesh").unwrap();
    let embed = place.json("embed scans/* more -n 20 -o forms --format npy");
    // As shells sort.
    let names = [0, 1, 2].map(|i| embed["shapes"][i]["name"].as_str().unwrap());
    assert_eq!(names, ["ring10", "ring2", "sheet"]);
    // Each form is that which the mesh has alone.
    place.done("embed scans/ring2.off -n 20 -o alone.npy");
    assert_eq!(read_npy(&place.path("alone.npy")), read_npy(&place.path("forms/ring2.npy")));
    place.done("render scans/ring2.off more/*.ply --size 40 -o pictures/");
    assert!(place.path("pictures/ring2.png").exists() && place.path("pictures/sheet.png").exists());
}

#[test]
fn a_bad_mesh_does_not_stop_the_rest() {
    let place = place();
    place.add("sheet.off", &shapes::grid(12, 9, 0.1));
    for (command, key) in
        [("embed -n 20 -o out", "shapes"), ("render --size 40 -o out", "pictures"), ("info", "meshes")]
    {
        let outcome = place.run(format!("{command} absent.off sheet.off ring.obj --json"));
        assert_eq!((outcome.code, outcome.err.matches("error: ").count()), (2, 1), "{}", outcome.err);
        let json = one_object(&outcome.out);
        assert_eq!(json[key].as_array().unwrap().len(), 2);
        assert_eq!(json["failed"][0]["path"], "absent.off");
    }
}

#[test]
fn quiet_runs_write_nothing_but_errors_to_standard_error() {
    let place = place();
    place.add("broken.off", &broken_ring());
    for command in [
        "info broken.off",
        "embed broken.off --dim 3 -n 20 -o form.npy",
        "geodesic broken.off --source 0 -o d.npy",
        "render broken.off --form -o x.png --size 40",
        "compare broken.off broken.off",
        "methods broken.off -n 20",
    ] {
        assert_eq!(place.run(format!("{command} -q")).err, "", "{command}");
    }
    assert!(place.run("info absent.off -q").err.contains("absent.off"));
}

#[test]
fn fields_are_written_in_every_format_with_colors_and_drawn_again() {
    let place = place();
    let mut bumpy = ring();
    bumpy.positions[7].coords *= 1.3;
    place.add("bumpy.off", &bumpy);
    for name in ["r.ply", "r.off"] {
        let json = place.json(format!("compare ring.off bumpy.off --residual-mesh {name}"));
        assert_eq!((&json["triangulation"], &json["residual"]["output"]), (&"same".into(), &name.into()));
        assert!(json["residual"]["max"].as_f64().unwrap() > 0.0);
        assert_eq!(io::read(&place.path(name)).unwrap(), ring());
        let json = place.json(format!("render {name} -o r.png --size 60"));
        assert_eq!(json["field"]["name"].as_str(), name.ends_with("ply").then_some("residual"), "{name}");
    }
}
