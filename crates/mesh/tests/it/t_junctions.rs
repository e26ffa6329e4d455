//! Laws of closing T-junctions.

use std::collections::HashMap;

use canonform_mesh::{
    InputPoint, PointError, RepairOptions, Surface, TriMesh, Weld, cut_shortcuts, repair, shapes, validate,
};
use nalgebra::{Point3, Vector3};
use surface::{FaceId, SurfacePoint, VertexId};

/// The same surface, whose faces are split at so many vertices on each of their edges. Faces of the same number share them.
fn split(mesh: &TriMesh, on_each_edge: impl Fn(usize) -> usize) -> TriMesh {
    let mut positions = mesh.positions.clone();
    let mut known: HashMap<(Vec<(VertexId, usize)>, usize), VertexId> = HashMap::new();
    let mut faces = Vec::new();
    for (f, corners) in mesh.faces.iter().enumerate() {
        let n = on_each_edge(f) + 1;
        let mut vertex = |i: usize, j: usize| {
            let weights = [n - i - j, i, j];
            let mut at: Vec<_> = corners.iter().copied().zip(weights).filter(|(_, w)| *w > 0).collect();
            at.sort_unstable();
            if let [(v, _)] = at[..] {
                return v;
            }
            let sum: Vector3<f64> =
                at.iter().map(|(v, w)| mesh.positions[v.index()].coords * (*w as f64 / n as f64)).sum();
            *known.entry((at, n)).or_insert_with(|| {
                positions.push(Point3::from(sum));
                VertexId::from(positions.len() - 1)
            })
        };
        for i in 0..n {
            for j in 0..n - i {
                faces.push([vertex(i, j), vertex(i + 1, j), vertex(i, j + 1)]);
                if i + j + 2 <= n {
                    faces.push([vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)]);
                }
            }
        }
    }
    TriMesh { positions, faces }
}

/// Open and closed surfaces, flat and curved.
fn surfaces() -> [TriMesh; 4] {
    [
        shapes::grid(6, 5, 0.3),
        shapes::icosphere(2),
        shapes::torus(14, 9, 2.0, 0.7),
        shapes::jittered_grid(8, 8, 1.0, 0.3, 4),
    ]
}

/// The number of edges between faces of which one is in the set and the other is not.
fn n_between(mesh: &TriMesh, is_fine: impl Fn(usize) -> bool) -> usize {
    let mut sides: HashMap<[VertexId; 2], Vec<bool>> = HashMap::new();
    for (f, [a, b, c]) in mesh.faces.iter().enumerate() {
        for [p, q] in [[a, b], [b, c], [c, a]] {
            sides.entry([*p.min(q), *p.max(q)]).or_default().push(is_fine(f));
        }
    }
    sides.values().filter(|both| matches!(both[..], [p, q] if p != q)).count()
}

#[test]
fn t_junctions_of_any_order_are_closed_and_no_vertex_is_added() {
    for mesh in surfaces() {
        let before = validate(&mesh);
        for is_fine in [|f: usize| f.is_multiple_of(3), |f: usize| f % 7 < 4, |f: usize| f > 20] {
            for (fine, coarse) in [(1, 0), (2, 0), (3, 0), (4, 0), (5, 0), (2, 1), (3, 2), (5, 3)] {
                let broken = split(&mesh, |f| if is_fine(f) { fine } else { coarse });
                let repaired = repair(&broken, &RepairOptions::default(), &()).unwrap();
                let after = validate(&repaired.mesh);
                let defects = (after.non_manifold_edges, after.non_manifold_vertices, after.n_components);
                assert_eq!(defects, (0, 0, 1), "{fine} {coarse}");
                assert_eq!((after.n_boundary_loops, after.genus), (before.n_boundary_loops, before.genus));
                assert!((after.area / before.area - 1.0).abs() < 1e-12);
                if coarse == 0 || [fine, coarse] == [2, 1] {
                    assert_eq!(repaired.mesh.positions, broken.positions);
                    assert_eq!(repaired.report.t_junctions, n_between(&mesh, is_fine) * (fine + coarse));
                    assert!(repaired.report.summary().iter().any(|line| line.contains("T-junction")));
                }
            }
        }
    }
}

#[test]
fn coordinates_may_be_rounded_to_single_precision_or_six_digits() {
    let six_digits = |x: f64| format!("{x:.5e}").parse().unwrap();
    for round in [(|x| f64::from(x as f32)) as fn(f64) -> f64, six_digits] {
        for mesh in surfaces() {
            let mut broken = split(&mesh, |f| 3 * (f % 2));
            broken.positions.iter_mut().flat_map(|p| p.iter_mut()).for_each(|x| *x = round(*x));
            let repaired = repair(&broken, &RepairOptions::default(), &()).unwrap();
            assert_eq!(validate(&repaired.mesh).n_boundary_loops, validate(&mesh).n_boundary_loops);
        }
    }
}

#[test]
fn cracks_up_to_the_tolerance_are_closed_between_rows_that_differ() {
    let (width, gap) = (1.0, 1e-4);
    let square = |n: usize, x: f64| {
        let mut mesh = shapes::grid(n + 1, n + 1, width / n as f64);
        mesh.positions.iter_mut().for_each(|p| p.x += x);
        mesh
    };
    for n in [7, 13, 20] {
        let mesh = shapes::disjoint(&[square(10, 0.0), square(n, width + gap)]);
        for tolerance in [2.0 * gap, 20.0 * gap] {
            let options = RepairOptions { weld: Weld::Within(tolerance), ..RepairOptions::default() };
            let found = validate(&repair(&mesh, &options, &()).unwrap().mesh);
            assert_eq!((found.n_components, found.n_boundary_loops), (1, 1), "{n} {tolerance}");
        }
    }
}

