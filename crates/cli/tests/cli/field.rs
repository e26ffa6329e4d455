//! `field`: answers in files, and dropped vertices.

use std::fs;

use serde_json::json;

use crate::support::{Workplace, broken_ring, read_npy};

#[test]
fn pairs_and_rows_are_answered_in_every_format() {
    let place = Workplace::new();
    // Vertices that a repair dropped have no distance.
    place.add("a.off", &broken_ring());
    place.run("field build a.off --max-dropped 1 -o a.field");
    assert_eq!(place.json("field info a.field")["n_vertices"], 170);
    let row = place.json("field query a.field --source 100 --tolerance none");
    assert_eq!([&row["bounds"]["kind"], &row["dropped"]], [&json!("measured"), &json!(10)]);
    fs::write(place.path("pairs.csv"), "a,b\n3,99\n99,3\n3,4\n3,3\n").unwrap();
    let query = "field query a.field --pairs pairs.csv -o";
    assert_eq!(place.json(format!("{query} found.npy"))["pairs"], json!([]));
    let (shape, rows) = read_npy(&place.path("found.npy"));
    assert_eq!((shape, &rows[..2], rows[17]), (vec![4, 5], &[3.0, 99.0][..], 0.0));
    place.done(format!("{query} found.csv"));
    let table = fs::read_to_string(place.path("found.csv")).unwrap();
    assert!(table.starts_with("a,b,distance,lower,upper,kind\n3,99,") && table.lines().count() == 5);
}
