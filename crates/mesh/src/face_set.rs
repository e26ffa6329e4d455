//! Faces that are out of range, degenerate or duplicate.

use nalgebra::Point3;
use surface::{CornerId, EdgeId, Topology, VertexId};

use crate::error::MeshError;
use crate::tri_mesh::TriMesh;

/// Checks what every algorithm relies on.
///
/// # Errors
/// [`MeshError::TooLarge`], [`MeshError::VertexOutOfRange`] and [`MeshError::NonFinite`].
pub fn check_input(mesh: &TriMesh) -> Result<(), MeshError> {
    let n_vertices = mesh.n_vertices();
    check_counts(n_vertices, mesh.n_faces())?;
    for (face, corners) in mesh.faces.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|v| v.index() >= n_vertices) {
            return Err(MeshError::VertexOutOfRange { face, vertex, n_vertices });
        }
    }
    check_finite(&mesh.positions)
}

/// Returns an error if there are more vertices or faces than a mesh may have.
fn check_counts(n_vertices: usize, n_faces: usize) -> Result<(), MeshError> {
    match n_vertices > Topology::MAX_VERTICES || n_faces > Topology::MAX_FACES {
        true => Err(MeshError::TooLarge { n_vertices, n_faces }),
        false => Ok(()),
    }
}

/// Checks coordinates.
///
/// # Errors
/// [`MeshError::NonFinite`].
pub fn check_finite<'a>(positions: impl IntoIterator<Item = &'a Point3<f64>>) -> Result<(), MeshError> {
    match positions.into_iter().position(|p| !p.iter().all(|x| x.is_finite())) {
        Some(vertex) => Err(MeshError::NonFinite { vertex }),
        None => Ok(()),
    }
}

/// Whether a face has a repeated vertex.
pub(crate) fn is_degenerate([a, b, c]: [VertexId; 3]) -> bool {
    a == b || b == c || c == a
}

/// Removes degenerate faces; returns how many.
pub(crate) fn remove_degenerate(faces: &mut Vec<[VertexId; 3]>) -> usize {
    let before = faces.len();
    faces.retain(|&face| !is_degenerate(face));
    before - faces.len()
}

/// Whether two faces have the same three vertices: two corners opposite one edge are at the same vertex.
pub(crate) fn has_duplicates(topology: &Topology) -> bool {
    let apex = |corner: &CornerId| topology.corner_vertex(*corner);
    (0..topology.n_edges()).any(|edge| match topology.edge_corners(EdgeId::from(edge)) {
        [_] => false,
        [a, b] => apex(a) == apex(b),
        corners => {
            let mut apices: Vec<VertexId> = corners.iter().map(apex).collect();
            apices.sort_unstable();
            apices.windows(2).any(|pair| pair[0] == pair[1])
        }
    })
}

/// Removes faces with the same vertices as an earlier one; returns how many.
pub(crate) fn remove_duplicates(faces: &mut Vec<[VertexId; 3]>) -> usize {
    let before = faces.len();
    let mut duplicates = duplicates(faces).into_iter();
    faces.retain(|_| !duplicates.next().unwrap_or(false));
    before - faces.len()
}

/// For each face, whether an earlier one has the same three vertices in any order.
fn duplicates(faces: &[[VertexId; 3]]) -> Vec<bool> {
    let mut faces: Vec<_> = faces.iter().enumerate().map(|(f, face)| (VertexId::sorted(*face), f)).collect();
    faces.sort_unstable();
    let mut duplicate = vec![false; faces.len()];
    for pair in faces.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
        duplicate[pair[1].1] = true;
    }
    duplicate
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meshes_are_limited_to_numbers_that_leave_two_bits_for_flags() {
        assert!(check_counts(Topology::MAX_VERTICES, Topology::MAX_FACES).is_ok());
        for [n_vertices, n_faces] in [[1 << 30, 1], [3, (1 << 30) / 3 + 1], [usize::MAX; 2]] {
            let error = check_counts(n_vertices, n_faces).unwrap_err();
            assert!(matches!(error, MeshError::TooLarge { .. }), "{error}");
        }
    }
}
