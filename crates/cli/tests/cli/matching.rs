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
    let json = place.json("match cat0.off cat1.off --eigenfunctions 40 -o map.npy");
    assert_keys(&json, "a b n_vertices maps target source transfer functional seconds");
    assert_keys(&json["seconds"], "load prepare matching total");
    let maps = json["maps"].as_array().unwrap();
    assert_eq!(maps.len(), 2);
    let other = maps[1]["kind"].as_str().unwrap();
    for (map, path) in maps.iter().zip(["map.npy".to_owned(), format!("map-{other}.npy")]) {
        let keys =
            "kind distortion agreement confidence alternative matched doubtful path picture alternative_path";
        assert_keys(map, keys);
        assert!(map["confidence"].as_f64().unwrap() > 0.9 && map["alternative"].is_null(), "{map}");
        assert!(map["doubtful"].as_f64().unwrap() < 0.1, "{map}");
        assert_eq!(map["path"], path.as_str());
        assert!(map["distortion"].as_f64().unwrap() < 0.06, "{map}");
        let found = numbers(&place, &path);
        assert!(found.len() == 1000 && found.iter().all(|v| (0..1000).contains(v)));
    }
    let npy = numbers(&place, "map.npy");
    let table = place.done("match cat0.off cat1.off --eigenfunctions 40 -o map.csv").out;
    assert!(table.contains("distortion") && table.contains(&format!("map-{other}.csv")), "{table}");
    let csv = fs::read_to_string(place.path("map.csv")).unwrap();
    let rows: Vec<&str> = csv.lines().collect();
    assert_eq!((rows[0], rows.len()), ("vertex,match,confidence", 1001));
    assert!(
        rows[1..].iter().zip(&npy).enumerate().all(|(x, (row, y))| row.starts_with(&format!("{x},{y},")))
    );
    let json = place.json("match cat0.off cat1.off --eigenfunctions 40 -o map.ply");
    assert_eq!((&json["target"], &json["source"]), (&"map.ply".into(), &"map-source.ply".into()));
    for (name, mesh) in [("map.ply", "cat1.off"), ("map-source.ply", "cat0.off")] {
        let [colored, plain] = [name, mesh].map(|name| canonform::mesh::io::read(&place.path(name)).unwrap());
        assert_eq!(colored.faces, plain.faces);
    }
    assert_eq!(json["maps"][0]["picture"], "map.png");
    let beside = fs::read(place.path("map.png")).unwrap();
    fs::remove_file(place.path("map.png")).unwrap();
    place.done("match cat0.off cat1.off --eigenfunctions 40 -o map.png");
    assert!(beside.starts_with(b"\x89PNG") && beside == fs::read(place.path("map.png")).unwrap());
    assert!(place.path(&format!("map-{other}.png")).is_file());
}

#[test]
fn landmarks_break_the_symmetry_and_an_initial_map_comes_out() {
    let place = cats();
    place.done("match cat0.off cat1.off --eigenfunctions 40 -o both.npy");
    // Partners of a few vertices under each map: those that are far apart, so that only one of the maps takes them there.
    let maps = ["both.npy", "both-mirrored.npy"].map(|name| numbers(&place, name));
    let other = canonform::mesh::io::read(&place.path("cat1.off")).unwrap();
    let image = |map: usize, v: usize| other.positions[maps[map][v] as usize];
    let apart = |v: &usize| (image(0, *v) - image(1, *v)).norm();
    let far = (0..1000).max_by(|v, w| apart(v).total_cmp(&apart(w))).unwrap();
    for (map, kind) in maps.iter().zip(["direct", "mirrored"]) {
        fs::write(place.path("pairs.csv"), format!("a,b\n{far},{}\n", map[far])).unwrap();
        let json = place.json("match cat0.off cat1.off --eigenfunctions 40 --landmarks pairs.csv -o map.npy");
        let found = json["maps"].as_array().unwrap();
        assert!(found.len() == 1 && found[0]["kind"] == kind, "{json}");
        assert_eq!(numbers(&place, "map.npy")[far], map[far]);
    }
    // The mirrored map, as a start, comes out first.
    for (name, kind) in [("both.npy", "direct"), ("both-mirrored.npy", "mirrored")] {
        let json = place.json(
            format!("match cat0.off cat1.off --eigenfunctions 40 --initial {name} -o again.csv").as_str(),
        );
        assert_eq!(json["maps"][0]["kind"], kind);
        let again = place.json("match cat0.off cat1.off --eigenfunctions 40 --initial again.csv");
        assert_eq!(again["maps"][0]["kind"], kind);
    }
    fs::write(place.path("pairs.csv"), "1,2\n3,4000\n").unwrap();
    place.refused(
        "match cat0.off cat1.off --eigenfunctions 40 --landmarks pairs.csv",
        &["pairs.csv", "line 2", "4000", "counted from 0", "second mesh"],
    );
    fs::write(place.path("pairs.csv"), "3,1\n3,900\n").unwrap();
    place.refused(
        "match cat0.off cat1.off --eigenfunctions 40 --landmarks pairs.csv",
        &["pairs.csv", "3,1 and 3,900", "two partners", "correct or leave out"],
    );
    fs::write(place.path("pairs.csv"), "1,2\n3;x\n").unwrap();
    place.refused(
        "match cat0.off cat1.off --eigenfunctions 40 --landmarks pairs.csv",
        &["pairs.csv", "line 2", "`3;x` is not a number"],
    );
    fs::write(place.path("start.csv"), "1\n2\nx\n").unwrap();
    place.refused(
        "match cat0.off cat1.off --eigenfunctions 40 --initial start.csv",
        &["start.csv", "line 3", "`x`"],
    );
}

