//! Archives, compressed files, lists, conversion and exports.

use std::fs;
use std::io::Write;

use canonform::mesh::{TriMesh, shapes};
use flate2::Compression;
use flate2::write::GzEncoder;
use serde_json::Value;
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use crate::support::{Workplace, ring};

fn files() -> Vec<(&'static str, TriMesh)> {
    vec![
        ("ring/ring0.off", ring()),
        ("ring/ring1.ply", shapes::torus(18, 9, 2.0, 0.5)),
        ("ball/ball0.off", shapes::icosphere(2)),
        ("ball/ball1.obj", shapes::icosphere(3)),
    ]
}

/// A folder `meshes`, and archives and a list of the same files.
fn collection() -> Workplace {
    let place = Workplace::new();
    for (name, mesh) in files() {
        place.add(&format!("meshes/{name}"), &mesh);
    }
    fs::write(place.path("meshes/notes.md"), "no mesh").unwrap();
    let content = |name: &str| fs::read(place.path("meshes").join(name)).unwrap();
    let names = || files().into_iter().map(|(name, _)| name).chain(["notes.md"]);
    let mut zip = ZipWriter::new(fs::File::create(place.path("meshes.zip")).unwrap());
    let mut tar = tar::Builder::new(GzEncoder::new(Vec::new(), Compression::fast()));
    for name in names() {
        zip.start_file(format!("meshes/{name}"), SimpleFileOptions::default()).unwrap();
        zip.write_all(&content(name)).unwrap();
        let mut header = tar::Header::new_gnu();
        header.set_size(content(name).len() as u64);
        header.set_mode(0o644);
        tar.append_data(&mut header, format!("meshes/{name}"), &content(name)[..]).unwrap();
    }
    zip.finish().unwrap();
    fs::write(place.path("meshes.tar.gz"), tar.into_inner().unwrap().finish().unwrap()).unwrap();
    let lines: String = files().iter().map(|(name, _)| format!("meshes/{name}\n")).collect();
    fs::write(place.path("list.txt"), lines).unwrap();
    place
}

const BUILD: [&str; 4] = ["-n", "20", "--points", "50"];

/// The lines of an export without the paths of files.
fn shapes_of(place: &Workplace, index: &str) -> Vec<Value> {
    let text = place.done(&["index", "export", index]).out;
    let mut lines: Vec<Value> = text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    for line in &mut lines {
        line.as_object_mut().unwrap().remove("path");
    }
    lines
}

#[test]
fn an_index_of_an_archive_or_a_list_equals_that_of_the_folder() {
    let place = collection();
    place.done(&[&["index", "build", "meshes", "-o", "folder.canonform"], &BUILD[..]].concat());
    let expected = shapes_of(&place, "folder.canonform");
    assert_eq!(expected.len(), 5);
    for dataset in ["meshes.zip", "meshes.tar.gz", "list.txt"] {
        let build = [&["index", "build", dataset, "-o", "other.canonform"], &BUILD[..]].concat();
        let report = place.json(&build);
        assert_eq!(report["described"], 4, "{dataset}: {report}");
        assert_eq!(shapes_of(&place, "other.canonform"), expected, "{dataset}");
        // Nothing is described twice, and nothing is taken for something from elsewhere.
        let report = place.json(&build);
        assert_eq!(report["unchanged"], 4, "{dataset}: {report}");
        // The files of the shapes are found again.
        let query = if dataset == "list.txt" { "meshes/ring/ring0.off" } else { "meshes/ball/ball0.off" };
        let found = place.found(&["other.canonform", query, "--explain", "-k", "1"]);
        assert_eq!(found["results"][0]["relation"]["kind"], "identical-file", "{dataset}: {found}");
        fs::remove_file(place.path("other.canonform")).unwrap();
    }
}

