//! Point clouds as meshes.

use mesh::TriMesh;
use nalgebra::{Point3, Vector3};
use surface::VertexId;

/// A small octahedron around every point: six vertices per point, in the order of the points.
pub fn dots(points: &[Point3<f64>], radius: f64) -> TriMesh {
    const FACES: [[u32; 3]; 8] =
        [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    let corners = [Vector3::x(), -Vector3::x(), Vector3::y(), -Vector3::y(), Vector3::z(), -Vector3::z()];
    let around = |p: &Point3<f64>| corners.map(|corner| p + corner * radius);
    let faces = |dot: usize| FACES.map(|face| face.map(|corner| VertexId::from(6 * dot + corner as usize)));
    TriMesh {
        positions: points.iter().flat_map(around).collect(),
        faces: (0..points.len()).flat_map(faces).collect(),
    }
}
