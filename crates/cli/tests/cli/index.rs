//! Building, changing and searching an index.

use std::fs;

use canonform::mesh::{TriMesh, shapes};
use serde_json::Value;

use crate::support::{Workplace, assert_keys, one_object};

/// A closed surface of one of three kinds; variants of a kind differ slightly.
pub(crate) fn body(kind: usize, variant: usize) -> TriMesh {
    let mut mesh = match kind {
        0 => shapes::torus(14, 8, 2.0, 0.6),
        1 => shapes::icosphere(2),
        _ => shapes::cube(4),
    };
    let (a, b) = (1.0 + 0.02 * variant as f64, [1.0, 1.6, 2.5][kind]);
    for p in &mut mesh.positions {
        *p = [p.x * a, p.y * b, p.z + 0.01 * variant as f64 * p.x * p.x].into();
    }
    mesh
}

/// Nine shapes of three classes.
fn collection() -> Workplace {
    let place = Workplace::new();
    for (kind, name) in ["ring", "ball", "box"].into_iter().enumerate() {
        (0..3).for_each(|i| place.add(&format!("meshes/{name}{i}.off"), &body(kind, i)));
    }
    place
}

const BUILD: [&str; 7] = ["index", "build", "meshes", "-n", "20", "-o", "all.canonform"];

fn export(place: &Workplace, index: &str) -> String {
    place.done(&["index", "export", index]).out
}

#[test]
fn a_folder_becomes_an_index_that_finds_its_shapes() {
    let place = collection();
    let built = place.json(&BUILD);
    assert_eq!((&built["n_shapes"], &built["described"]), (&9.into(), &9.into()));
    place.add("query.ply", &body(0, 7));
    let found = place.found("all.canonform query.ply -k 4 --explain");
    assert_keys(&found, "query results predicted seconds");
    let results = found["results"].as_array().unwrap();
    assert_eq!(results.len(), 4);
    for (i, result) in results.iter().enumerate() {
        assert_keys(result, "rank id label path distance relation comparison");
        assert_eq!(result["rank"], i + 1);
    }
    assert_eq!((&results[0]["label"], &results[0]["id"]), (&"ring".into(), &"ring2".into()));
    assert_eq!(results[0]["path"], "meshes/ring2.off");
    assert_eq!(found["predicted"]["label"], "ring");
    assert!(found["predicted"]["votes"].as_u64().unwrap() >= 3);
    // An indexed shape is at distance zero from itself.
    let own = place.found("all.canonform meshes/box1.off");
    assert_eq!(own["results"][0]["id"], "box1");
    assert!(own["results"][0]["distance"].as_f64().unwrap() < 1e-3, "{own}");
    assert_eq!(own["results"].as_array().unwrap().len(), 9);
    // Several queries, one of which cannot be read.
    let outcome = place.run("search all.canonform meshes/box1.off none.off meshes/ball0.off --json");
    let json = one_object(&outcome.out);
    assert_eq!((outcome.code, json["queries"].as_array().unwrap().len()), (2, 2));
    assert_eq!(json["failed"][0]["query"], "none.off");
    let text = place.done("search all.canonform query.ply --explain --exact").out;
    assert!(text.contains("class: ring") && text.contains("9 of 9 shapes measured"), "{text}");
}

