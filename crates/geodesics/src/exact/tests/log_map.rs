//! Laws of the logarithmic map.

use std::f64::consts::{PI, TAU};

use mesh::shapes;
use surface::{EdgeId, FaceId, IntrinsicMesh, VertexId};

use super::assert_close;
use crate::tests::{cone, distances_from};
use crate::{Exact, Source, SurfacePoint, log_map};

fn vertex(index: usize) -> SurfacePoint {
    SurfacePoint::Vertex(VertexId::from(index))
}

fn about(mesh: &IntrinsicMesh, point: SurfacePoint) -> Vec<[f64; 2]> {
    let source = Source::new(mesh, point).unwrap();
    let distances = distances_from(&Exact::new(mesh, &()), &[source], f64::INFINITY);
    let map = log_map(mesh, point, f64::INFINITY, &()).unwrap();
    for ([x, y], distance) in map.iter().zip(&distances) {
        assert_close(x.hypot(*y), *distance, 1e-12);
    }
    map
}

/// Points of a plane in a frame with this origin and first axis.
fn in_frame(points: &[[f64; 2]], [ox, oy]: [f64; 2], along: [f64; 2]) -> Vec<[f64; 2]> {
    let length = along[0].hypot(along[1]);
    let [cos, sin] = along.map(|x| x / length);
    let turned = |[x, y]: &[f64; 2]| {
        let [x, y] = [x - ox, y - oy];
        [cos * x + sin * y, cos * y - sin * x]
    };
    points.iter().map(turned).collect()
}

fn assert_same(found: &[[f64; 2]], expected: &[[f64; 2]], tolerance: f64) {
    for (i, (a, b)) in found.iter().zip(expected).enumerate() {
        assert!((a[0] - b[0]).hypot(a[1] - b[1]) < tolerance, "vertex {i}: {a:?} instead of {b:?}");
    }
}

#[test]
fn the_map_of_a_flat_sheet_is_the_sheet() {
    let sheet = shapes::jittered_grid(9, 7, 1.0, 0.2, 5);
    let at: Vec<[f64; 2]> = sheet.positions.iter().map(|p| [p.x, p.y]).collect();
    let mut turned = sheet.clone();
    // Faces that are turned over do not unsettle the angles; the first one says what is left.
    for face in turned.faces.iter_mut().skip(1).step_by(3) {
        face.swap(1, 2);
    }
    let mesh = sheet.intrinsic();
    let topology = mesh.topology();
    let mixed = |points: &[VertexId], shares: &[f64]| {
        [0, 1].map(|axis| points.iter().zip(shares).map(|(v, share)| share * at[v.index()][axis]).sum())
    };
    let (ends, corners) = (topology.edges()[60], topology.faces()[40]);
    let inside = [0.5, 0.3, 0.2];
    // Points, where they are, and the ends of a segment along the first axis: from a vertex to the neighbor with the lowest
    // number, which is before an inner vertex, and after the first corner.
    let vertices = [[0, 1], [31, 21], [62, 52]].map(|ends| ends.map(VertexId));
    let vertices = vertices.map(|along| (SurfacePoint::Vertex(along[0]), at[along[0].index()], along));
    let others = [
        (SurfacePoint::Edge { edge: EdgeId(60), t: 0.3 }, mixed(&ends, &[0.7, 0.3]), ends),
        (
            SurfacePoint::Face { face: FaceId(40), barycentric: inside },
            mixed(&corners, &inside),
            [corners[0], corners[1]],
        ),
    ];
    for (point, origin, [from, to]) in vertices.into_iter().chain(others) {
        let along = [0, 1].map(|axis| at[to.index()][axis] - at[from.index()][axis]);
        let expected = in_frame(&at, origin, along);
        assert_same(&about(&mesh, point), &expected, 1e-11);
        if let SurfacePoint::Vertex(_) = point {
            let found = about(&turned.intrinsic(), point);
            let sign = if (found[35][1] - expected[35][1]).abs() > 1e-9 { -1.0 } else { 1.0 };
            let expected: Vec<_> = expected.iter().map(|[x, y]| [*x, sign * y]).collect();
            assert_same(&found, &expected, 1e-11);
        }
    }
}

/// The point at a distance in a direction.
fn at([r, a]: [f64; 2]) -> [f64; 2] {
    [r * a.cos(), r * a.sin()]
}

#[test]
fn the_map_of_a_cone_unrolls_it() {
    for angle in [1.5 * PI, 2.7 * PI] {
        let (mesh, polar) = cone(16, angle, 6, true);
        // About the apex, angles are scaled to a full turn.
        let scaled: Vec<_> = polar.iter().map(|[r, a]| at([*r, a * TAU / angle])).collect();
        assert_same(&about(&mesh, vertex(0)), &scaled, 1e-11);
        // About another vertex, the cone is cut on the far side and lies flat. Paths to where the apex hides the source bend there.
        let source = 1 + 2 * 16;
        let turned = |a: f64| if a > angle / 2.0 { a - angle } else { a };
        let flat = |[r, a]: &[f64; 2]| match turned(*a) {
            a if a.abs() < PI => at([*r, a]),
            _ => at([*r, PI]),
        };
        let flat: Vec<_> = polar.iter().map(flat).collect();
        let lowest = flat[1 + 16];
        let along = [lowest[0] - flat[source][0], lowest[1] - flat[source][1]];
        let (found, expected) = (about(&mesh, vertex(source)), in_frame(&flat, flat[source], along));
        // Two shortest paths lead to the vertices on the cut, unless both bend at the apex.
        let is_single = |i: &usize| angle > TAU || (polar[*i][1] - angle / 2.0).abs() > 1e-9;
        let pick = |map: &[[f64; 2]]| (0..map.len()).filter(is_single).map(|i| map[i]).collect::<Vec<_>>();
        assert_same(&pick(&found), &pick(&expected), 1e-10);
    }
}

#[test]
fn what_is_out_of_reach_has_no_place() {
    let mesh = shapes::disjoint(&[shapes::grid(3, 3, 1.0), shapes::grid(2, 2, 1.0)]).intrinsic();
    let source = SurfacePoint::Vertex(VertexId(0));
    let map = log_map(&mesh, source, f64::INFINITY, &()).unwrap();
    assert!(map[9..].iter().all(|p| p[0].is_nan() && p[1].is_nan()) && map[8][0].is_finite());
    let budget = base::Budget::unlimited();
    budget.cancel();
    assert!(log_map(&mesh, source, f64::INFINITY, &budget).is_err());
    // Along the sides, and not across it.
    let near = log_map(&mesh, source, 1.2, &()).unwrap();
    let is_near = |v: usize| [0, 1, 3].contains(&v);
    assert!((0..mesh.n_vertices()).all(|v| near[v][0].is_finite() == is_near(v)));
    assert!((0..9).filter(|v| is_near(*v)).all(|v| near[v] == map[v]));
}
