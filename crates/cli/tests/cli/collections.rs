//! Folders and indexes as people keep them: links, strange names, labels, limits, moves, damage.

use std::fs;

use canonform::mesh::shapes;
use serde_json::{Value, json};

use crate::index::body;
use crate::support::{Workplace, assert_keys, one_object};

/// Six shapes of two classes.
fn collection() -> Workplace {
    let place = Workplace::new();
    for (kind, name) in ["ring", "ball"].into_iter().enumerate() {
        (0..3).for_each(|i| place.add(&format!("meshes/{name}{i}.off"), &body(kind, i)));
    }
    place
}

const BUILD: [&str; 7] = ["index", "build", "meshes", "-n", "20", "-o", "all.canonform"];

fn build(place: &Workplace) {
    place.done(&BUILD);
}

fn ids(json: &Value) -> Vec<&str> {
    json["shapes"].as_array().unwrap().iter().map(|shape| shape["id"].as_str().unwrap()).collect()
}

#[test]
fn a_build_keeps_what_did_not_come_from_its_folder() {
    let place = collection();
    build(&place);
    place.add("more/box0.off", &body(2, 0));
    place.add("extra.ply", &body(2, 1));
    place.done("index add all.canonform more extra.ply --label box");
    fs::remove_file(place.path("meshes/ring1.off")).unwrap();
    let kept = place.json(&BUILD);
    let counts = ["n_shapes", "removed", "elsewhere", "pruned"].map(|key| kept[key].as_u64().unwrap());
    assert_eq!(counts, [7, 1, 2, 0]);
    // The next run has nothing to do, and says the same.
    let before = fs::read(place.path("all.canonform")).unwrap();
    let outcome = place.done(&BUILD);
    assert!(outcome.out.contains("from elsewhere") && outcome.err.contains("--prune"), "{}", outcome.err);
    assert_eq!(fs::read(place.path("all.canonform")).unwrap(), before);
    let pruned = place.json(&[&BUILD[..], &["--prune"]].concat());
    let counts = ["n_shapes", "removed", "elsewhere", "pruned"].map(|key| pruned[key].as_u64().unwrap());
    assert_eq!(counts, [5, 0, 0, 2]);
}

#[test]
fn shapes_are_listed_by_class() {
    let place = collection();
    build(&place);
    place.add("extra.ply", &body(2, 1));
    fs::write(place.path("none.csv"), "other,x\n").unwrap();
    place.done("index add all.canonform extra.ply --labels none.csv");
    let all = place.json("index list all.canonform");
    assert_eq!(all["n_shapes"], 7);
    assert_eq!(ids(&all), ["ball0", "ball1", "ball2", "extra", "ring0", "ring1", "ring2"]);
    assert_keys(&all["shapes"][0], "id label path vertices faces");
    assert_eq!(
        (&all["shapes"][0]["path"], &all["shapes"][0]["vertices"]),
        (&"meshes/ball0.off".into(), &162.into())
    );
    let some = place.json("index list all.canonform --label ring --unlabelled");
    assert_eq!(ids(&some), ["extra", "ring0", "ring1", "ring2"]);
    let text = place.done("index list all.canonform --label ball").out;
    assert!(text.contains("meshes/ball2.off") && text.contains("3 of 7 shapes"), "{text}");
    assert_eq!(place.run("index list all.canonform --label cat").code, 1);
    assert_eq!(place.json("index info all.canonform")["unlabelled"], 1);
}

#[test]
fn queries_are_meshes_folders_and_shapes_of_the_index() {
    let place = collection();
    build(&place);
    let search = |rest: &[&str]| place.found(&[&["all.canonform"], rest].concat());
    let by_id = search(&["ring1"]);
    let by_mesh = search(&["meshes/ring1.off"]);
    assert_eq!((&by_id["query"], &by_id["results"][0]["id"]), (&"ring1".into(), &"ring1".into()));
    let places = |json: &Value| -> Vec<String> {
        json["results"].as_array().unwrap().iter().map(|result| result["id"].to_string()).collect()
    };
    assert_eq!(places(&by_id), places(&by_mesh));
    // A file goes before a shape of the same name, unless the shape is asked for.
    fs::copy(place.path("meshes/ball0.off"), place.path("ring0")).unwrap();
    assert_eq!(search(&["--id", "ring0"])["results"][0]["id"], "ring0");
    for (query, words) in [
        ("ring0", ["ring0", ""]),
        ("--id cat", ["`cat`", "index list"]),
        ("cat", ["neither a file nor a shape", "index list"]),
        ("old/ring2.off", ["neither a file nor a shape", "did you mean `ring2`?"]),
        ("--id Ring2", ["no shape `Ring2`", "did you mean `ring2`?"]),
    ] {
        place.refused(format!("search all.canonform {query}"), &words);
    }
    // One query and many have the same keys.
    let many = place.json("search all.canonform meshes --id ring2");
    assert_eq!(many["queries"].as_array().unwrap().len(), 7);
    assert!(many.get("results").is_none() && many["failed"].as_array().unwrap().is_empty());
    // Without results the class is predicted all the same.
    let none = search(&["ball1", "-k", "0"]);
    assert!(none["results"].as_array().unwrap().is_empty() && none["predicted"]["label"] == "ball");
    for json in [&by_id, &many["queries"][0], &none] {
        assert_keys(json, "query results predicted n_shapes seconds");
    }
    let text = place.done("search all.canonform ball1 -k 0").out;
    assert!(text.contains("class: ball"), "{text}");
    // No more than there are.
    assert_eq!(places(&search(&["ball1", "-k", "9223372036854775807"])).len(), 6);
}

