//! `canonform match`.

use std::fs;

use canonform::mesh::{io, shapes};

use crate::support::Workplace;

const MATCH: &str = "match cat0.off cat1.off --eigenfunctions 40";

/// Two poses of a cat.
fn cats() -> Workplace {
    let place = Workplace::new();
    place.done("generate --family cat --poses 2 --vertices 1000 -o .");
    place
}

/// The numbers of an array of int64.
fn numbers(place: &Workplace, name: &str) -> Vec<i64> {
    testkit::array(&place.path(name)).1
}

#[test]
fn both_maps_of_a_pair_are_written_in_every_format() {
    let place = cats();
    let json = place.json(format!("{MATCH} -o map.npy"));
    let maps = json["maps"].as_array().unwrap();
    assert_eq!(maps.len(), 2);
    for (map, path) in maps.iter().zip(["map.npy", "map-mirrored.npy"]) {
        assert!(map["confidence"].as_f64().unwrap() > 0.9 && map["path"] == path, "{map}");
        let found = numbers(&place, path);
        assert!(found.len() == 1000 && found.iter().all(|v| (0..1000).contains(v)));
    }
    // With points of faces instead of vertices, and as functions.
    let json = place.json(format!("{MATCH} --points -o map.csv --functional c.npy"));
    let points = json["maps"][0]["points"].as_array().unwrap();
    assert!(points.len() == 1000 && points[0].as_str().unwrap().starts_with('f'));
    let csv = fs::read_to_string(place.path("map.csv")).unwrap();
    assert!(csv.starts_with("vertex,match,confidence,face,w0,w1,w2\n") && csv.lines().count() == 1001);
    for (x, (line, y)) in csv.lines().skip(1).zip(numbers(&place, "map.npy")).enumerate() {
        let sum: f64 = line.split(',').skip(4).map(|word| word.parse::<f64>().unwrap()).sum();
        assert!(line.starts_with(&format!("{x},{y},")) && (sum - 1.0).abs() < 1e-9, "{line}");
    }
    assert_eq!(json["functional"]["eigenvalues"][0].as_array().unwrap().len(), 40);
    for (name, size) in [("c.npy", 40 * 40), ("c-a.npy", 1000 * 40), ("c-b.npy", 1000 * 40)] {
        assert_eq!(fs::metadata(place.path(name)).unwrap().len(), 128 + 8 * size, "{name}");
    }
    let table = place.done(format!("{MATCH} -o map.ply")).out;
    assert!(table.contains("map-source.ply") && table.contains("map-mirrored.ply"), "{table}");
    let [colored, plain] = ["map.ply", "cat1.off"].map(|name| io::read(&place.path(name)).unwrap());
    assert_eq!(colored.faces, plain.faces);
    assert!(fs::read(place.path("map-mirrored.png")).unwrap().starts_with(b"\x89PNG"));
}

#[test]
fn landmarks_initial_maps_and_tables_to_carry_are_read() {
    let place = cats();
    place.done(format!("{MATCH} -o both.npy"));
    // A partner that only the mirrored map takes a vertex to.
    let maps = ["both.npy", "both-mirrored.npy"].map(|name| numbers(&place, name));
    let other = io::read(&place.path("cat1.off")).unwrap();
    let image = |map: usize, v: usize| other.positions[maps[map][v] as usize];
    let apart = |v: &usize| (image(0, *v) - image(1, *v)).norm();
    let far = (0..1000).max_by(|v, w| apart(v).total_cmp(&apart(w))).unwrap();
    fs::write(place.path("pairs.csv"), format!("a,b\n{far},{}\n", maps[1][far])).unwrap();
    let json = place.json(format!("{MATCH} --landmarks pairs.csv -o map.csv"));
    let found = json["maps"].as_array().unwrap();
    assert!(found.len() == 1 && found[0]["kind"] == "mirrored", "{json}");
    // As a start it comes out first; labels in words go along.
    let labels: Vec<&str> = (0..1000).map(|v| if v % 2 == 0 { "even" } else { "odd" }).collect();
    fs::write(place.path("parts.csv"), labels.join("\n")).unwrap();
    let json = place.json(format!("{MATCH} --initial map.csv --transfer parts.csv -o carried.csv"));
    assert_eq!(json["maps"][0]["kind"], "mirrored");
    assert_eq!((&json["transfer"]["kind"], &json["transfer"]["rows"]), (&"labels".into(), &1000.into()));
    let carried = fs::read_to_string(place.path("carried.csv")).unwrap();
    assert!(carried.lines().count() == 1000 && carried.lines().all(|word| labels.contains(&word)));
}

#[test]
fn dropped_vertices_have_no_partner_and_rows_keep_the_order_of_the_input() {
    let place = cats();
    let cat = io::read(&place.path("cat0.off")).unwrap();
    let mut crumb = shapes::icosphere(0);
    crumb.positions.iter_mut().for_each(|p| p.coords *= 0.01);
    let n = crumb.n_vertices();
    place.add("crumbs.off", &shapes::disjoint(&[crumb, cat]));
    place.done("match crumbs.off cat0.off --eigenfunctions 40 -o map.npy");
    let found = numbers(&place, "map.npy");
    assert!(found[..n].iter().all(|v| *v == -1));
    let right = found[n..].iter().zip(0..).filter(|(y, x)| **y == *x).count();
    assert!(right > 990, "{right} of 1000");
}
