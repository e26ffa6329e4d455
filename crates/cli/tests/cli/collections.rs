//! Folders and indexes as people keep them: labels, limits, moves.

use std::fs;

use canonform::mesh::shapes;
use serde_json::{Value, json};

use crate::index::{BUILD, body, collection};
use crate::support::{Workplace, one_object};

fn ids<'a>(json: &'a Value, list: &str) -> Vec<&'a str> {
    json[list].as_array().unwrap().iter().map(|shape| shape["id"].as_str().unwrap()).collect()
}

#[test]
fn a_build_keeps_what_did_not_come_from_its_folder() {
    let place = collection(2);
    place.done(BUILD);
    place.add("more/box0.off", &body(2, 0));
    place.add("extra.ply", &body(2, 1));
    place.done("index add all.canonform more extra.ply --label box");
    fs::remove_file(place.path("meshes/ring1.off")).unwrap();
    let counts =
        |json: Value| ["n_shapes", "removed", "elsewhere", "pruned"].map(|key| json[key].as_u64().unwrap());
    assert_eq!(counts(place.json(BUILD)), [7, 1, 2, 0]);
    // The next run has nothing to do, and says the same.
    let before = fs::read(place.path("all.canonform")).unwrap();
    let outcome = place.done(BUILD);
    assert!(outcome.out.contains("from elsewhere") && outcome.err.contains("--prune"), "{}", outcome.err);
    assert_eq!(fs::read(place.path("all.canonform")).unwrap(), before);
    assert_eq!(counts(place.json(format!("{BUILD} --prune"))), [5, 0, 0, 2]);
}

#[test]
fn shapes_are_listed_by_class() {
    let place = collection(2);
    place.done(BUILD);
    place.add("extra.ply", &body(2, 1));
    place.done("index add all.canonform extra.ply --labels none");
    let all = place.json("index list all.canonform");
    assert_eq!(ids(&all, "shapes"), ["ball0", "ball1", "ball2", "extra", "ring0", "ring1", "ring2"]);
    let some = place.json("index list all.canonform --label ring --unlabelled");
    assert_eq!(ids(&some, "shapes"), ["extra", "ring0", "ring1", "ring2"]);
    let text = place.done("index list all.canonform --label ball").out;
    assert!(text.contains("meshes/ball2.off") && text.contains("3 of 7 shapes"), "{text}");
    assert_eq!(place.run("index list all.canonform --label cat").code, 1);
}

#[test]
fn queries_are_meshes_folders_and_shapes_of_the_index() {
    let place = collection(2);
    place.done(BUILD);
    let search = |rest: &str| place.found(format!("all.canonform {rest}"));
    let by_id = search("ring1");
    assert_eq!((&by_id["query"], ids(&by_id, "results")[0]), (&"ring1".into(), "ring1"));
    assert_eq!(ids(&by_id, "results"), ids(&search("meshes/ring1.off"), "results"));
    // A file goes before a shape of the same name, unless the shape is asked for.
    fs::copy(place.path("meshes/ball0.off"), place.path("ring0")).unwrap();
    assert_eq!(ids(&search("--id ring0"), "results")[0], "ring0");
    let many = place.json("search all.canonform meshes --id ring2");
    assert_eq!(many["queries"].as_array().unwrap().len(), 7);
    // Without results the class is predicted all the same.
    let none = search("ball1 -k 0");
    assert!(none["results"].as_array().unwrap().is_empty() && none["predicted"]["label"] == "ball");
    assert_eq!(ids(&search("ball1 -k 9223372036854775807"), "results").len(), 6);
}

