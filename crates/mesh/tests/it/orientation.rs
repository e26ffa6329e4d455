//! Laws of orientation.

use canonform_mesh::{TriMesh, orient_consistently, oriented_faces, outward, shapes};
use surface::VertexId;

#[test]
fn every_closed_surface_ends_up_facing_outward() {
    let both = shapes::disjoint(&[shapes::icosphere(2), shapes::torus(8, 6, 2.0, 0.5)]);
    for keep_every in [1, 2, 3, 7] {
        let mut mixed = both.clone();
        mixed.faces.iter_mut().step_by(keep_every).for_each(|face| face.swap(0, 1));
        assert_eq!(orient_consistently(&mut mixed), both.n_faces().div_ceil(keep_every));
        assert!((mixed.signed_volume() - both.signed_volume()).abs() < 1e-12);
        assert_eq!(outward(&mixed).unwrap().faces, mixed.faces);
    }
}

#[test]
fn an_open_patch_keeps_the_orientation_of_the_majority() {
    let sheet = shapes::grid(5, 5, 1.0);
    let mut mixed = sheet.clone();
    [0, 3, 17].into_iter().for_each(|f: usize| mixed.faces[f].swap(1, 2));
    assert_eq!((outward(&mixed), oriented_faces(&mixed)), (None, Some(sheet.faces.clone())));
    assert_eq!(orient_consistently(&mut mixed), 3);
    assert_eq!(mixed, sheet);
}

#[test]
fn a_moebius_strip_is_not_orientable() {
    // A loop of three quads, the last glued with a twist.
    let ids = [[0, 1, 2], [1, 3, 2], [2, 3, 4], [3, 5, 4], [4, 5, 1], [5, 0, 1]];
    let faces: Vec<_> = ids.iter().map(|f| f.map(VertexId)).collect();
    let positions = (0..6).map(|i| nalgebra::Point3::new(f64::from(i), f64::from(i * i), 0.0)).collect();
    assert_eq!(oriented_faces(&TriMesh { positions, faces }), None);
    // Fine ones, of which few edges are twisted, and a ring of the same vertices.
    for (n_along, n_across) in [(400, 6), (90, 30)] {
        let sheet = shapes::grid(n_along + 1, n_across, 1.0);
        let glued = |is_twisted: bool| {
            let mut mesh = sheet.clone();
            let rows = |v: VertexId| [v.index() % (n_along + 1), v.index() / (n_along + 1)];
            for v in mesh.faces.iter_mut().flatten() {
                let [x, y] = rows(*v);
                if x == n_along {
                    let y = if is_twisted { n_across - 1 - y } else { y };
                    *v = VertexId::from(y * (n_along + 1));
                }
            }
            mesh
        };
        assert_eq!(oriented_faces(&glued(true)), None, "{n_along} {n_across}");
        assert_eq!(oriented_faces(&glued(false)), Some(glued(false).faces));
    }
}