#[test]
fn every_command_reads_members_and_compressed_files() {
    let place = collection();
    let plain = fs::read(place.path("meshes/ring/ring0.off")).unwrap();
    let mut gzip = GzEncoder::new(Vec::new(), Compression::default());
    gzip.write_all(&plain).unwrap();
    fs::write(place.path("ring0.off.gz"), gzip.finish().unwrap()).unwrap();
    let info = |path: &str| place.json(&["info", path])["meshes"][0]["mesh"].clone();
    let expected = info("meshes/ring/ring0.off");
    let form = |path: &str, output: &str| {
        place.done(&["embed", path, "-n", "20", "-o", output]);
        fs::read(place.path(output)).unwrap()
    };
    let expected_form = form("meshes/ring/ring0.off", "plain.ply");
    for path in ["meshes.zip/meshes/ring/ring0.off", "meshes.tar.gz/meshes/ring/ring0.off", "ring0.off.gz"] {
        assert_eq!(info(path), expected, "{path}");
        assert_eq!(form(path, "form.ply"), expected_form, "{path}");
        let compared = place.json(&["compare", path, "meshes/ring/ring0.off", "-n", "20"]);
        let kind = compared["relation"]["kind"].as_str().unwrap();
        let expected = if path.ends_with(".gz") { "identical-geometry" } else { "identical-file" };
        assert_eq!(kind, expected, "{path}");
    }
    let embedded = place.json("embed meshes.zip -n 20 -o forms --format npy");
    assert_eq!(embedded["shapes"].as_array().unwrap().len(), 4);
    assert_eq!(embedded["shapes"][0]["label"], "ball");
    assert!(place.path("forms/ring/ring1.npy").exists());
    let all = place.json("info meshes.tar.gz list.txt meshes");
    assert_eq!(all["meshes"].as_array().unwrap().len(), 12);
    place.refused("info meshes.zip/meshes/ring/none.off", &["none.off", "no such member"]);
    for command in ["geodesic meshes.zip --source 0 -o x.npy", "compare ring0.off.gz meshes.zip"] {
        let words = ["meshes.zip: the archive holds 4 meshes", "meshes/ball/ball0.off", "name one of them"];
        place.refused(command, &words);
    }
    fs::write(place.path("meshes.tar.xz"), "x").unwrap();
    for command in ["info meshes.tar.xz", "index build meshes.tar.xz -o i"] {
        place.refused(command, &["meshes.tar.xz", "pack its files as .zip"]);
    }
}

#[test]
fn an_archive_of_one_mesh_is_that_mesh_for_every_command() {
    let place = Workplace::new();
    place.add("ring.off", &ring());
    let mut zip = ZipWriter::new(fs::File::create(place.path("one.zip")).unwrap());
    for (name, content) in
        [("s/ring.off", fs::read(place.path("ring.off")).unwrap()), ("s/notes.md", b"a".to_vec())]
    {
        zip.start_file(name, SimpleFileOptions::default()).unwrap();
        zip.write_all(&content).unwrap();
    }
    zip.finish().unwrap();
    for (command, output) in [
        ("geodesic MESH --source 0 -o", "x.npy"),
        ("embed MESH -n 20 -o", "x.npy"),
        ("convert MESH", "x.ply"),
        ("render MESH --size 64x64 -o", "x.png"),
        ("field build MESH --landmarks 10 -o", "x.field"),
        ("match MESH ring.off -n 20 -o", "x.npy"),
    ] {
        let [plain, archived] = ["ring.off", "one.zip"].map(|mesh| {
            place.done(format!("{} {output}", command.replace("MESH", mesh)));
            fs::read(place.path(output)).unwrap()
        });
        assert!(plain == archived, "{command}");
    }
    assert_eq!(place.json("info one.zip")["meshes"][0]["mesh"]["n_vertices"], 160);
    let relation = place.json("compare one.zip ring.off -n 20");
    assert_eq!(relation["relation"]["kind"], "identical-file", "{relation}");
    place.done("methods one.zip -n 20");
    place.done(&[&["index", "build", "one.zip", "-o", "i"], &BUILD[..]].concat());
    assert_eq!(place.json("search i one.zip")["queries"][0]["results"][0]["distance"], 0.0);
    // A folder still takes the results of an archive, however many there are.
    place.done("embed one.zip -n 20 -o forms --output-format npy");
    assert!(place.path("forms/ring.npy").exists());
}