#[test]
fn an_index_moves_with_its_folder() {
    let place = collection(2);
    fs::create_dir_all(place.path("here/work")).unwrap();
    fs::rename(place.path("meshes"), place.path("here/meshes")).unwrap();
    place.done("index build here/meshes -n 20 -o here/work/i");
    fs::rename(place.path("here"), place.path("there")).unwrap();
    let found = place.found("there/work/i ball0 -k 1");
    assert_eq!(found["results"][0]["path"], "there/meshes/ball0.off");
    // Nothing has changed.
    let again = place.json("index build there/meshes -n 20 -o there/work/i");
    assert_eq!((&again["unchanged"], &again["renamed"]), (&6.into(), &0.into()));
    // A merge into another folder keeps the way to the meshes.
    place.done("index merge there/work/i -o merged");
    assert!(place.done("index export merged").out.contains("\"path\":\"there/meshes/ball0.off\""));
}

#[test]
fn the_build_says_what_classes_it_took_and_obeys_whoever_chooses() {
    let place = Workplace::new();
    for (class, kind) in [("animals/cat", 0), ("things/ball", 1)] {
        (0..3).for_each(|i| place.add(&format!("meshes/{class}{i}.off"), &body(kind, i)));
    }
    let classes = || place.json("index info all.canonform")["classes"].clone();
    for (source, from, expected) in [
        ("", "folders", json!({"animals": 3, "things": 3})),
        (" --labels names", "names", json!({"ball": 3, "cat": 3})),
        (" --labels none", "none", json!({"": 6})),
    ] {
        let built = place.json(format!("{BUILD}{source}"));
        assert_eq!((&built["labels_from"], &classes()), (&from.into(), &expected));
        // Other classes need no new descriptions.
        assert_eq!(built["described"], if source.is_empty() { 6 } else { 0 });
    }
    let scores = place.json("evaluate all.canonform --labels folders");
    assert_eq!(scores["classes"], json!(["animals", "things"]));
    // A file of labels may be partial, and its other lines are named.
    fs::write(place.path("labels.csv"), "animals/cat0.off,ring\nscan.7,box\nthings/ball0,ball\n").unwrap();
    let outcome = place.done(format!("{BUILD} --labels labels.csv --json"));
    let built = one_object(&outcome.out);
    assert_eq!((&built["unlabelled"], &built["unused_labels"]), (&4.into(), &1.into()));
    assert_eq!(built["unused_label_lines"], json!([{"line": 2, "name": "scan.7"}]));
    let warning = "1 line of labels.csv names no shape: line 2, `scan.7`";
    assert!(outcome.err.contains(warning), "{}", outcome.err);
    assert_eq!(classes(), json!({"": 4, "ball": 1, "ring": 1}));
}

#[test]
fn a_batch_goes_on_past_shapes_that_fail() {
    let place = collection(2);
    place.add("meshes/big0.off", &shapes::icosphere(4));
    fs::write(place.path("meshes/bad.off"), "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 zero\n3 0 1 2\n").unwrap();
    let outcome = place.run(format!("{BUILD} --max-vertices 1000 --json"));
    let json = one_object(&outcome.out);
    assert_eq!((outcome.code, &json["n_shapes"], ids(&json, "failed")), (2, &6.into(), vec!["bad", "big0"]));
    assert_eq!([0, 1].map(|i| &json["failed"][i]["reason"]), ["unreadable", "too-large"]);
    assert!(outcome.err.contains("meshes/bad.off") && outcome.err.contains("line 5"), "{}", outcome.err);
    // The next run, with more room, takes it.
    fs::remove_file(place.path("meshes/bad.off")).unwrap();
    assert_eq!(place.json(BUILD)["n_shapes"], 7);
    for (limit, value, reason) in [("--memory", "100", "memory"), ("--timeout", "0.000001", "time")] {
        let outcome = place.run(format!("index build meshes -o none {limit} {value} --json"));
        let json = one_object(&outcome.out);
        let failed = json["failed"].as_array().unwrap();
        assert!(failed.len() == 7 && failed.iter().all(|failure| failure["reason"] == reason), "{json}");
        assert!(outcome.code == 2 && outcome.err.contains(&format!("raise {limit}")), "{}", outcome.err);
        assert!(!place.path("none").exists(), "an index of nothing");
    }
}
