//! Midpoint subdivision.

use surface::{FaceId, Topology, VertexId};

use crate::tri_mesh::TriMesh;

/// Splits every face into four at the midpoints of its edges, without changing the surface.
///
/// The old vertices come first, unchanged, then one per edge in the order of [`Topology::edges`]. Face `f`
/// becomes the faces `4 f .. 4 f + 4`, the one in the middle last.
///
/// # Panics
/// If a face has a repeated vertex or one that does not exist, see [`Topology::new`].
#[must_use]
pub fn subdivide(mesh: &TriMesh) -> TriMesh {
    let n_old = mesh.n_vertices();
    let topology = Topology::new(n_old, mesh.faces.clone());
    let midpoint =
        |[a, b]: [VertexId; 2]| nalgebra::center(&mesh.positions[a.index()], &mesh.positions[b.index()]);
    let mut positions = mesh.positions.clone();
    positions.extend(topology.edges().iter().map(|&edge| midpoint(edge)));
    let faces = mesh.faces.iter().enumerate().flat_map(|(f, &[a, b, c])| {
        let [bc, ca, ab] = FaceId::from(f)
            .corners()
            .map(|corner| VertexId::from(n_old + topology.opposite_edge(corner).index()));
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    });
    TriMesh { faces: faces.collect(), positions }
}

#[cfg(test)]
mod tests {
    use crate::{shapes, validate};

    #[test]
    fn subdivision_keeps_area_orientation_and_vertices_and_halves_edges() {
        let coarse = shapes::torus(7, 5, 2.0, 0.6);
        let fine = super::subdivide(&coarse);
        let (before, after) = (validate(&coarse), validate(&fine));
        assert_eq!(fine.n_faces(), 4 * coarse.n_faces());
        assert_eq!(fine.n_vertices(), coarse.n_vertices() + before.n_edges);
        assert_eq!(fine.positions[..coarse.n_vertices()], coarse.positions);
        assert!((after.area - before.area).abs() < 1e-12 * before.area);
        assert_eq!((after.genus, after.inconsistent_edges), (Some(1), 0));
        let longest =
            |m: &crate::TriMesh| m.intrinsic().edge_lengths().iter().fold(0.0, |a, b| f64::max(a, *b));
        assert!((longest(&fine) - 0.5 * longest(&coarse)).abs() < 1e-12);
    }
}