#[test]
fn an_unknown_class_is_explained() {
    let place = Workplace::new();
    (0..3).for_each(|i| place.add(&format!("meshes/rings/{i}.off"), &body(0, i)));
    place.done(&[&BUILD[..], &["--labels", "folders"]].concat());
    // A long thin cone that is open at its base.
    let mut cone = canonform::mesh::shapes::grid(40, 12, 1.0);
    for p in &mut cone.positions {
        let (turn, along) = (p.x / 39.0 * std::f64::consts::TAU, (p.y + 0.1) / 11.0);
        *p = [along * turn.cos(), along * turn.sin(), 30.0 * along].into();
    }
    place.add("part.off", &cone);
    let found = place.found("all.canonform part.off");
    let (predicted, nearest) = (&found["predicted"], &found["results"][0]);
    assert_eq!((&predicted["label"], &predicted["unknown"]), (&serde_json::Value::Null, &"partial".into()));
    assert_eq!(predicted["nearest"]["id"], nearest["id"]);
    assert_eq!(predicted["nearest"]["relation"], nearest["relation"]);
    let text = place.done("search all.canonform part.off").out;
    let distance = format!("{:.3}", nearest["distance"].as_f64().unwrap());
    let said = [predicted["explanation"].as_str().unwrap(), "class: unknown. The nearest shape", &distance];
    assert!(said.iter().all(|words| text.contains(words)), "{text}");
}

#[test]
fn an_explained_result_has_the_numbers_of_the_comparison() {
    let place = collection();
    place.done("index build meshes -o all.canonform");
    place.add("query.ply", &body(0, 7));
    let found = place.found("all.canonform query.ply -k 2 --explain");
    let result = &found["results"][1];
    let (explained, path) = (result["comparison"].as_object().unwrap(), result["path"].as_str().unwrap());
    assert!(explained.len() >= 10, "{explained:?}");
    let compared = place.json(&["compare", "query.ply", path]);
    for (key, value) in explained {
        assert_eq!(*value, compared[key], "{path}: {key}");
    }
    assert_eq!(result["distance"], compared["combined_distance"]);
    let told = &result["relation"];
    assert_eq!(told["kind"], compared["relation"]["kind"]);
    let text = place.done("search all.canonform query.ply -k 2 --explain").out;
    for words in [&told["text"], &told["because"]["text"]] {
        assert!(text.contains(words.as_str().unwrap()), "{text}");
    }
}

#[test]
fn only_changed_meshes_are_described_again() {
    let place = collection();
    place.done(&BUILD);
    let before = fs::read(place.path("all.canonform")).unwrap();
    let again = place.json(&BUILD);
    assert_eq!((&again["described"], &again["unchanged"]), (&0.into(), &9.into()));
    assert_eq!(fs::read(place.path("all.canonform")).unwrap(), before, "not even written");
    place.add("meshes/ring1.off", &body(0, 5));
    place.add("meshes/ring9.off", &body(0, 6));
    fs::remove_file(place.path("meshes/box0.off")).unwrap();
    let changed = place.json(&BUILD);
    let counts = ["described", "unchanged", "removed", "n_shapes"].map(|key| changed[key].as_u64().unwrap());
    assert_eq!(counts, [2, 7, 1, 9]);
    let text = export(&place, "all.canonform");
    fs::remove_file(place.path("all.canonform")).unwrap();
    place.done(&BUILD);
    assert_eq!(export(&place, "all.canonform"), text, "as if built from scratch");
    // Changing classes needs no new descriptions.
    fs::write(place.path("labels.csv"), export_labels(&text)).unwrap();
    let labelled = place.json(&[&BUILD[..], &["--labels", "labels.csv"]].concat());
    assert_eq!((&labelled["described"], &labelled["renamed"]), (&0.into(), &9.into()));
    assert!(export(&place, "all.canonform").contains("\"label\":\"of ring\""));
}

/// A label file that calls a `ring` an `of ring`.
fn export_labels(text: &str) -> String {
    let shapes = text.lines().skip(1).map(|line| serde_json::from_str::<Value>(line).unwrap());
    let line = |s: Value| format!("{},of {}\n", s["id"].as_str().unwrap(), s["label"].as_str().unwrap());
    shapes.map(line).collect()
}