#[test]
fn an_index_moves_with_its_folder() {
    let place = collection();
    fs::create_dir_all(place.path("here/work")).unwrap();
    fs::rename(place.path("meshes"), place.path("here/meshes")).unwrap();
    place.done("index build here/meshes -n 20 -o here/work/i");
    let absolute = place.path("here/meshes");
    place.done(&["index", "build", absolute.to_str().unwrap(), "-n", "20", "-o", "here/work/j"]);
    let export = |index: &str| place.done(&["index", "export", index]).out;
    let text = export("here/work/i");
    assert_eq!(export("here/work/j"), text, "relative or absolute");
    assert!(text.contains("\"path\":\"../meshes/ball0.off\""), "{text}");
    fs::rename(place.path("here"), place.path("there")).unwrap();
    let found = place.found("there/work/i ball0 -k 1");
    assert_eq!(found["results"][0]["path"], "there/meshes/ball0.off");
    // Nothing has changed.
    let again = place.json("index build there/meshes -n 20 -o there/work/i");
    assert_eq!((&again["unchanged"], &again["renamed"]), (&6.into(), &0.into()));
    // A merge into another folder keeps the way to the meshes.
    place.done("index merge there/work/i -o merged");
    assert!(export("merged").contains("\"path\":\"there/meshes/ball0.off\""));
}

#[test]
fn the_build_says_what_classes_it_took_and_obeys_whoever_chooses() {
    let place = Workplace::new();
    for (class, kind) in [("animals/cat", 0), ("things/ball", 1)] {
        (0..3).for_each(|i| place.add(&format!("meshes/{class}{i}.off"), &body(kind, i)));
    }
    let build = BUILD.join(" ");
    let classes = || place.json("index info all.canonform")["classes"].clone();
    for (source, from, expected, said) in [
        ("", "folders", json!({"animals": 3, "things": 3}), "2 from sub-folders; pass --labels none"),
        (" --labels names", "names", json!({"ball": 3, "cat": 3}), "2 from leading letters"),
        (" --labels none", "none", json!({"": 6}), "none"),
    ] {
        let built = place.json(format!("{build}{source}"));
        assert_eq!((&built["labels_from"], &classes()), (&from.into(), &expected));
        let told = place.done(format!("{build}{source}")).out;
        assert!(told.lines().any(|line| line.contains("classes") && line.contains(said)), "{told}");
    }
    // Without classes there is nothing to say of them.
    let told = place.done("search all.canonform animals/cat0").out;
    assert!(!told.contains("class:") && !told.contains("│ class "), "{told}");
    let scores = place.json("evaluate all.canonform --labels folders");
    assert_eq!(scores["classes"], json!(["animals", "things"]));
    place.refused("evaluate all.canonform", &["--labels"]);
    place.refused("search all.canonform cat0", &["did you mean `animals/cat0`?"]);
    // A file of labels may be partial, and its other lines are named.
    fs::write(place.path("labels.csv"), "animals/cat0.off,ring\nscan.7,box\nthings/ball0,ball\n").unwrap();
    let labelled = format!("{build} --labels labels.csv");
    let built = place.json(&*labelled);
    assert_eq!((&built["unlabelled"], &built["unused_labels"]), (&4.into(), &1.into()));
    assert_eq!(built["unused_label_lines"], json!([{"line": 2, "name": "scan.7"}]));
    let warned = place.done(&*labelled).err;
    assert!(warned.contains("1 line of labels.csv names no shape: line 2, `scan.7`"), "{warned}");
    assert_eq!(classes(), json!({"": 4, "ball": 1, "ring": 1}));
    // Numbers are no classes.
    fs::remove_dir_all(place.path("meshes")).unwrap();
    (0..4).for_each(|i| place.add(&format!("meshes/T17{i}.off"), &body(i % 2, i)));
    let outcome = place.done("index build meshes -n 20 -o numbers");
    assert!(outcome.err.contains("`T`") && outcome.err.contains("--labels"), "{}", outcome.err);
    assert_eq!(place.found("numbers T170")["predicted"]["label"], Value::Null);
}

