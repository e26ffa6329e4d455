//! Noise.

use mesh::TriMesh;
use nalgebra::Vector3;

use crate::stream::Stream;

/// Adds noise of the given standard deviation to every coordinate.
pub(super) fn noise(mesh: &TriMesh, deviation: f64, stream: &mut Stream) -> TriMesh {
    // The sum of twelve uniform numbers has variance one and is close to normal; logarithms depend on the platform.
    let mut normal = || (0..12).map(|_| stream.uniform(0.0, 1.0)).sum::<f64>() - 6.0;
    let positions =
        mesh.positions.iter().map(|p| p + Vector3::from([(); 3].map(|()| normal())) * deviation).collect();
    TriMesh { positions, faces: mesh.faces.clone() }
}