#[test]
fn merged_shards_equal_the_whole_index() {
    let place = collection();
    place.done(&BUILD);
    for i in ["1", "2", "3", "4"] {
        let shard = format!("{i}/4");
        let output = format!("part{i}");
        let counts = place.json(&["index", "build", "meshes", "-n", "20", "--shard", &shard, "-o", &output]);
        assert!((2..=3).contains(&counts["n_shapes"].as_u64().unwrap()));
    }
    let parts = ["part3", "part1", "part4", "part2", "part1"];
    let merged = place.json(&[&["index", "merge", "-o", "merged"], &parts[..]].concat());
    assert_eq!((&merged["n_shapes"], &merged["repeated"]), (&9.into(), &3.into()));
    assert_eq!(export(&place, "merged"), export(&place, "all.canonform"));
    place.refused("index build meshes --shard 5/4 -o x", &["--shard", "5", "4"]);
    place.add("meshes/ring0.off", &body(0, 3));
    place.done("index build meshes -n 20 -o new");
    place.refused("index merge part1 part2 part3 part4 new -o x", &["`ring0`", "new"]);
    place.done("index build meshes -n 21 -o other");
    place.refused("index merge new other -o x", &["other options", "21", "20"]);
    assert!(!place.path("x").exists());
}

#[test]
fn shapes_are_added_and_removed() {
    let place = collection();
    place.done(&BUILD);
    let whole = export(&place, "all.canonform");
    place.add("more/ring7.off", &body(0, 7));
    place.add("extra.ply", &body(1, 8));
    let added = place.json("index add all.canonform more extra.ply --label new");
    assert_eq!((&added["described"], &added["n_shapes"]), (&2.into(), &11.into()));
    assert_eq!(place.json("index info all.canonform")["classes"]["new"], 2);
    let again = place.json("index add all.canonform more --label new");
    assert_eq!((&again["described"], &again["n_shapes"]), (&0.into(), &11.into()));
    place.add("more/ring7.off", &body(2, 0));
    place.refused("index add all.canonform more", &["`ring7`", "more/ring7.off", "--replace"]);
    place.done("index add all.canonform more --replace");
    place.refused("index remove all.canonform ring7 cat5", &["`cat5`", "all.canonform"]);
    let removed = place.json("index remove all.canonform ring7 extra ring7");
    assert_eq!((&removed["removed"], &removed["n_shapes"]), (&2.into(), &9.into()));
    assert_eq!(export(&place, "all.canonform"), whole);
}

#[test]
fn failed_meshes_are_listed_and_left_out() {
    let place = collection();
    fs::write(place.path("meshes/bad.off"), "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 zero\n3 0 1 2\n").unwrap();
    for _ in 0..2 {
        let outcome = place.run(&[&BUILD[..], &["--json"]].concat());
        let json = one_object(&outcome.out);
        assert_eq!((outcome.code, &json["n_shapes"]), (2, &9.into()));
        assert_eq!(json["failed"][0]["id"], "bad");
        assert!(outcome.err.contains("meshes/bad.off") && outcome.err.contains("line 5"), "{}", outcome.err);
    }
    // A shape whose file has become unreadable is removed.
    fs::write(place.path("meshes/ring1.off"), "OFF\n").unwrap();
    let outcome = place.run(&[&BUILD[..], &["--json"]].concat());
    let json = one_object(&outcome.out);
    assert_eq!((&json["n_shapes"], &json["removed"]), (&8.into(), &1.into()));
    // If every mesh fails, no index is written.
    fs::create_dir(place.path("broken")).unwrap();
    fs::write(place.path("broken/a.off"), "OFF\n").unwrap();
    let outcome = place.run("index build broken -o none");
    assert_eq!(outcome.code, 2);
    assert!(!place.path("none").exists());
}

