//! Points on surfaces, as a scanner sees them.

use mesh::TriMesh;
use nalgebra::{Point3, Vector3};
use surface::FaceId;

use crate::stream::{Purpose, Stream};

/// A point of a surface, and where it was measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScannedPoint {
    /// The face on which it is.
    pub face: FaceId,
    /// Barycentric coordinates in the face.
    pub barycentric: [f64; 3],
    /// Where it was measured, with noise.
    pub position: Point3<f64>,
}

/// Points drawn at random from the surface of a mesh, evenly by area, each displaced by normal noise of the given standard
/// deviation in every coordinate, in mesh units. The same mesh and seed give the same points on any machine.
///
/// ```
/// use canonform_datasets::scan;
/// use mesh::shapes;
///
/// let points = scan(&shapes::icosphere(3), 1000, 0.0, 7);
/// assert_eq!(points.len(), 1000);
/// assert!(points.iter().all(|p| (p.position.coords.norm() - 1.0).abs() < 0.01));
/// ```
///
/// # Panics
/// If the mesh has no area.
pub fn scan(mesh: &TriMesh, n_points: usize, deviation: f64, seed: u64) -> Vec<ScannedPoint> {
    let mut stream = Stream::new(seed, 0, 0, Purpose::Scan);
    let mut covered = 0.0;
    let ends: Vec<f64> = mesh
        .face_areas()
        .map(|area| {
            covered += area;
            covered
        })
        .collect();
    assert!(covered > 0.0, "a mesh with an area");
    (0..n_points)
        .map(|_| {
            let at = stream.uniform(0.0, covered);
            let face = ends.partition_point(|end| *end <= at).min(mesh.n_faces() - 1);
            let [mut s, mut t] = [(); 2].map(|()| stream.uniform(0.0, 1.0));
            if s + t > 1.0 {
                (s, t) = (1.0 - s, 1.0 - t);
            }
            let barycentric = [1.0 - s - t, s, t];
            let [a, b, c] = mesh.triangle(face);
            let noise = Vector3::from([(); 3].map(|()| stream.normal()));
            let position = a + (b - a) * s + (c - a) * t + noise * deviation;
            ScannedPoint { face: FaceId(face as u32), barycentric, position }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use mesh::shapes;

    use super::*;

    #[test]
    fn points_are_spread_by_area_and_as_noisy_as_asked() {
        // Two sheets, one with four times the area of the other.
        let large = shapes::grid(21, 21, 0.1);
        let mut small = shapes::grid(11, 11, 0.1);
        small.positions.iter_mut().for_each(|p| p.z += 5.0);
        let mesh = shapes::disjoint(&[large, small]);
        let points = scan(&mesh, 20_000, 0.05, 3);
        let share = points.iter().filter(|p| p.position.z > 2.5).count() as f64 / 20_000.0;
        assert!((share - 0.2).abs() < 0.01, "{share}");
        let height = |p: &ScannedPoint| p.position.z - if p.position.z > 2.5 { 5.0 } else { 0.0 };
        let deviation = (points.iter().map(|p| height(p).powi(2)).sum::<f64>() / 20_000.0).sqrt();
        assert!((deviation / 0.05 - 1.0).abs() < 0.03, "{deviation}");
        assert!(points.iter().all(|p| (p.barycentric.iter().sum::<f64>() - 1.0).abs() < 1e-12));
        assert_eq!(points, scan(&mesh, 20_000, 0.05, 3));
    }
}
