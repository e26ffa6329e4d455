//! Noise.

use mesh::TriMesh;
use nalgebra::Vector3;

use crate::stream::Stream;

/// Adds noise of the given standard deviation to every coordinate.
pub(super) fn noise(mesh: &TriMesh, deviation: f64, stream: &mut Stream) -> TriMesh {
    mesh.moved(|p| p + Vector3::from([(); 3].map(|()| stream.normal())) * deviation)
}

/// Displacement of shot noise, relative to the diagonal of the bounding box.
const SHOT: f64 = 0.04;

/// Displaces the given share of the vertices, and at least one, in random directions.
pub(super) fn shot_noise(mesh: &TriMesh, share: f64, diagonal: f64, stream: &mut Stream) -> TriMesh {
    let mut shot = mesh.clone();
    let order = stream.permutation(mesh.n_vertices());
    let n = (share * mesh.n_vertices() as f64).ceil() as usize;
    for v in order.into_iter().take(n) {
        let direction = stream.rotation().column(2).into_owned();
        shot.positions[v as usize] += direction * (SHOT * diagonal);
    }
    shot
}