#[test]
fn meshes_without_t_junctions_stay_as_they_are() {
    for mesh in surfaces() {
        let repaired = repair(&mesh, &RepairOptions::default(), &()).unwrap();
        assert_eq!((repaired.report.t_junctions, &repaired.mesh), (0, &mesh));
    }
    // A corner that touches an edge, beside a shared vertex or not, and a slit that is open by design.
    let points = [[0.0, 0.0], [2.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.5, -1.0], [1.5, -1.0], [0.0, -1.0]];
    let positions: Vec<Point3<f64>> = points.map(|[x, y]| Point3::new(x, y, 0.0)).to_vec();
    for faces in [vec![[0, 1, 2], [3, 4, 5]], vec![[0, 1, 2], [0, 6, 4], [6, 5, 4], [3, 4, 5]]] {
        let mesh =
            TriMesh { positions: positions.clone(), faces: faces.iter().map(|f| f.map(VertexId)).collect() };
        assert_eq!(repair(&mesh, &RepairOptions::default(), &()).unwrap().report.t_junctions, 0);
    }
    let mut open = split(&shapes::grid(5, 5, 1.0), |f| usize::from(f < 16));
    let junction = (25..open.n_vertices())
        .find(|&v| (open.positions[v] - Point3::new(1.5, 2.0, 0.0)).norm() < 1e-12)
        .unwrap();
    open.positions[junction].y -= 0.05;
    let repaired = repair(&open, &RepairOptions::default(), &()).unwrap();
    assert_eq!((repaired.report.t_junctions, validate(&repaired.mesh).n_boundary_loops), (3, 2));
    let kept = RepairOptions { weld: Weld::None, ..RepairOptions::default() };
    assert_eq!(repair(&open, &kept, &()).unwrap().mesh, open);
}

#[test]
fn the_sides_of_a_crack_are_no_shortcut() {
    for mesh in surfaces() {
        let broken = split(&mesh, |f| usize::from(f > mesh.n_faces() / 2));
        let cut = cut_shortcuts(&broken, &broken.topology(), &()).unwrap();
        assert_eq!((cut.shortcuts.len(), cut.cut.mesh), (0, broken));
    }
}

#[test]
fn points_on_faces_that_were_split_keep_their_positions() {
    for (fine, coarse) in [(1, 0), (4, 0), (2, 1)] {
        let mesh = split(&shapes::icosphere(1), |f| if f.is_multiple_of(3) { fine } else { coarse });
        let surface = Surface::new(&mesh, &RepairOptions::default(), &()).unwrap();
        assert!(!repair(&mesh, &RepairOptions::default(), &()).unwrap().parts.is_empty());
        let at = |v: VertexId| mesh.positions[v.index()].coords;
        let check = |point: InputPoint, expected: Vector3<f64>| {
            let found = surface.locate(&point).unwrap();
            assert!((surface.position(found).coords - expected).norm() < 1e-12, "{point:?}");
            let again = surface.input_point(found).unwrap();
            let found = surface.locate(&again).unwrap();
            assert!((surface.position(found).coords - expected).norm() < 1e-12, "{point:?} {again:?}");
        };
        for (f, [a, b, c]) in mesh.faces.iter().copied().enumerate() {
            for weights in [[1.0, 1.0, 1.0], [0.1, 0.7, 0.2], [0.0, 0.3, 0.7], [8.0, 1.0, 1.0]] {
                let sum: f64 = weights.iter().sum();
                let expected = (at(a) * weights[0] + at(b) * weights[1] + at(c) * weights[2]) / sum;
                check(InputPoint::Face { face: FaceId::from(f), weights }, expected);
            }
            for (p, q) in [(a, b), (c, b), (a, c)] {
                for t in [0.0, 0.2, 0.5, 0.9] {
                    check(InputPoint::Edge { ends: [p, q], t }, at(p) * (1.0 - t) + at(q) * t);
                }
            }
        }
        // Every point of the repaired surface is one of the input.
        let topology = surface.intrinsic().topology();
        for edge in (0..topology.n_edges()).map(surface::EdgeId::from) {
            let point = SurfacePoint::Edge { edge, t: 0.3 };
            let found = surface.locate(&surface.input_point(point).unwrap()).unwrap();
            assert!((surface.position(found) - surface.position(point)).norm() < 1e-12, "{point}");
        }
    }
}

#[test]
fn points_of_a_surface_with_other_faces_are_an_error() {
    let coarse = Surface::new(&shapes::icosphere(1), &Default::default(), &()).unwrap();
    let fine = coarse.for_description(&()).unwrap();
    let face = FaceId::from(fine.mesh().n_faces() - 1);
    let point = SurfacePoint::Face { face, barycentric: [0.2, 0.3, 0.5] };
    assert_eq!(fine.input_point(point), Err(PointError::OtherFaces { point }));
    let vertex = SurfacePoint::Vertex(VertexId(3));
    assert_eq!(fine.input_point(vertex), Ok(InputPoint::Vertex(VertexId(3))));
}
