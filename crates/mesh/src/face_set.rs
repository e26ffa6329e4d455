//! Faces that are out of range, degenerate or duplicate.

use std::collections::BTreeSet;

use nalgebra::Point3;
use surface::{CornerId, EdgeId, FaceId, Topology, VertexId};

use crate::error::MeshError;
use crate::tri_mesh::TriMesh;

/// Checks what every algorithm relies on.
///
/// # Errors
/// [`MeshError::TooLarge`], [`MeshError::VertexOutOfRange`] and [`MeshError::NonFinite`].
pub fn check_input(mesh: &TriMesh) -> Result<(), MeshError> {
    let (n_vertices, n_faces) = (mesh.n_vertices(), mesh.n_faces());
    if n_vertices > Topology::MAX_VERTICES || n_faces > Topology::MAX_FACES {
        return Err(MeshError::TooLarge { n_vertices, n_faces });
    }
    for (face, corners) in mesh.faces.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|v| v.index() >= n_vertices) {
            return Err(MeshError::VertexOutOfRange { face, vertex, n_vertices });
        }
    }
    check_finite(&mesh.positions)
}

/// Checks coordinates.
///
/// # Errors
/// [`MeshError::NonFinite`].
pub fn check_finite<'a>(positions: impl IntoIterator<Item = &'a Point3<f64>>) -> Result<(), MeshError> {
    match positions.into_iter().position(|p| !p.iter().all(|x| x.is_finite())) {
        Some(vertex) => Err(MeshError::NonFinite(vertex)),
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

/// The connectivity of faces that are not degenerate but for those with the same three vertices as an earlier one, and the
/// number of these.
pub(crate) fn without_duplicates(n_vertices: usize, faces: Vec<[VertexId; 3]>) -> (Topology, usize) {
    let topology = Topology::new(n_vertices, faces);
    let duplicates = duplicates(&topology);
    if duplicates.is_empty() {
        return (topology, 0);
    }
    let faces = topology.into_faces().into_iter().enumerate();
    let kept = faces.filter(|(f, _)| !duplicates.contains(&FaceId::from(*f))).map(|(_, face)| face).collect();
    (Topology::new(n_vertices, kept), duplicates.len())
}

/// The faces with the same three vertices as an earlier one: two corners opposite one edge are at the same vertex.
fn duplicates(topology: &Topology) -> BTreeSet<FaceId> {
    let apex = |corner: &CornerId| topology.corner_vertex(*corner);
    let mut found = BTreeSet::new();
    for corners in (0..topology.n_edges()).map(|edge| topology.edge_corners(EdgeId::from(edge))) {
        match corners {
            [_] => continue,
            [a, b] if apex(a) != apex(b) => continue,
            _ => {}
        }
        let mut faces: Vec<_> = corners.iter().map(|corner| (apex(corner), corner.face())).collect();
        faces.sort_unstable();
        found.extend(faces.windows(2).filter(|pair| pair[0].0 == pair[1].0).map(|pair| pair[1].1));
    }
    found
}
