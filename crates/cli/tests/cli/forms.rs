//! The files that come out.

use std::fs;

use canonform::mesh::io;
use serde_json::json;

use crate::support::{Workplace, broken_ring, read_npy, ring};

#[test]
fn forms_have_one_row_per_vertex_nan_for_dropped_ones_and_the_faces_of_the_input() {
    let place = Workplace::new();
    place.add("broken.ply", &broken_ring());
    place.add("ring.ply", &ring());
    let json = place.json("embed broken.ply -n 20 -o form.npy");
    let (shape, rows) = read_npy(&place.path("form.npy"));
    assert_eq!(shape, [170, 3]);
    assert_eq!(json["repair"]["dropped_vertices"], json!((160..170).collect::<Vec<_>>()));
    assert!(rows[..480].iter().all(|x| x.is_finite()) && rows[480..].iter().all(|x| x.is_nan()));
    // Dropped vertices do not change the others.
    place.done("embed ring.ply -n 20 -o whole.npy");
    assert_eq!(read_npy(&place.path("whole.npy")).1, rows[..480]);
    // As many columns as dimensions.
    place.done("embed ring.ply -n 20 --dim 5 -o five.npy");
    assert_eq!(read_npy(&place.path("five.npy")).0, [160, 5]);
    for format in ["ply", "obj", "off"] {
        let [whole, rest] = ["ring", "broken"].map(|mesh| {
            place.done(format!("embed {mesh}.ply -n 20 -o form.{format}"));
            io::read(&place.path(&format!("form.{format}"))).unwrap()
        });
        let coords: Vec<f64> = whole.positions.iter().flat_map(|p| [p.x, p.y, p.z]).collect();
        assert_eq!(coords, rows[..480], "{format}");
        assert_eq!([whole.faces, rest.faces], [ring().faces, ring().faces], "{format}");
    }
}

#[test]
fn a_mesh_bent_into_its_form_keeps_its_faces_and_nearly_its_area() {
    let place = Workplace::new();
    place.add("broken.off", &broken_ring());
    let json = place.json("embed broken.off -n 20 --features -o bent.ply");
    assert_eq!(json["features"], true);
    let bent = io::read(&place.path("bent.ply")).unwrap();
    assert!((bent.area() / ring().area() - 1.0).abs() < 0.1, "{}", bent.area() / ring().area());
}

#[test]
fn distances_have_one_row_per_source_in_both_formats_and_a_colored_mesh_each() {
    let place = Workplace::new();
    place.add("broken.off", &broken_ring());
    place.done("geodesic broken.off --source 4,99,0 -o d.npy");
    let (shape, rows) = read_npy(&place.path("d.npy"));
    assert_eq!(shape, [3, 170]);
    for (row, source) in rows.chunks(170).zip([4, 99, 0]) {
        assert_eq!(row[source], 0.0);
        assert!(row[..160].iter().all(|d| d.is_finite()) && row[160..].iter().all(|d| *d == f64::INFINITY));
    }
    place.done("geodesic broken.off --source 4,99,0 -o d.csv");
    let text = fs::read_to_string(place.path("d.csv")).unwrap();
    let numbers: Vec<f64> =
        text.lines().flat_map(|line| line.split(',')).map(|x| x.parse().unwrap()).collect();
    assert_eq!((text.lines().count(), numbers), (3, rows));
    place.add("ring.off", &ring());
    place.done("geodesic ring.off --source 4 -o one.ply");
    let json = place.json("geodesic ring.off --source 4,9 -o two.ply");
    assert_eq!(json["outputs"], json!(["two-4.ply", "two-9.ply"]));
    for name in ["one.ply", "two-4.ply", "two-9.ply"] {
        assert_eq!(io::read(&place.path(name)).unwrap(), ring(), "{name}");
    }
}
