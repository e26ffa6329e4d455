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
        "geodesic MESH --source 0 -o x.npy",
        "embed MESH -n 20 -o x.ply",
        "convert MESH y.ply",
        "render MESH --size 64x64 -o x.png",
        "field build MESH --landmarks 10 -o x.field",
        "match MESH meshes/ring/ring0.off -n 20 -o y.npy",
    ];
    let result = |command: &str, mesh: &str| {
        place.done(command.replace("MESH", mesh));
        fs::read(place.path(command.rsplit(' ').next().unwrap())).unwrap()
    };
    let expected = commands.map(|command| result(command, plain));
    let mesh = |path: &str| place.json(format!("info {path}"))["meshes"][0]["mesh"].take();
    for (path, n, kind) in [
        ("one.zip", 6, "identical-file"),
        ("meshes.zip/meshes/ring/ring0.off", 2, "identical-file"),
        ("meshes.tar.gz/meshes/ring/ring0.off", 2, "identical-file"),
        ("ring0.off.gz", 2, "identical-geometry"),
    ] {
        let found = commands[..n].iter().map(|command| result(command, path));
        assert!(found.eq(expected[..n].iter().cloned()) && mesh(path) == mesh(plain), "{path}");
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
}

#[test]
fn meshes_are_converted_between_all_formats() {
    let place = Workplace::new();
    place.add("ring.off", &ring());
    let expected = fs::read(place.path("ring.off")).unwrap();
    for format in ["off", "obj", "ply", "3mf", "vert", "tri", "obj.gz", "off.gz", "3mf.gz", "stl", "glb"] {
        assert_eq!(place.json(format!("convert ring.off copy.{format}"))["n_faces"], 320);
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
    assert_eq!([&repaired["n_vertices"], &repaired["repair"]["dropped_components"]], [160, 1]);
    place.done("convert meshes.zip out --output-format ply.gz");
    assert_eq!(place.json("info out list.txt")["meshes"].as_array().unwrap().len(), 8);
    assert!(place.path("out/ball/ball1.ply.gz").exists());
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
}