#[test]
fn an_index_is_verified_described_and_scored() {
    let place = collection();
    place.done(&BUILD);
    let sound = place.json("index verify all.canonform");
    assert_eq!((&sound["sound"], &sound["n_shapes"]), (&true.into(), &9.into()));
    let info = place.json("index info all.canonform");
    assert_eq!((&info["n_shapes"], &info["options"]["samples"]), (&9.into(), &20.into()));
    let scores = place.json("evaluate all.canonform");
    assert_keys(&scores, "n classes nn ft st e dcg map knn_accuracy confusion silhouette intervals");
    // The plain scores keep their keys; those of the graph stand beside them.
    let mut both = place.json("evaluate all.canonform --rank graph");
    let graph = both.as_object_mut().and_then(|both| both.remove("graph")).unwrap();
    assert_eq!(both, scores);
    assert_keys(&graph, "nn ft st e dcg map knn_accuracy confusion intervals");
    let text = place.done("evaluate all.canonform --rank graph").out;
    assert!(text.contains("plain") && text.contains("graph"), "{text}");
    for (option, key, words) in [
        ("--rank graph", "rank_distance", ["rank distance", "neighbours in common"]),
        ("--rank part", "part_distance", ["part distance", "100 %"]),
        ("--rank forms", "form_distance", ["form distance", "forms alone"]),
        ("--by forms", "form_distance", ["form distance", "forms alone"]),
    ] {
        let found = place.found(format!("all.canonform --id ring1 {option}").as_str());
        let rank = option.split(' ').next_back().unwrap();
        assert_eq!((&found["rank_by"], &found["results"][0]["id"]), (&rank.into(), &"ring1".into()));
        let order = |i: usize| found["results"][i][key].as_f64().unwrap();
        assert!((1..9).all(|i| order(i - 1) <= order(i)), "{found}");
        let text = place.done(format!("search all.canonform --id ring1 {option}")).out;
        assert!(words.iter().all(|words| text.contains(words)), "{text}");
    }
    for (command, words) in [
        ("evaluate all.canonform --rank best", ["best", "possible values: plain, graph"]),
        (
            "search all.canonform --id ring1 --rank best",
            ["best", "possible values: plain, graph, part, forms"],
        ),
        ("evaluate all.canonform --by colour", ["colour", "shape-dna"]),
    ] {
        place.refused(command, &words);
    }
    assert_eq!((&scores["nn"], &scores["map"], &scores["n"]), (&1.0.into(), &1.0.into(), &9.into()));
    let dna = place.json("evaluate all.canonform --by shape-dna");
    assert_ne!(dna["silhouette"], scores["silhouette"]);
    assert!(place.done("evaluate all.canonform").out.contains("nearest neighbour"));
    // A file gets the same text as standard output.
    place.done("index export all.canonform -o all.jsonl");
    assert_eq!(fs::read_to_string(place.path("all.jsonl")).unwrap(), export(&place, "all.canonform"));
    // Damage one byte of a name.
    let mut bytes = fs::read(place.path("all.canonform")).unwrap();
    let name = bytes.windows(16).position(|bytes| bytes == b"meshes/ring1.off").unwrap();
    bytes[name] ^= 4;
    fs::write(place.path("all.canonform"), bytes).unwrap();
    let outcome = place.run("index verify all.canonform --json");
    assert_eq!((outcome.code, &one_object(&outcome.out)["sound"]), (2, &false.into()));
    assert!(outcome.err.contains("all.canonform is damaged"), "{}", outcome.err);
}

#[test]
fn a_matrix_of_distances_is_scored() {
    let place = Workplace::new();
    let rows = "0,1,2,9,9,9\n1,0,1,9,9,9\n2,1,0,9,9,9\n9,9,9,0,2,3\n9,9,9,2,0,2\n9,9,9,3,2,0\n";
    fs::write(place.path("bare.csv"), rows).unwrap();
    fs::write(place.path("named.csv"), format!("a1,a2,a3,b1,b2,b3\n{rows}")).unwrap();
    fs::write(place.path("labels.csv"), "a\na\na\nb\nb\nb\n").unwrap();
    let scores = place.json("evaluate named.csv");
    assert_eq!((&scores["nn"], &scores["confusion"]), (&1.0.into(), &serde_json::json!([[3, 0], [0, 3]])));
    assert_eq!(place.json("evaluate bare.csv --labels labels.csv"), scores);
    place.refused("evaluate bare.csv", &["bare.csv", "--labels"]);
    place.refused("evaluate none.csv", &["none.csv", "No such file"]);
    place.refused("evaluate labels.csv", &["labels.csv"]);
}

