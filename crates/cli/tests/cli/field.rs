//! `field`: building, pairs, rows, nearest vertices, damaged files.

use std::fs;

use serde_json::json;

use crate::support::{Workplace, broken_ring, read_npy, ring};

fn place() -> Workplace {
    let place = Workplace::new();
    place.add("ring.off", &ring());
    let json = place.json("field build ring.off --method exact --landmarks 20 -o x.field");
    assert_eq!(
        (&json["bounds"]["kind"], &json["n_landmarks"], &json["rank"]),
        (&json!("certified"), &json!(20), &json!(10))
    );
    assert_eq!(json["bytes"], json!(fs::metadata(place.path("x.field")).unwrap().len()));
    place
}

#[test]
fn pairs_rows_and_nearest_vertices_are_answered_in_every_format() {
    let place = place();
    fs::write(place.path("pairs.csv"), "a,b\n3,99\n99,3\n3,4\n3,3\n").unwrap();
    let json = place.json("field query x.field --pairs pairs.csv --tolerance 0.02");
    let pairs = json["pairs"].as_array().unwrap();
    assert_eq!((&pairs[0]["a"], &pairs[0]["b"], &pairs[1]["a"]), (&json!(3), &json!(99), &json!(99)));
    assert_eq!((pairs.len(), &pairs[3]["distance"]), (4, &json!(0.0)));
    let nearest = place.json("field query x.field --source 3,40 --nearest 5");
    assert_eq!(nearest["pairs"].as_array().unwrap().len(), 10);
    let text = place.done("field query x.field --pairs pairs.csv").out;
    assert!(text.contains("distance") && text.contains(" exact"), "{text}");
    assert_eq!(place.json("field query x.field --pairs pairs.csv -o found.npy")["pairs"], json!([]));
    let (shape, rows) = read_npy(&place.path("found.npy"));
    assert_eq!((shape, &rows[..2]), (vec![4, 5], &[3.0, 99.0][..]));
    place.done("field query x.field --pairs pairs.csv -o found.csv");
    let table = fs::read_to_string(place.path("found.csv")).unwrap();
    assert!(table.starts_with("a,b,distance,lower,upper,kind\n3,99,") && table.lines().count() == 5);
    // Vertices that a repair dropped have no distance.
    place.add("a.off", &broken_ring());
    place.run("field build a.off --max-dropped 1 -o a.field");
    let json = place.json("field query a.field --source 100 --tolerance none");
    assert_eq!((&json["bounds"]["kind"], &json["dropped"]), (&json!("measured"), &json!(10)));
    let info = place.json("field info a.field");
    assert_eq!((&info["n_vertices"], &info["method"]), (&json!(170), &json!("fast-marching")));
}
