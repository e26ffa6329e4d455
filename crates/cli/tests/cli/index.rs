//! Building, changing and searching an index.

use std::fs;

use canonform::mesh::{TriMesh, shapes};

use crate::support::{Workplace, one_object};

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

/// A folder `meshes` of one to three classes of three shapes.
pub(crate) fn collection(n_classes: usize) -> Workplace {
    let place = Workplace::new();
    for (kind, name) in ["ring", "ball", "box"].into_iter().enumerate().take(n_classes) {
        (0..3).for_each(|i| place.add(&format!("meshes/{name}{i}.off"), &body(kind, i)));
    }
    place
}

pub(crate) const BUILD: &str = "index build meshes -n 20 -o all.canonform";

#[test]
fn a_folder_becomes_an_index_that_finds_its_shapes() {
    let place = collection(3);
    let built = place.json(BUILD);
    assert_eq!((&built["n_shapes"], &built["described"]), (&9.into(), &9.into()));
    place.add("query.ply", &body(0, 7));
    let found = place.found("all.canonform query.ply -k 4 --explain");
    let results = found["results"].as_array().unwrap();
    assert!(results.len() == 4 && results.iter().zip(1..).all(|(result, rank)| result["rank"] == rank));
    let nearest = ["id", "label", "path"].map(|key| results[0][key].as_str().unwrap());
    assert_eq!(nearest, ["ring2", "ring", "meshes/ring2.off"]);
    // Several queries, one of which cannot be read.
    let outcome = place.run("search all.canonform meshes/box1.off none.off meshes/ball0.off --json");
    let json = one_object(&outcome.out);
    assert_eq!((outcome.code, json["queries"].as_array().unwrap().len()), (2, 2));
    assert_eq!(json["failed"][0]["query"], "none.off");
    let text = place.done("search all.canonform query.ply --explain --exact").out;
    assert!(text.contains("class: ring") && text.contains("9 of 9 shapes measured"), "{text}");
}

#[test]
fn shapes_are_added_and_removed() {
    let place = collection(3);
    place.done(BUILD);
    let export = || place.done("index export all.canonform").out;
    let whole = export();
    place.add("more/ring7.off", &body(0, 7));
    place.add("extra.ply", &body(1, 8));
    for described in [2, 0] {
        let added = place.json("index add all.canonform more extra.ply --label new");
        assert_eq!((&added["described"], &added["n_shapes"]), (&described.into(), &11.into()));
    }
    assert_eq!(place.json("index info all.canonform")["classes"]["new"], 2);
    place.add("more/ring7.off", &body(2, 0));
    let refused = place.run("index add all.canonform more").err;
    assert!(
        ["`ring7`", "more/ring7.off", "--replace"].iter().all(|words| refused.contains(words)),
        "{refused}"
    );
    place.done("index add all.canonform more --replace");
    let removed = place.json("index remove all.canonform ring7 extra ring7");
    assert_eq!((&removed["removed"], &removed["n_shapes"]), (&2.into(), &9.into()));
    assert_eq!(export(), whole);
}

#[test]
fn an_index_is_scored_and_ranked_in_every_order() {
    let place = collection(3);
    place.done(BUILD);
    let scores = place.json("evaluate all.canonform");
    assert_eq!((&scores["nn"], &scores["map"], &scores["n"]), (&1.0.into(), &1.0.into(), &9.into()));
    // The plain scores keep their keys; those of the graph stand beside them.
    let mut both = place.json("evaluate all.canonform --rank graph");
    let graph = both.as_object_mut().and_then(|both| both.remove("graph")).unwrap();
    assert!(both == scores && graph["nn"].is_number(), "{graph}");
    let text = place.done("evaluate all.canonform --rank graph").out;
    assert!(["nearest neighbor", "plain", "graph"].iter().all(|words| text.contains(words)), "{text}");
    assert_ne!(place.json("evaluate all.canonform --by shape-dna")["silhouette"], scores["silhouette"]);
    for (option, key, words) in [
        ("--rank graph", "rank_distance", ["rank distance", "neighbors in common"]),
        ("--rank part", "part_distance", ["part distance", "100 %"]),
        ("--by forms", "form_distance", ["form distance", "forms alone"]),
    ] {
        let found = place.found(format!("all.canonform --id ring1 {option}"));
        let rank = option.split(' ').next_back().unwrap();
        assert_eq!((&found["rank_by"], &found["results"][0]["id"]), (&rank.into(), &"ring1".into()));
        let order = |i: usize| found["results"][i][key].as_f64().unwrap();
        assert!((1..9).all(|i| order(i - 1) <= order(i)), "{found}");
        let text = place.done(format!("search all.canonform --id ring1 {option}")).out;
        assert!(words.iter().all(|words| text.contains(words)), "{text}");
    }
}

#[test]
fn a_matrix_of_distances_is_scored() {
    let place = Workplace::new();
    let rows = "0,1,2,9,9,9\n1,0,1,9,9,9\n2,1,0,9,9,9\n9,9,9,0,2,3\n9,9,9,2,0,2\n9,9,9,3,2,0\n";
    fs::write(place.path("bare.csv"), rows).unwrap();
    fs::write(place.path("labels.csv"), "a\na\na\nb\nb\nb\n").unwrap();
    let scores = place.json("evaluate bare.csv --labels labels.csv");
    assert_eq!((&scores["nn"], &scores["confusion"]), (&1.0.into(), &serde_json::json!([[3, 0], [0, 3]])));
}