#[test]
fn values_labels_and_texture_coordinates_are_carried() {
    let place = cats();
    let cat = canonform::mesh::io::read(&place.path("cat0.off")).unwrap();
    let lines = |line: &dyn Fn(usize) -> String, n: usize| (0..n).map(line).collect::<Vec<_>>().join("\n");
    let read = |name: &str| -> Vec<String> {
        fs::read_to_string(place.path(name)).unwrap().lines().map(str::to_owned).collect()
    };
    let other = canonform::mesh::io::read(&place.path("cat1.off")).unwrap();
    // A constant of the corners stays one.
    fs::write(place.path("ones.csv"), lines(&|_| "2.5".into(), 3 * cat.n_faces())).unwrap();
    let json = place.json("match cat0.off cat1.off --eigenfunctions 40 --transfer ones.csv -o carried.csv");
    assert_keys(&json["transfer"], "path elements kind rows columns");
    let (kind, rows) = (&json["transfer"]["kind"], &json["transfer"]["rows"]);
    assert_eq!((kind, rows), (&"values".into(), &(3 * other.n_faces()).into()));
    let near = |line: &String| (line.parse::<f64>().unwrap() - 2.5).abs() < 1e-9;
    assert!(read("carried.csv").iter().all(near));
    // Coordinates, as functions, arrive where the map takes their vertices.
    place.done("match cat0.off cat1.off --eigenfunctions 40 -o map.npy");
    let map: Vec<usize> = numbers(&place, "map.npy").into_iter().map(|v| v as usize).collect();
    let position = |v: usize| cat.positions[v].coords;
    let coordinates = |v: usize| format!("{},{},{}", position(v).x, position(v).y, position(v).z);
    fs::write(place.path("xyz.csv"), lines(&coordinates, 1000)).unwrap();
    place.done("match cat0.off cat1.off --eigenfunctions 40 --transfer xyz.csv -o carried.csv");
    let carried = read("carried.csv");
    let gap = |v: usize| {
        let found: Vec<f64> = carried[map[v]].split(',').map(|word| word.parse().unwrap()).collect();
        (nalgebra::Vector3::from_column_slice(&found) - position(v)).norm() / cat.area().sqrt()
    };
    let mean = (0..1000).map(gap).sum::<f64>() / 1000.0;
    assert!(mean < 0.03, "{mean}");
    // Labels of vertices, in words, and of faces, as numbers.
    let name = |v: usize| if position(v).z > 40.0 { "upper" } else { "lower" };
    fs::write(place.path("parts.csv"), lines(&|v| name(v).into(), 1000)).unwrap();
    place.done("match cat0.off cat1.off --eigenfunctions 40 --transfer parts.csv -o carried.csv");
    let carried = read("carried.csv");
    let right = (0..1000).filter(|v| name(*v) == carried[map[*v]]).count();
    assert!(right > 950, "{right} of 1000");
    let part = |f: usize| i64::from(name(cat.faces[f][0].index()) == "upper");
    fs::write(place.path("faces.csv"), lines(&|f| part(f).to_string(), cat.n_faces())).unwrap();
    let json = place.json("match cat0.off cat1.off --eigenfunctions 40 --transfer faces.csv -o carried.npy");
    assert_eq!(
        (&json["transfer"]["kind"], &json["transfer"]["elements"]),
        (&"labels".into(), &"faces".into())
    );
    let found = numbers(&place, "carried.npy");
    assert_eq!(found.len(), other.n_faces());
    let same = |f: &usize| i64::from(carried[other.faces[*f][0].index()] == "upper") == found[*f];
    let right = (0..found.len()).filter(same).count();
    assert!(right * 100 > 90 * found.len(), "{right} of {}", found.len());
    place.done("match cat0.off cat1.off --eigenfunctions 40 --transfer parts.csv -o parts.png");
    assert!(fs::read(place.path("parts.png")).unwrap().starts_with(b"\x89PNG"));
    // Words need text, and rows elements.
    place.refused(
        "match cat0.off cat1.off --eigenfunctions 40 --transfer parts.csv -o carried.npy",
        &["carried.npy", "use .csv"],
    );
    fs::write(place.path("few.csv"), "1.5\n2.5\n").unwrap();
    place.refused(
        "match cat0.off cat1.off --eigenfunctions 40 --transfer few.csv -o carried.csv",
        &["few.csv", "2 rows", "1000 vertices", "each face"],
    );
}

#[test]
fn points_and_functional_maps_are_written() {
    let place = cats();
    let json =
        place.json("match cat0.off cat1.off --eigenfunctions 40 --points -o map.csv --functional c.npy");
    let points = json["maps"][0]["points"].as_array().unwrap();
    assert!(points.len() == 1000 && points[0].as_str().unwrap().starts_with('f'));
    let csv = fs::read_to_string(place.path("map.csv")).unwrap();
    assert_eq!(csv.lines().next(), Some("vertex,match,confidence,face,w0,w1,w2"));
    for line in csv.lines().skip(1) {
        let sum: f64 = line.split(',').skip(4).map(|word| word.parse::<f64>().unwrap()).sum();
        assert!((sum - 1.0).abs() < 1e-9, "{line}");
    }
    assert_eq!(json["functional"]["eigenvalues"][0].as_array().unwrap().len(), 40);
    for (name, size) in [("c.npy", 40 * 40), ("c-a.npy", 1000 * 40), ("c-b.npy", 1000 * 40)] {
        assert_eq!(fs::metadata(place.path(name)).unwrap().len(), 128 + 8 * size, "{name}");
    }
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
