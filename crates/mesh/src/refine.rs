//! Refinement of coarse triangles.

use surface::{FaceId, Topology, VertexId};

use crate::tri_mesh::TriMesh;

/// A mesh with new vertices.
#[derive(Debug, Clone, PartialEq)]
pub struct Refined {
    /// The mesh. The old vertices come first, unchanged.
    pub mesh: TriMesh,
    /// For every new vertex, an old vertex near it: at an end of the edge that was split, or on the boundary of the hole that
    /// was closed.
    pub origins: Vec<VertexId>,
}

impl Refined {
    /// What `next` made of this mesh: its origins are then vertices of the first mesh.
    #[must_use]
    pub fn then(self, next: Self) -> Self {
        let n_old = self.mesh.n_vertices() - self.origins.len();
        let new: Vec<VertexId> = next.origins.iter().map(|&v| origin(v, n_old, &self.origins)).collect();
        Self { mesh: next.mesh, origins: [self.origins, new].concat() }
    }
}

/// The old vertex near a vertex: itself if it is old.
fn origin(v: VertexId, n_old: usize, origins: &[VertexId]) -> VertexId {
    v.index().checked_sub(n_old).map_or(v, |i| origins[i])
}

/// Splits edges longer than `longest` at their midpoints, in rounds, until there are none or the next round would give
/// more than `most` vertices. The surface stays the same; any mesh with usable faces will do, including edges of more
/// than two faces.
///
/// A face with one split edge becomes two, with two split edges three, with three split edges four.
///
/// # Panics
/// If a face has a repeated vertex or one that does not exist, see [`Topology::new`].
#[must_use]
pub fn refine(mesh: &TriMesh, longest: f64, most: usize) -> Refined {
    let (n_old, unit) = (mesh.n_vertices(), mesh.unit());
    let mut refined = Refined { mesh: mesh.clone(), origins: Vec::new() };
    loop {
        let TriMesh { positions, faces } = &mut refined.mesh;
        let topology = Topology::new(positions.len(), faces.clone());
        let at = |v: VertexId| positions[v.index()];
        let is_long = |[a, b]: &[VertexId; 2]| ((at(*a) - at(*b)) / unit).norm() * unit > longest;
        let n_long = topology.edges().iter().filter(|edge| is_long(edge)).count();
        if n_long == 0 || positions.len() + n_long > most {
            return refined;
        }
        let mut middle = vec![None; topology.n_edges()];
        let mut new = Vec::with_capacity(n_long);
        for (edge, middle) in topology.edges().iter().zip(&mut middle).filter(|(edge, _)| is_long(edge)) {
            *middle = Some(VertexId::from(positions.len() + new.len()));
            new.push(nalgebra::center(&at(edge[0]), &at(edge[1])));
            refined.origins.push(origin(edge[0], n_old, &refined.origins));
        }
        positions.extend(new);
        let mut finer = Vec::with_capacity(faces.len() + 2 * n_long);
        for (f, face) in faces.iter().enumerate() {
            let middles =
                FaceId::from(f).corners().map(|corner| middle[topology.opposite_edge(corner).index()]);
            split(*face, middles, positions, &mut finer);
        }
        *faces = finer;
    }
}

/// Splits a face at the given midpoints of the edges opposite its corners.
fn split(
    face: [VertexId; 3],
    middles: [Option<VertexId>; 3],
    positions: &[nalgebra::Point3<f64>],
    faces: &mut Vec<[VertexId; 3]>,
) {
    // Turned so that the split edges are opposite the first corners.
    let turn = match middles.map(|middle| middle.is_some()) {
        [false, false, true] | [true, false, true] => 2,
        [false, true, false] | [false, true, true] => 1,
        _ => 0,
    };
    let [a, b, c] = [0, 1, 2].map(|i| face[(i + turn) % 3]);
    match [0, 1, 2].map(|i| middles[(i + turn) % 3]) {
        [Some(bc), Some(ca), Some(ab)] => {
            faces.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        [Some(bc), Some(ca), None] => {
            faces.push([ca, bc, c]);
            let length = |[v, w]: [VertexId; 2]| (positions[v.index()] - positions[w.index()]).norm_squared();
            match length([a, bc]) <= length([b, ca]) {
                true => faces.extend([[a, b, bc], [a, bc, ca]]),
                false => faces.extend([[a, b, ca], [b, bc, ca]]),
            }
        }
        [Some(bc), ..] => faces.extend([[a, b, bc], [a, bc, c]]),
        _ => faces.push(face),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{shapes, validate};

    #[test]
    fn no_edge_is_longer_than_asked_and_the_surface_is_the_same() {
        for mesh in [shapes::tetrahedron(0), shapes::grid(4, 3, 1.0), shapes::torus(17, 6, 2.0, 0.6)] {
            let before = validate(&mesh);
            let longest = 0.17 * before.max_edge_length;
            let Refined { mesh: fine, origins } = refine(&mesh, longest, usize::MAX);
            let after = validate(&fine);
            assert!(after.max_edge_length <= longest && after.n_vertices > 8 * before.n_vertices / 2);
            assert!((after.area / before.area - 1.0).abs() < 1e-12);
            assert_eq!((after.genus, after.n_boundary_loops), (before.genus, before.n_boundary_loops));
            assert_eq!(
                (after.non_manifold_edges, after.inconsistent_edges, after.zero_area_faces),
                (0, 0, 0)
            );
            assert_eq!(fine.positions[..mesh.n_vertices()], mesh.positions);
            assert_eq!(origins.len(), fine.n_vertices() - mesh.n_vertices());
            assert!(origins.iter().all(|v| v.index() < mesh.n_vertices()));
        }
    }

    #[test]
    fn short_edges_stay_and_the_number_of_vertices_is_bounded() {
        let mesh = shapes::icosphere(2);
        assert_eq!(refine(&mesh, 1.0, usize::MAX).mesh, mesh);
        assert_eq!(refine(&mesh, 1e-9, mesh.n_vertices()).mesh, mesh);
        let bounded = refine(&mesh, 1e-9, 5000).mesh;
        assert!((1000..=5000).contains(&bounded.n_vertices()));
    }

    #[test]
    fn edges_of_three_faces_stay_joined() {
        let faces = [[0, 1, 2], [1, 0, 3], [0, 1, 4]].map(|f| f.map(VertexId)).to_vec();
        let at = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 0.2, 0.0], [0.5, -0.2, 0.0], [0.5, 0.0, 0.2]];
        let mesh = TriMesh { positions: at.map(Into::into).to_vec(), faces };
        let found = refine(&mesh, 0.6, usize::MAX).mesh;
        assert_eq!((found.n_vertices(), found.n_faces()), (6, 6));
        assert_eq!(validate(&found).non_manifold_edges, 2);
    }
}
