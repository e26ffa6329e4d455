//! `canonform duplicates`.

use std::fs;

use canonform::mesh::shapes;
use nalgebra::{Point3, Rotation3};
use serde_json::{Value, json};
use testkit::tree;

use crate::support::Workplace;

#[test]
fn files_of_one_shape_are_one_group_and_nothing_is_changed() {
    let place = Workplace::new();
    let mesh = shapes::lopsided_torus();
    place.add("models/original.off", &mesh);
    fs::copy(place.path("models/original.off"), place.path("models/copy of original.off")).unwrap();
    type Change = fn(Point3<f64>) -> Point3<f64>;
    let changes: [(&str, Change); 3] = [
        ("turned and moved.ply", |p| Rotation3::from_euler_angles(0.4, 1.0, -0.3) * p),
        ("large.off", |p| p * 25.4),
        ("mirror image.off", |p| [-p.x, p.y, p.z].into()),
    ];
    for (name, change) in changes {
        let mut mesh = mesh.clone();
        mesh.positions.iter_mut().for_each(|p| *p = change(*p));
        place.add(&format!("models/{name}"), &mesh);
    }
    place.add("models/ball.off", &shapes::icosphere(3));
    place.done("index build models -o all.canonform");
    let before = tree(&place.path("models"));
    let found = place.json("duplicates all.canonform --csv found.csv");
    assert_eq!((&found["n_shapes"], found["groups"].as_array().unwrap().len()), (&6.into(), 1));
    assert_eq!(found["groups"][0]["keeper"]["id"], "original");
    let members = found["groups"][0]["members"].as_array().unwrap();
    let relation = |member: &Value| json!([member["relation"]["kind"], member["relation"]["confidence"]]);
    let relations: Vec<Value> = members.iter().map(relation).collect();
    let kinds = ["identical-file", "identical-geometry", "scaled", "mirrored"];
    assert_eq!(relations, kinds.map(|kind| json!([kind, 1.0])));
    assert_eq!(fs::read_to_string(place.path("found.csv")).unwrap().lines().count(), 6);
    assert!(tree(&place.path("models")) == before);
    assert_eq!(place.run("duplicates all.canonform --kinds noisy").code, 1);
    let text = place.done("duplicates all.canonform").out;
    assert!(text.starts_with("4 of 6 shapes can be spared: 1 group of files of one shape"), "{text}");
    assert!(text.contains("scaled by 25.4 (inches to millimetres)"), "{text}");
}
