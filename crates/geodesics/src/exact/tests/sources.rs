//! Points on edges and in faces, several sources, and limits, on surfaces of any kind.

use proptest::prelude::*;
use surface::{EdgeId, FaceId, IntrinsicMesh, Topology, VertexId};

use super::super::Exact;
use super::random::{soup, star};
use super::{assert_close, bumpy};
use crate::{DistanceSolver, Source, SurfacePoint};

fn solve(mesh: &IntrinsicMesh, sources: &[Source], max_distance: f64) -> Vec<f64> {
    let mut out = vec![0.0; mesh.n_vertices()];
    Exact::new(mesh, &()).solve_into(sources, max_distance, &mut out).unwrap();
    out
}

/// The surface with a vertex at a source: every face of which it is a point is split there.
fn with_vertex(mesh: &IntrinsicMesh, source: &Source) -> IntrinsicMesh {
    let (n, topology) = (mesh.n_vertices(), mesh.topology());
    let new = VertexId::from(n);
    let mut faces = topology.faces().to_vec();
    match source.point() {
        SurfacePoint::Vertex(_) => {}
        SurfacePoint::Edge { edge, .. } => {
            let [a, b] = topology.edges()[edge.index()];
            for corner in topology.edge_corners(edge) {
                let face = topology.faces()[corner.face().index()];
                faces[corner.face().index()] = face.map(|v| if v == a { new } else { v });
                faces.push(face.map(|v| if v == b { new } else { v }));
            }
        }
        SurfacePoint::Face { face, .. } => {
            let [a, b, c] = faces[face.index()];
            faces[face.index()] = [a, b, new];
            faces.extend([[b, c, new], [c, a, new]]);
        }
    }
    let topology = Topology::new(n + 1, faces);
    let length = |[p, q]: &[VertexId; 2]| match mesh.topology().edge_between(*p, *q) {
        Some(edge) => mesh.length(edge),
        None => source.reach().iter().find(|(v, _)| v == p).unwrap().1,
    };
    let lengths = topology.edges().iter().map(length).collect();
    IntrinsicMesh::new(topology, lengths)
}

fn assert_like_a_vertex(mesh: &IntrinsicMesh, point: SurfacePoint) {
    let source = Source::new(mesh, point).unwrap();
    let split = with_vertex(mesh, &source);
    let expected = Exact::new(&split, &()).distances(VertexId::from(mesh.n_vertices())).unwrap();
    for (found, expected) in solve(mesh, &[source], f64::INFINITY).iter().zip(&expected) {
        assert_close(*found, *expected, 1e-9);
    }
}

proptest! {
    #[test]
    fn a_point_of_a_face_is_like_a_vertex_put_there(
        mesh in soup(6, 8), face in 0..8usize, s in 0.05..0.95f64, t in 0.05..0.95f64,
    ) {
        let face = FaceId::from(face % mesh.topology().n_faces());
        let barycentric = [s, (1.0 - s) * t, (1.0 - s) * (1.0 - t)];
        assert_like_a_vertex(&mesh, SurfacePoint::Face { face, barycentric });
    }

    #[test]
    fn a_point_of_an_edge_is_like_a_vertex_put_there(
        mesh in prop_oneof![soup(6, 8), star(6)], edge in 0..99usize, t in 0.05..0.95f64,
    ) {
        let edge = EdgeId::from(edge % mesh.topology().n_edges());
        assert_like_a_vertex(&mesh, SurfacePoint::Edge { edge, t });
    }

    #[test]
    fn the_nearest_source_counts_up_to_the_limit(
        mesh in prop_oneof![soup(9, 14), any::<u32>().prop_map(|seed| bumpy(6, 1.0, seed.into()))],
        [v, e, f] in prop::array::uniform3(0..99usize), limit in 0.0..4.0f64,
    ) {
        let sources = [
            SurfacePoint::Vertex(VertexId::from(v % mesh.n_vertices())),
            SurfacePoint::Edge { edge: EdgeId::from(e % mesh.topology().n_edges()), t: 0.3 },
            SurfacePoint::Face {
                face: FaceId::from(f % mesh.topology().n_faces()),
                barycentric: [0.2, 0.7, 0.1],
            },
        ];
        let sources = sources.map(|point| Source::new(&mesh, point).unwrap());
        let single = sources.each_ref().map(|s| solve(&mesh, std::slice::from_ref(s), f64::INFINITY));
        let near = solve(&mesh, &sources, limit);
        for (v, found) in solve(&mesh, &sources, f64::INFINITY).into_iter().enumerate() {
            assert_close(found, single.iter().map(|row| row[v]).fold(f64::INFINITY, f64::min), 1e-9);
            if (found - limit).abs() > 1e-9 {
                assert_close(near[v], if found <= limit { found } else { f64::INFINITY }, 1e-9);
            }
        }
    }
}
