//! Archives, compressed files, lists, conversion and exports.

use std::fs;

use canonform::mesh::shapes;
use serde_json::{Value, json};
use testkit::{gzip_of, tar_of, zip_of};

use crate::support::{Workplace, ring};

/// A folder `meshes`, archives and a list of the same files, and an archive of one mesh.
fn collection() -> Workplace {
    let place = Workplace::new();
    let names = [
        "meshes/ring/ring0.off",
        "meshes/ring/ring1.ply",
        "meshes/ball/ball0.off",
        "meshes/ball/ball1.obj",
        "meshes/notes.md",
    ];
    let meshes = [ring(), shapes::torus(18, 9, 2.0, 0.5), shapes::icosphere(2), shapes::icosphere(3)];
    names.iter().zip(&meshes).for_each(|(name, mesh)| place.add(name, mesh));
    fs::write(place.path("meshes/notes.md"), "no mesh").unwrap();
    let files = |names: &[&'static str]| -> Vec<(&str, Vec<u8>)> {
        names.iter().map(|name| (*name, fs::read(place.path(name)).unwrap())).collect()
    };
    fs::write(place.path("meshes.zip"), zip_of(&files(&names))).unwrap();
    fs::write(place.path("meshes.tar.gz"), gzip_of(&tar_of(&files(&names)))).unwrap();
    place.add("s/ring.off", &ring());
    fs::write(place.path("s/notes.md"), "a").unwrap();
    fs::write(place.path("one.zip"), zip_of(&files(&["s/ring.off", "s/notes.md"]))).unwrap();
    fs::write(place.path("list.txt"), names[..4].join("\n")).unwrap();
    place
}

const BUILD: &str = "-n 20 --points 50 -o other.canonform";

/// The lines of the export of an index of a data set, without the paths of files.
fn indexed(place: &Workplace, dataset: &str) -> Vec<Value> {
    let report = place.json(format!("index build {dataset} {BUILD}"));
    assert_eq!(report["described"], 4, "{dataset}: {report}");
    // Nothing is described twice, and nothing is taken for something from elsewhere.
    let report = place.json(format!("index build {dataset} {BUILD}"));
    assert_eq!(report["unchanged"], 4, "{dataset}: {report}");
    let text = place.done("index export other.canonform").out;
    let mut lines: Vec<Value> = text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    lines.iter_mut().for_each(|line| line["path"] = Value::Null);
    // The files of the shapes are found again.
    let query = if dataset == "list.txt" { "meshes/ring/ring0.off" } else { "meshes/ball/ball0.off" };
    let found = place.found(format!("other.canonform {query} --explain -k 1"));
    assert_eq!(found["results"][0]["relation"]["kind"], "identical-file", "{dataset}: {found}");
    fs::remove_file(place.path("other.canonform")).unwrap();
    lines
}

#[test]
fn an_index_of_an_archive_or_a_list_equals_that_of_the_folder() {
    let place = collection();
    let expected = indexed(&place, "meshes");
    assert_eq!(expected.len(), 5);
    for dataset in ["meshes.zip", "meshes.tar.gz", "list.txt"] {
        assert_eq!(indexed(&place, dataset), expected, "{dataset}");
    }
}

