//! Cuts by a plane.

use mesh::TriMesh;
use nalgebra::Vector3;

use super::cut_off::{first_faces, largest_piece, with_faces};
use crate::stream::Stream;

/// Most directions that are drawn.
const DRAWS: usize = 20;

/// Least share of what is left that is in one piece.
const WHOLE: f64 = 0.97;

/// Cuts a mesh by a plane in a random direction, so that the given share of the area stays, in one piece if a direction for
/// that can be found; else only the largest piece stays.
pub(super) fn slice(mesh: &TriMesh, share: f64, stream: &mut Stream) -> TriMesh {
    let total = mesh.area();
    let mut best = (0.0, mesh.clone());
    for _ in 0..DRAWS {
        let direction: Vector3<f64> = stream.rotation().column(2).into_owned();
        let height = |f: usize| mesh.triangle(f).iter().map(|p| direction.dot(&p.coords)).sum::<f64>() / 3.0;
        let kept = first_faces(mesh, share * total, height);
        let piece = largest_piece(with_faces(mesh, |f| kept[f]));
        let left = piece.area() / total;
        if left > best.0 {
            best = (left, piece);
        }
        if best.0 >= WHOLE * share {
            break;
        }
    }
    best.1
}