#[test]
fn meshes_are_converted_between_all_formats() {
    let place = Workplace::new();
    place.add("ring.off", &ring());
    let expected = fs::read(place.path("ring.off")).unwrap();
    for format in ["off", "obj", "ply", "3mf", "vert", "tri", "obj.gz", "off.gz", "3mf.gz", "stl", "glb"] {
        let name = format!("copy.{format}");
        let json = place.json(&["convert", "ring.off", &name]);
        assert_eq!((&json["n_vertices"], &json["n_faces"]), (&160.into(), &320.into()), "{json}");
        let back = place.done(&["convert", &name, "back.off"]);
        // These round coordinates to 32 bits.
        if !matches!(format, "stl" | "glb") {
            assert_eq!(fs::read(place.path("back.off")).unwrap(), expected, "{format}");
        }
        let has_unit = matches!(format, "3mf" | "3mf.gz" | "glb");
        assert_eq!(back.err.contains("the unit of its coordinates"), has_unit, "{}", back.err);
    }
    let info = place.json("info copy.glb copy.3mf copy.ply");
    let units: Vec<&Value> =
        info["meshes"].as_array().unwrap().iter().map(|mesh| &mesh["file"]["unit"]).collect();
    assert_eq!(units, [&Value::from("meter"), &"millimeter".into(), &Value::Null]);
    place.refused("convert ring.off ring.mat", &["ring.mat", "use .off"]);
    place.refused("convert ring.off none/ring.ply", &["none", "does not exist"]);
    place.refused("embed ring.off -o form.npy.gz", &["form.npy.gz", "leave out .gz"]);
}

#[test]
fn conversion_repairs_on_request_and_converts_datasets() {
    let place = collection();
    place.add("two.obj", &shapes::disjoint(&[ring(), shapes::cube(0)]));
    assert_eq!(place.json("convert two.obj kept.ply")["n_vertices"], 168);
    let repaired = place.json("convert --repair two.obj one.ply --max-dropped 1");
    assert_eq!(repaired["n_vertices"], 160);
    assert!(repaired["repair"]["dropped_area_share"].as_f64().unwrap() > 0.0);
    place.refused("convert meshes.zip out", &["--output-format"]);
    let json = place.json("convert meshes.zip out --output-format ply.gz");
    assert_eq!(json["meshes"].as_array().unwrap().len(), 4);
    let counts = place.json("info out");
    assert_eq!(counts["meshes"].as_array().unwrap().len(), 4);
    assert!(place.path("out/ball/ball1.ply.gz").exists());
}

#[test]
fn format_names_the_format_of_standard_input() {
    let place = collection();
    place.add("ring.glb", &ring());
    let [glb, off] = ["ring.glb", "meshes/ring/ring0.off"].map(|name| fs::read(place.path(name)).unwrap());
    place.done(&[&["index", "build", "meshes.zip", "-o", "i"], &BUILD[..]].concat());
    for (input, arguments, code, start) in [
        (&glb, "info - --format glb --json", 0, "{"),
        (&off, "search i - --format off --json", 0, "{"),
        (&glb, "convert - - --format glb --output-format ply", 0, "ply"),
        // With --input-format, and without standard input, it is the format of forms.
        (&off, "embed - --input-format off --format npy -n 20 -o -", 0, "\u{fffd}NUMPY"),
        (&off, "embed - --format off -n 20 -o -", 0, "ply"),
        (&off, "convert - - --format off", 2, "--output-format"),
        (&off, "info - --format txt", 2, "`txt`"),
    ] {
        let (found, out, err) = place.piped(input, arguments);
        let out = String::from_utf8_lossy(&out).into_owned();
        assert_eq!(found, code, "{arguments}: {err}");
        assert!(if code == 0 { out.starts_with(start) } else { err.contains(start) }, "{arguments}: {err}");
    }
    place.refused("embed meshes/ring/ring0.off --format stl -o x", &["stl", ".npy"]);
}

#[test]
fn exports_go_to_files_and_to_standard_output() {
    let place = collection();
    place.done(&[&["index", "build", "list.txt", "-o", "i"], &BUILD[..]].concat());
    for format in ["jsonl", "parquet", "npz", "csv"] {
        let name = format!("x.{format}");
        place.done(&["index", "export", "i", "-o", &name]);
        let (code, out, err) =
            place.piped(b"", &["index", "export", "i", "-o", "-", "--output-format", format]);
        assert_eq!((code, out), (0, fs::read(place.path(&name)).unwrap()), "{format}: {err}");
    }
    assert_eq!(place.done("index export i").out, fs::read_to_string(place.path("x.jsonl")).unwrap());
    place.refused("index export i -o x.xlsx", &["x.xlsx", ".parquet"]);
    let before = fs::read(place.path("i")).unwrap();
    for output in ["i", "./i", "meshes/../i"] {
        place.refused(&["index", "export", "i", "-o", output], &["is the index itself"]);
    }
    assert_eq!(fs::read(place.path("i")).unwrap(), before);
    // What a killed program left goes with the next export.
    fs::write(place.path(".unfinished-Ab12"), "half").unwrap();
    place.done("index export i -o all.jsonl");
    assert!(!place.path(".unfinished-Ab12").exists());
}
