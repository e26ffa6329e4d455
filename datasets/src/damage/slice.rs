//! Cuts by a plane.

use mesh::TriMesh;
use nalgebra::Vector3;

use super::cut_off::largest_piece;
use crate::stream::Stream;

/// Most directions that are drawn.
const DRAWS: usize = 20;

/// Least share of what is left that is in one piece.
const WHOLE: f64 = 0.97;

/// Cuts a mesh by a plane in a random direction, so that the given share of the area stays, in one piece if a direction for
/// that can be found; else only the largest piece stays.
pub(super) fn slice(mesh: &TriMesh, share: f64, stream: &mut Stream) -> TriMesh {
    let (total, areas): (f64, Vec<f64>) = (mesh.area(), mesh.face_areas().collect());
    let mut best = (0.0, mesh.clone());
    for _ in 0..DRAWS {
        let direction: Vector3<f64> = stream.rotation().column(2).into_owned();
        let height =
            |f: &usize| mesh.triangle(*f).iter().map(|p| direction.dot(&p.coords)).sum::<f64>() / 3.0;
        let mut order: Vec<usize> = (0..mesh.n_faces()).collect();
        order.sort_by(|a, b| height(a).total_cmp(&height(b)));
        let mut covered = 0.0;
        let mut kept = vec![false; mesh.n_faces()];
        for f in order {
            if covered >= share * total {
                break;
            }
            covered += areas[f];
            kept[f] = true;
        }
        let faces = (0..mesh.n_faces()).filter(|f| kept[*f]).map(|f| mesh.faces[f]).collect();
        let piece = largest_piece(TriMesh { positions: mesh.positions.clone(), faces });
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
