//! Faces that are out of range, degenerate or duplicate.

use surface::VertexId;

use crate::error::MeshError;
use crate::tri_mesh::TriMesh;

/// Returns an error if a face refers to a vertex that does not exist or a coordinate is not finite. The
/// meshes that readers return pass.
pub(crate) fn check_input(mesh: &TriMesh) -> Result<(), MeshError> {
    let n_vertices = mesh.n_vertices();
    for (face, corners) in mesh.faces.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|v| v.index() >= n_vertices) {
            return Err(MeshError::FaceOutOfRange { face, vertex, n_vertices });
        }
    }
    match mesh.positions.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
        Some(vertex) => Err(MeshError::NonFinitePosition { vertex: VertexId::from(vertex) }),
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

/// Removes faces with the same vertices as an earlier one; returns how many.
pub(crate) fn remove_duplicates(n_vertices: usize, faces: &mut Vec<[VertexId; 3]>) -> usize {
    let before = faces.len();
    let mut duplicates = duplicates(n_vertices, faces).into_iter();
    faces.retain(|_| !duplicates.next().unwrap_or(false));
    before - faces.len()
}

/// For each face, whether an earlier one has the same three vertices in any order; linear time.
fn duplicates(n_vertices: usize, faces: &[[VertexId; 3]]) -> Vec<bool> {
    // Bucket the faces by their lowest vertex, keeping their order.
    let mut ends = vec![0u32; n_vertices + 1];
    for face in faces {
        ends[sorted(*face)[0].index()] += 1;
    }
    let mut begin = 0;
    for end in &mut ends {
        begin += *end;
        *end = begin - *end;
    }
    let mut buckets = vec![([VertexId(0); 2], 0u32); faces.len()];
    for (f, face) in faces.iter().enumerate() {
        let [lowest, middle, highest] = sorted(*face);
        let slot = &mut ends[lowest.index()];
        buckets[*slot as usize] = ([middle, highest], f as u32);
        *slot += 1;
    }
    let mut duplicate = vec![false; faces.len()];
    let mut begin = 0;
    for &end in &ends[..n_vertices] {
        let bucket = &mut buckets[begin..end as usize];
        begin = end as usize;
        bucket.sort_unstable();
        for pair in bucket.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
            duplicate[pair[1].1 as usize] = true;
        }
    }
    duplicate
}

fn sorted(mut face: [VertexId; 3]) -> [VertexId; 3] {
    face.sort_unstable();
    face
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_of_equal_faces_is_not_a_duplicate() {
        let faces =
            [[0, 1, 2], [2, 1, 3], [1, 2, 0], [0, 1, 3], [2, 1, 0], [3, 1, 2]].map(|f| f.map(VertexId));
        assert_eq!(duplicates(5, &faces), [false, false, true, false, true, true]);
        assert_eq!(duplicates(0, &[]), [false; 0]);
    }
}
