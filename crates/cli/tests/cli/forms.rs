//! Files of forms.

use canonform::mesh::io;

use crate::support::{Workplace, broken_ring, read_npy, ring};

#[test]
fn forms_have_one_row_per_vertex_nan_for_dropped_ones_and_the_faces_of_the_input() {
    let place = Workplace::new();
    place.add("broken.ply", &broken_ring());
    place.add("ring.ply", &ring());
    place.done("embed broken.ply -n 20 -o form.npy");
    let (shape, rows) = read_npy(&place.path("form.npy"));
    assert_eq!(shape, [170, 3]);
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