#[test]
fn every_command_reads_members_compressed_files_and_archives_of_one_mesh() {
    let place = collection();
    let plain = "meshes/ring/ring0.off";
    fs::write(place.path("ring0.off.gz"), gzip_of(&fs::read(place.path(plain)).unwrap())).unwrap();
    let commands = [
        ("geodesic MESH --source 0 -o", "x.npy"),
        ("embed MESH -n 20 -o", "x.ply"),
        ("convert MESH", "y.ply"),
        ("render MESH --size 64x64 -o", "x.png"),
        ("field build MESH --landmarks 10 -o", "x.field"),
        ("match MESH meshes/ring/ring0.off -n 20 -o", "y.npy"),
    ];
    let results = |mesh: &str, n: usize| -> Vec<Vec<u8>> {
        let run = |(command, output): &(&str, &str)| {
            place.done(format!("{} {output}", command.replace("MESH", mesh)));
            fs::read(place.path(output)).unwrap()
        };
        commands[..n].iter().map(run).collect()
    };
    let expected = results(plain, 6);
    let mesh = |path: &str| place.json(format!("info {path}"))["meshes"][0]["mesh"].clone();
    for (path, n, kind) in [
        ("one.zip", 6, "identical-file"),
        ("meshes.zip/meshes/ring/ring0.off", 2, "identical-file"),
        ("meshes.tar.gz/meshes/ring/ring0.off", 2, "identical-file"),
        ("ring0.off.gz", 2, "identical-geometry"),
    ] {
        assert!(results(path, n) == expected[..n] && mesh(path) == mesh(plain), "{path}");
        let compared = place.json(format!("compare {path} {plain} -n 20"));
        assert_eq!(compared["relation"]["kind"], kind, "{path}");
    }
    place.done(format!("index build one.zip {BUILD}"));
    assert_eq!(place.found("other.canonform one.zip")["results"][0]["distance"], 0.0);
    // A folder takes the results of an archive, however many there are.
    for (archive, form) in [("meshes.zip", "ring/ring1.npy"), ("one.zip", "ring.npy")] {
        place.done(format!("embed {archive} -n 20 -o forms --output-format npy"));
        assert!(place.path("forms").join(form).exists(), "{form}");
    }
    let all = place.json("info meshes.tar.gz list.txt meshes");
    assert_eq!(all["meshes"].as_array().unwrap().len(), 12);
}

#[test]
fn meshes_are_converted_between_all_formats() {
    let place = Workplace::new();
    place.add("ring.off", &ring());
    let expected = fs::read(place.path("ring.off")).unwrap();
    for format in ["off", "obj", "ply", "3mf", "vert", "tri", "obj.gz", "off.gz", "3mf.gz", "stl", "glb"] {
        let json = place.json(format!("convert ring.off copy.{format}"));
        assert_eq!((&json["n_vertices"], &json["n_faces"]), (&160.into(), &320.into()), "{json}");
        let back = place.done(format!("convert copy.{format} back.off"));
        // These round coordinates to 32 bits.
        if !matches!(format, "stl" | "glb") {
            assert_eq!(fs::read(place.path("back.off")).unwrap(), expected, "{format}");
        }
        let has_unit = matches!(format, "3mf" | "3mf.gz" | "glb");
        assert_eq!(back.err.contains("the unit of its coordinates"), has_unit, "{}", back.err);
    }
    let info = place.json("info copy.glb copy.3mf copy.ply");
    let units = [0, 1, 2].map(|i| info["meshes"][i]["file"]["unit"].clone());
    assert_eq!(units, [json!("meter"), json!("millimeter"), Value::Null]);
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
    assert_eq!(place.json("info out")["meshes"].as_array().unwrap().len(), 4);
    assert!(place.path("out/ball/ball1.ply.gz").exists());
}

#[test]
fn format_names_the_format_of_standard_input() {
    let place = collection();
    place.add("ring.glb", &ring());
    let [glb, off] = ["ring.glb", "meshes/ring/ring0.off"].map(|name| fs::read(place.path(name)).unwrap());
    place.done(format!("index build one.zip {BUILD}"));
    for (input, arguments, code, start) in [
        (&glb, "info - --format glb --json", 0, "{"),
        (&off, "search other.canonform - --format off --json", 0, "{"),
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
}

#[test]
fn exports_go_to_files_and_to_standard_output() {
    let place = collection();
    place.done(format!("index build list.txt {BUILD}"));
    fs::rename(place.path("other.canonform"), place.path("i")).unwrap();
    for format in ["jsonl", "parquet", "npz", "csv"] {
        place.done(format!("index export i -o x.{format}"));
        let (code, out, err) = place.piped(b"", format!("index export i -o - --output-format {format}"));
        assert_eq!(
            (code, out),
            (0, fs::read(place.path(&format!("x.{format}"))).unwrap()),
            "{format}: {err}"
        );
    }
    assert_eq!(place.done("index export i").out, fs::read_to_string(place.path("x.jsonl")).unwrap());
    // What a killed program left goes with the next export.
    fs::write(place.path(".unfinished-Ab12"), "half").unwrap();
    place.done("index export i -o all.jsonl");
    assert!(!place.path(".unfinished-Ab12").exists());
}
