//! `canonform duplicates`.

use std::collections::BTreeMap;
use std::fs;

use canonform::mesh::{TriMesh, shapes};
use nalgebra::Rotation3;

use crate::support::Workplace;

/// Three rings that bend one way, so that the mirror image is another surface.
fn lopsided() -> TriMesh {
    let mut mesh = shapes::torus(40, 16, 2.0, 0.6);
    for p in &mut mesh.positions {
        p.z += 0.3 * p.x * p.x + 0.2 * p.x * p.y;
        p.x *= 1.0 + 0.2 * p.y;
    }
    mesh
}

fn collection() -> Workplace {
    let place = Workplace::new();
    let mesh = lopsided();
    place.add("models/original.off", &mesh);
    fs::copy(place.path("models/original.off"), place.path("models/copy of original.off")).unwrap();
    let changed = |change: &dyn Fn(&mut nalgebra::Point3<f64>)| {
        let mut mesh = mesh.clone();
        mesh.positions.iter_mut().for_each(change);
        mesh
    };
    let turn = Rotation3::from_euler_angles(0.4, 1.0, -0.3);
    place.add("models/turned and moved.ply", &changed(&|p| *p = turn * *p));
    place.add("models/large.off", &changed(&|p| p.coords *= 25.4));
    place.add("models/mirror image.off", &changed(&|p| p.x = -p.x));
    place.add("models/finer.off", &shapes::subdivide(&mesh));
    place.add("models/ball.off", &shapes::icosphere(3));
    place
}

#[test]
fn files_of_one_shape_are_one_group_and_nothing_is_changed() {
    let place = collection();
    let before = fs::read_dir(place.path("models")).unwrap().count();
    let found = place.json("duplicates models --csv found.csv");
    assert_eq!(found["n_shapes"], 7);
    assert_eq!(found["groups"].as_array().unwrap().len(), 1, "{found}");
    let group = &found["groups"][0];
    assert_eq!(group["keeper"]["id"], "original");
    let members = group["members"].as_array().unwrap();
    let kinds: BTreeMap<&str, &str> = members
        .iter()
        .map(|member| (member["id"].as_str().unwrap(), member["relation"]["kind"].as_str().unwrap()))
        .collect();
    let names = ["copy of original", "finer", "large", "mirror image", "turned and moved"];
    assert!(kinds.keys().eq(&names), "{kinds:?}");
    let is_certain = |member: &serde_json::Value| member["relation"]["confidence"] == 1.0;
    assert!(members.iter().all(|member| is_certain(member) == (member["id"] != "finer")));
    assert_eq!(fs::read_to_string(place.path("found.csv")).unwrap().lines().count(), 7);
    assert_eq!(fs::read_dir(place.path("models")).unwrap().count(), before);
}

#[test]
fn copies_of_files_and_of_geometry_are_certain() {
    let place = collection();
    fs::remove_file(place.path("models/finer.off")).unwrap();
    place.done("index build models -o all.canonform");
    let found = place.json("duplicates all.canonform");
    let members = found["groups"][0]["members"].as_array().unwrap();
    let told: Vec<_> = members
        .iter()
        .map(|member| {
            (member["relation"]["kind"].as_str().unwrap(), member["relation"]["confidence"].as_f64())
        })
        .collect();
    let kinds = ["identical-file", "identical-geometry", "scaled", "mirrored"];
    assert_eq!(told, kinds.map(|kind| (kind, Some(1.0))));
    assert_eq!(place.run("duplicates all.canonform --kinds noisy").code, 1);
    place.refused("duplicates none.canonform", &["none.canonform"]);
    let text = place.done("duplicates all.canonform").out;
    assert!(text.starts_with("4 of 6 shapes can be spared: 1 group of files of one shape"), "{text}");
    assert!(text.contains("scaled by 25.4 (inches to millimetres)"), "{text}");
}
