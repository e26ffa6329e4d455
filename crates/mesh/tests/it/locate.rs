//! Laws of points that are named by elements of the input.

use canonform_mesh::{InputPoint, Orient, PointError, RepairOptions, Surface, TriMesh, shapes};
use surface::VertexId;

fn point(text: &str) -> InputPoint {
    text.parse().unwrap()
}

/// A separate face and a degenerate one, then a torus with a crack and every second face reversed.
fn broken() -> TriMesh {
    let mut mesh = shapes::disjoint(&[shapes::grid(2, 2, 0.01), shapes::torus(9, 7, 2.0, 0.5)]);
    mesh.faces[0] = [0, 1, 1].map(VertexId);
    for face in mesh.faces.iter_mut().skip(2).step_by(2) {
        face.swap(1, 2);
    }
    testkit::cracked(&mesh, 10)
}

#[test]
fn points_keep_their_positions_through_every_repair() {
    let mesh = broken();
    let options = RepairOptions { orient: Orient::Consistent, ..RepairOptions::default() };
    let surface = Surface::new(&mesh, &options, &()).unwrap();
    let at = |v: VertexId| mesh.positions[v.index()].coords;
    for (f, [a, b, c]) in mesh.faces.iter().enumerate().skip(2) {
        for (text, expected) in [
            (format!("{b}"), at(*b)),
            (format!("{a}-{b}@0.3"), at(*a) * 0.7 + at(*b) * 0.3),
            (format!("{b}-{a}@0.3"), at(*a) * 0.3 + at(*b) * 0.7),
            (format!("f{f}@1:2:5"), (at(*a) + at(*b) * 2.0 + at(*c) * 5.0) / 8.0),
        ] {
            let found = surface.locate(&point(&text)).unwrap();
            assert!((surface.position(found).coords - expected).norm() < 1e-14, "{text}");
            // Welded twins have one name, so compare positions.
            let again = surface.locate(&surface.input_point(found).unwrap()).unwrap();
            assert!((surface.position(again).coords - expected).norm() < 1e-14, "{text}");
        }
    }
}

#[test]
fn missing_and_dropped_elements_are_different_errors() {
    let mut mesh = broken();
    // Two corners of this face coincide.
    let n = mesh.n_faces();
    let [kept, twin] = [VertexId(10), VertexId::from(mesh.n_vertices() - 1)];
    mesh.faces.push([kept, twin, VertexId(11)]);
    let surface = Surface::new(&mesh, &RepairOptions::default(), &()).unwrap();
    let fault = |text: &str| surface.locate(&point(text)).unwrap_err();
    assert!(matches!(fault("999"), PointError::NoSuchPoint { .. }));
    assert!(matches!(fault("3"), PointError::Dropped { .. }));
    assert!(matches!(fault("f999"), PointError::NoSuchPoint { .. }));
    for dropped in ["f0", "f1", &format!("f{n}")] {
        assert!(matches!(fault(dropped), PointError::Dropped { .. }), "{dropped}");
    }
    assert!(matches!(fault("4-40"), PointError::NoSuchPoint { .. }));
    assert!(matches!(fault(&format!("{kept}-{twin}")), PointError::Dropped { .. }));
}

#[test]
fn points_are_read_as_they_are_written() {
    for text in ["17", "17-42@0.3", "0-1@1", "f8@2:1:1", "f0@0:0.125:7"] {
        assert_eq!(point(text).to_string(), text);
    }
    assert_eq!(point(" 4-7 "), point("4-7@0.5"));
    assert_eq!(point("f9"), point("f9@1:1:1"));
    for text in ["", "x", "1.5", "1-", "-1", "1-2@2", "1-1", "1@0", "f", "f1@1", "f1@1:1:inf", "f1@nan:1:1"] {
        let error = text.parse::<InputPoint>().unwrap_err();
        assert!(error.to_string().contains(&format!("`{text}`")), "{text}");
    }
}
