//! `canonform match`.

use std::fs;

use canonform::mesh::{TriMesh, shapes};

use crate::support::{Workplace, assert_keys};

/// Two poses of a cat.
fn cats() -> Workplace {
    let place = Workplace::new();
    place.done("generate --family cat --poses 2 --vertices 1000 -o .");
    place
}

/// The numbers of an array of int64.
fn numbers(place: &Workplace, name: &str) -> Vec<i64> {
    let bytes = fs::read(place.path(name)).unwrap();
    let header = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    assert!(String::from_utf8_lossy(&bytes[..header]).contains("'<i8'"));
    bytes[header..].chunks_exact(8).map(|b| i64::from_le_bytes(b.try_into().unwrap())).collect()
}

#[test]
fn both_maps_of_a_pair_are_written_in_every_format() {
    let place = cats();
    let json = place.json("match cat0.off cat1.off -o map.npy");
    assert_keys(&json, "a b n_vertices maps target seconds");
    assert_keys(&json["seconds"], "load prepare matching total");
    let maps = json["maps"].as_array().unwrap();
    assert_eq!(maps.len(), 2);
    let other = maps[1]["kind"].as_str().unwrap();
    for (map, path) in maps.iter().zip(["map.npy".to_owned(), format!("map-{other}.npy")]) {
        assert_keys(map, "kind distortion agreement confidence alternative matched path alternative_path");
        assert!(map["confidence"].as_f64().unwrap() > 0.9 && map["alternative"].is_null(), "{map}");
        assert_eq!(map["path"], path.as_str());
        assert!(map["distortion"].as_f64().unwrap() < 0.06, "{map}");
        let found = numbers(&place, &path);
        assert!(found.len() == 1000 && found.iter().all(|v| (0..1000).contains(v)));
    }
    let npy = numbers(&place, "map.npy");
    let table = place.done("match cat0.off cat1.off -o map.csv").out;
    assert!(table.contains("distortion") && table.contains(&format!("map-{other}.csv")), "{table}");
    let csv = fs::read_to_string(place.path("map.csv")).unwrap();
    let rows: Vec<&str> = csv.lines().collect();
    assert_eq!((rows[0], rows.len()), ("vertex,match", 1001));
    assert!(rows[1..].iter().zip(&npy).enumerate().all(|(x, (row, y))| *row == format!("{x},{y}")));
    let json = place.json("match cat0.off cat1.off -o map.ply");
    assert_eq!(json["target"], "map-target.ply");
    for (name, mesh) in [("map.ply", "cat0.off"), ("map-target.ply", "cat1.off")] {
        let [colored, plain] = [name, mesh].map(|name| canonform::mesh::io::read(&place.path(name)).unwrap());
        assert_eq!(colored.faces, plain.faces);
    }
    place.done("match cat0.off cat1.off -o map.png");
    assert!(fs::read(place.path("map.png")).unwrap().starts_with(b"\x89PNG"));
    assert!(place.path(&format!("map-{other}.png")).is_file());
}

#[test]
fn dropped_vertices_have_no_partner_and_rows_keep_the_order_of_the_input() {
    let place = cats();
    let cat = canonform::mesh::io::read(&place.path("cat0.off")).unwrap();
    let far = shapes::icosphere(0);
    let crumb = TriMesh {
        positions: far.positions.iter().map(|p| nalgebra::Point3::from(p.coords * 0.01)).collect(),
        faces: far.faces.clone(),
    };
    place.add("crumbs.off", &shapes::disjoint(&[crumb, cat]));
    place.done("match crumbs.off cat0.off -o map.npy");
    let found = numbers(&place, "map.npy");
    let n = far.n_vertices();
    assert!(found[..n].iter().all(|v| *v == -1));
    let right = found[n..].iter().zip(0..).filter(|(y, x)| **y == *x).count();
    assert!(right > 990, "{right} of 1000");
    place.done("match cat0.off crumbs.off -o back.npy");
    assert!(numbers(&place, "back.npy").iter().all(|v| *v >= n as i64), "numbers of the input");
}

#[test]
fn what_cannot_be_written_is_refused_before_any_work() {
    let place = cats();
    let to = |path: &'static str| ["match", "cat0.off", "cat1.off", "-o", path];
    place.refused(&to("map.txt"), &["map.txt", ".npy"]);
    place.refused(&to("nowhere/map.npy"), &["nowhere", "does not exist"]);
    place.refused("match - - --format off", &["only once"]);
    place.refused("match cat0.off none.off", &["none.off"]);
}
