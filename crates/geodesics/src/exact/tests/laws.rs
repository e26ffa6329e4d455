//! What holds on every surface.

use mesh::shapes;
use surface::{FaceId, IntrinsicMesh, Topology, VertexId};

use super::super::Exact;
use super::{all_pairs, assert_close, bumpy};
use crate::{Dijkstra, DistanceSolver, Source, SurfacePoint};

#[test]
fn distances_are_a_metric_below_that_of_the_edges() {
    let mesh = bumpy(9, 0.9, 3);
    let dijkstra = Dijkstra::new(&mesh);
    let found = all_pairs(&mesh);
    for (v, row) in found.iter().enumerate() {
        assert_eq!(row[v], 0.0);
        let along_edges = dijkstra.distances(VertexId::from(v));
        for (w, d) in row.iter().enumerate() {
            assert_close(*d, found[w][v], 1e-12);
            assert!(*d <= along_edges[w] * (1.0 + 1e-14));
        }
        for (ends, length) in mesh.topology().edges().iter().zip(mesh.edge_lengths()) {
            let [a, b] = ends.map(|v| row[v.index()]);
            assert!((a - b).abs() <= length * (1.0 + 1e-12));
        }
        for (w, d) in row.iter().enumerate() {
            for (x, further) in found[w].iter().enumerate() {
                assert!(row[x] <= (d + further) * (1.0 + 1e-13), "{v} {w} {x}");
            }
        }
    }
}

#[test]
fn neither_orientation_nor_the_order_of_corners_and_faces_matters() {
    let mesh = bumpy(12, 1.3, 7);
    let turned = mesh.topology().faces().iter().enumerate().map(|(f, [a, b, c])| match f % 6 {
        0 => [*a, *b, *c],
        1 => [*b, *a, *c],
        2 => [*b, *c, *a],
        3 => [*c, *b, *a],
        4 => [*c, *a, *b],
        _ => [*a, *c, *b],
    });
    let topology = Topology::new(mesh.n_vertices(), turned.rev().collect());
    assert_eq!(topology.edges(), mesh.topology().edges());
    let other = IntrinsicMesh::new(topology, mesh.edge_lengths().to_vec());
    for source in [0, 40, 77].map(VertexId) {
        let (one, other) = (Exact::new(&mesh).distances(source), Exact::new(&other).distances(source));
        for (found, expected) in other.iter().zip(&one) {
            assert_close(*found, *expected, 1e-13);
        }
    }
}

#[test]
fn scaling_scales() {
    let mesh = bumpy(8, 1.0, 11);
    let plain = Exact::new(&mesh).distances(VertexId(9));
    for scale in [2f64.powi(40), 2f64.powi(-300), 1e-30, 3e120] {
        let lengths = mesh.edge_lengths().iter().map(|l| l * scale).collect();
        let scaled = IntrinsicMesh::new(mesh.topology().clone(), lengths);
        for (found, plain) in Exact::new(&scaled).distances(VertexId(9)).iter().zip(&plain) {
            assert_close(*found, plain * scale, 1e-12);
        }
    }
}

#[test]
fn the_nearest_of_several_sources_counts() {
    let mesh = bumpy(12, 0.8, 2);
    let solver = Exact::new(&mesh);
    let point = SurfacePoint::Face { face: FaceId(77), barycentric: [0.3, 0.1, 0.6] };
    let edge = SurfacePoint::Edge { edge: surface::EdgeId(200), t: 0.3 };
    let sources = [
        Source::vertex(VertexId(3)),
        Source::new(&mesh, point).unwrap(),
        Source::vertex(VertexId(130)),
        Source::new(&mesh, edge).unwrap(),
    ];
    let solve = |sources: &[Source]| {
        let mut out = vec![0.0; mesh.n_vertices()];
        solver.solve_into(sources, f64::INFINITY, &mut out);
        out
    };
    let alone: Vec<Vec<f64>> = sources.iter().map(|s| solve(std::slice::from_ref(s))).collect();
    for (v, found) in solve(&sources).iter().enumerate() {
        let nearest = alone.iter().map(|row| row[v]).fold(f64::INFINITY, f64::min);
        assert_close(*found, nearest, 1e-12);
    }
    assert!(solve(&[]).iter().all(|d| d.is_infinite()));
}

#[test]
fn a_limit_hides_what_is_beyond_and_changes_nothing_else() {
    for mesh in [bumpy(15, 1.0, 4), shapes::sheared_grid(12, 9, 1.0, 6.0).intrinsic()] {
        let solver = Exact::new(&mesh);
        let full = solver.distances(VertexId(50));
        let mut out = vec![0.0; full.len()];
        for limit in [0.0, 0.7, 2.0, 5.5, 1e3, full[20]] {
            solver.solve_into(&[Source::vertex(VertexId(50))], limit, &mut out);
            for (found, full) in out.iter().zip(&full) {
                assert_eq!(*found, if *full <= limit { *full } else { f64::INFINITY });
            }
        }
        // What an aborted run left behind does no harm.
        assert_eq!(solver.distances(VertexId(50)), full);
    }
}

#[test]
fn refining_a_surface_does_not_change_it() {
    let sphere = shapes::icosphere(1);
    let coarse = all_pairs(&sphere.intrinsic());
    let fine = shapes::subdivide(&shapes::subdivide(&sphere));
    let solver = Exact::new(&fine.intrinsic());
    for (v, row) in coarse.iter().enumerate() {
        let refined = solver.distances(VertexId::from(v));
        for (found, expected) in refined.iter().zip(row) {
            assert_close(*found, *expected, 1e-12);
        }
    }
}

#[test]
fn threads_do_not_matter() {
    let mesh = bumpy(20, 1.1, 9);
    let solver = Exact::new(&mesh);
    let sources: Vec<VertexId> = (0..24).map(|i| VertexId(i * 16)).collect();
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let one = pool(1).install(|| solver.distance_columns(&sources));
    let four = pool(4).install(|| solver.distance_columns(&sources));
    assert_eq!(one.as_slice(), four.as_slice());
}
