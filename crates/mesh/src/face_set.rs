//! What may be wrong with the faces of a mesh: vertices out of range, named twice, faces repeated.

use crate::{MeshError, TriMesh};
use surface::VertexId;

/// Refuses a mesh whose faces name vertices that do not exist, or with coordinates that are not
/// finite; what readers return passes.
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

/// Whether a face names a vertex twice.
pub(crate) fn names_twice([a, b, c]: [VertexId; 3]) -> bool {
    a == b || b == c || c == a
}

/// For every face whether an earlier one has the same three vertices, in any order; linear time.
///
/// No face names a vertex twice.
pub(crate) fn repeats(n_vertices: usize, faces: &[[VertexId; 3]]) -> Vec<bool> {
    // Faces in the buckets of their lowest vertices; within one, in their order.
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
    let mut repeated = vec![false; faces.len()];
    let mut begin = 0;
    for &end in &ends[..n_vertices] {
        let bucket = &mut buckets[begin..end as usize];
        begin = end as usize;
        bucket.sort_unstable();
        for pair in bucket.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
            repeated[pair[1].1 as usize] = true;
        }
    }
    repeated
}

fn sorted(mut face: [VertexId; 3]) -> [VertexId; 3] {
    face.sort_unstable();
    face
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_of_equal_faces_is_no_repeat() {
        let faces =
            [[0, 1, 2], [2, 1, 3], [1, 2, 0], [0, 1, 3], [2, 1, 0], [3, 1, 2]].map(|f| f.map(VertexId));
        assert_eq!(repeats(5, &faces), [false, false, true, false, true, true]);
        assert_eq!(repeats(0, &[]), [false; 0]);
    }
}
