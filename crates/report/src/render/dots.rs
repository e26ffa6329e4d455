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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dots_are_outward_oriented_octahedra_around_their_points() {
        let points = [Point3::new(1.0, 2.0, 3.0), Point3::origin()];
        let mesh = dots(&points, 0.5);
        assert_eq!((mesh.n_vertices(), mesh.n_faces()), (12, 16));
        for face in 0..16 {
            let (corners, point) = (mesh.triangle(face), points[face / 8]);
            assert!(corners.iter().all(|p| ((p - point).norm() - 0.5).abs() < 1e-15));
            assert!(mesh.area_vector(face).dot(&(corners[0] - point)) > 0.0, "outward");
        }
    }
}