#[test]
#[ignore = "slow: make test-all"]
fn an_index_takes_the_options_of_embed_and_applies_them_to_queries() {
    let place = collection();
    for name in ["ring2", "ball0", "ball1", "ball2"] {
        fs::remove_file(place.path(&format!("meshes/{name}.off"))).unwrap();
    }
    place.done(&BUILD);
    for (options, text) in [
        ("--geodesic dijkstra", "\"geodesic\":\"dijkstra\""),
        (
            "--method landmark --sampling random --seed 3",
            "\"sampling\":\"random\",\"method\":\"landmark\",\"seed\":3",
        ),
        ("--method mds", "\"method\":\"mds\""),
        ("--method kpca", "\"kpca\":{"),
        ("--rank 9", "\"rank\":9"),
    ] {
        let options: Vec<&str> = options.split(' ').collect();
        let build = [&["index", "build", "meshes", "-n", "20", "-o", "other"], &options[..]].concat();
        place.done(&build);
        assert!(export(&place, "other").contains(&text.replace('"', "\\\"")), "{text}");
        place.refused("index merge all.canonform other -o x", &["other options"]);
        place.refused("index build meshes -n 20 -o other", &["other options"]);
        let found = place.found("other meshes/box1.off -k 3 --explain");
        let results = found["results"].as_array().unwrap();
        assert_eq!(
            (&results[0]["id"], &results[0]["relation"]["kind"]),
            (&"box1".into(), &"identical-file".into())
        );
        assert!(results.iter().all(|result| result["label"] == "box"), "{options:?}: {found}");
        place.add("more/box9.off", &body(2, 9));
        assert_eq!(place.json("index add other more")["described"], 1);
        fs::remove_file(place.path("other")).unwrap();
    }
    // A seed without effect does not make options different.
    let again = place.json(&[&BUILD[..], &["--seed", "5"]].concat());
    assert_eq!(again["unchanged"], 5);
    place.refused("index build meshes --dim 2 -o x", &["3 dimensions", "2", "--dim"]);
    place.refused("index build meshes --sigma 1 -o x", &["--sigma has no effect", "kpca"]);
}

#[test]
fn errors_name_files_that_are_not_indexes_or_cannot_be_written() {
    let place = collection();
    place.done(&BUILD);
    let before = fs::read(place.path("all.canonform")).unwrap();
    fs::write(place.path("notes.txt"), "dear diary").unwrap();
    fs::create_dir(place.path("folder")).unwrap();
    for (command, words) in [
        ("index info notes.txt", &["notes.txt", "not a shape index"][..]),
        ("search notes.txt meshes/box0.off", &["notes.txt", "not a shape index"]),
        ("evaluate notes.txt", &["notes.txt", "not a shape index"]),
        ("index build meshes -o notes.txt", &["notes.txt", "not a shape index"]),
        ("index info none", &["none", "No such file"]),
        ("index build meshes -o nowhere/a", &["nowhere", "create it first"]),
        ("index build nowhere -o a", &["nowhere"]),
        ("index build meshes -n 30 -o all.canonform", &["other options", "30", "20"]),
        ("index build meshes -n 3 -o a", &["at least 8 samples", "3"]),
        ("search all.canonform none.off", &["none.off"]),
        ("index build meshes -o folder", &["folder", "this is a folder"]),
        ("index info folder", &["folder", "this is a folder"]),
    ] {
        place.refused(command, words);
    }
    assert_eq!(fs::read(place.path("all.canonform")).unwrap(), before);
    assert_eq!(fs::read_to_string(place.path("notes.txt")).unwrap(), "dear diary");
}