#[test]
fn a_batch_goes_on_past_shapes_beyond_its_limits() {
    let place = collection();
    place.add("meshes/big0.off", &shapes::icosphere(4));
    let outcome = place.run(&[&BUILD[..], &["--max-vertices", "1000", "--json"]].concat());
    let json = one_object(&outcome.out);
    assert_eq!((outcome.code, &json["n_shapes"]), (2, &6.into()));
    let failed = json["failed"].as_array().unwrap();
    assert_eq!(
        (failed.len(), &failed[0]["id"], &failed[0]["reason"]),
        (1, &"big0".into(), &"too-large".into())
    );
    // The next run, with more room, takes it.
    assert_eq!(place.json(&BUILD)["n_shapes"], 7);
    for (limit, value, reason) in [("--memory", "100", "memory"), ("--timeout", "0.000001", "time")] {
        let outcome = place.run(&["index", "build", "meshes", "-o", "none", limit, value, "--json"]);
        let json = one_object(&outcome.out);
        let failed = json["failed"].as_array().unwrap();
        assert!(failed.len() == 7 && failed.iter().all(|failure| failure["reason"] == reason), "{json}");
        assert!(outcome.code == 2 && outcome.err.contains(&format!("raise {limit}")), "{}", outcome.err);
    }
    place.add("more/box.off", &body(2, 0));
    let outcome = place.run("index add all.canonform more --max-vertices 9");
    assert!(outcome.code == 2 && outcome.out.contains("1 too large"), "{}", outcome.out);
}

#[cfg(unix)]
#[test]
fn links_and_special_files_are_skipped_and_counted() {
    use std::os::unix::fs::symlink;

    let place = collection();
    let at = |name: &str| place.path(&format!("meshes/{name}"));
    symlink(".", at("self")).unwrap();
    symlink("/dev/zero", at("endless.off")).unwrap();
    assert!(std::process::Command::new("mkfifo").arg(at("pipe.off")).status().unwrap().success());
    fs::write(at("notes.txt"), "").unwrap();
    let json = place.json(&BUILD);
    assert_eq!(json["n_shapes"], 6);
    assert_eq!(json["skipped"], json!({".txt": 1, "link to something found already": 1, "special file": 2}));
    let outcome = place.done(&BUILD);
    assert!(outcome.out.contains("special file (2)") && outcome.err.contains("meshes/pipe.off"));
    // Given by name they are errors.
    for name in ["meshes/pipe.off", "meshes/endless.off"] {
        let outcome = place.run(&["index", "add", "all.canonform", name]);
        assert!(outcome.code == 2 && outcome.err.contains("not a regular file"), "{}", outcome.err);
    }
}

#[cfg(unix)]
#[test]
fn names_do_not_control_the_terminal() {
    let place = collection();
    fs::write(place.path("meshes/\u{1b}[31mred.off"), "OFF\n").unwrap();
    place.add("meshes/\u{1b}[2Jclear.off", &body(0, 5));
    let built = place.run(&BUILD);
    let listed = place.done("index list all.canonform");
    for outcome in [&built, &listed] {
        assert!(!outcome.out.contains('\u{1b}') && !outcome.err.contains('\u{1b}'), "{}", outcome.err);
    }
    assert!(
        built.err.contains("\\u{1b}[31mred.off") && listed.out.contains("\\u{1b}[2Jclear"),
        "{}",
        built.err
    );
}

#[test]
fn a_damaged_index_is_built_again() {
    let place = collection();
    build(&place);
    let text = place.done("index export all.canonform").out;
    let mut bytes = fs::read(place.path("all.canonform")).unwrap();
    for byte in &mut bytes[4096..] {
        *byte ^= 1;
    }
    let end = bytes.len();
    bytes[end - 1] ^= 1;
    fs::write(place.path("all.canonform"), &bytes).unwrap();
    for command in [&["index", "info", "all.canonform"][..], &["search", "all.canonform", "ring0"]] {
        place.refused(command, &["all.canonform is damaged", "index build"]);
    }
    let outcome = place.run(&[&BUILD[..], &["--json"]].concat());
    assert_eq!(outcome.code, 0, "{}", outcome.err);
    assert_eq!(one_object(&outcome.out)["replaced_damaged"], true);
    assert!(outcome.err.contains("all.canonform.damaged"), "{}", outcome.err);
    assert_eq!(place.done("index export all.canonform").out, text);
    assert_eq!(fs::read(place.path("all.canonform.damaged")).unwrap(), bytes);
}
