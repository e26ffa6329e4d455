//! From the polygons of a file to a triangle mesh.

use nalgebra::Point3;
use surface::VertexId;

use super::limits::ReadLimits;
use crate::error::{Fault, Located};
use crate::tri_mesh::TriMesh;

/// Triangulates a polygon whose corners are in range and appends the triangles to `faces`.
///
/// A quadrilateral is split along the diagonal that folds neither half over, else along the shorter one;
/// larger polygons become fans around their first corner.
pub(super) fn push_polygon(
    positions: &[Point3<f64>],
    corners: &[VertexId],
    faces: &mut Vec<[VertexId; 3]>,
    limits: &ReadLimits,
) -> Result<(), Fault> {
    limits.check(0, (faces.len() + corners.len().saturating_sub(2)) as u64)?;
    match *corners {
        [] | [_] | [_, _] => return Err(Fault::TooFewCorners { corners: corners.len() }),
        [a, b, c] => faces.push([a, b, c]),
        [a, b, c, d] if prefers_second_diagonal(positions, [a, b, c, d]) => {
            faces.extend([[a, b, d], [b, c, d]]);
        }
        [apex, ..] => faces.extend(corners[1..].windows(2).map(|edge| [apex, edge[0], edge[1]])),
    }
    Ok(())
}

/// Whether the quadrilateral a b c d is better split from b to d than from a to c.
fn prefers_second_diagonal(positions: &[Point3<f64>], quad: [VertexId; 4]) -> bool {
    let [a, b, c, d] = quad.map(|v| positions[v.index()]);
    let folds_over = |p: Point3<f64>, q: Point3<f64>, r: Point3<f64>, s: Point3<f64>| {
        let (first, second) = ((q - p).cross(&(r - p)), (r - p).cross(&(s - p)));
        first.dot(&second) <= 0.0
    };
    match (folds_over(a, b, c, d), folds_over(b, c, d, a)) {
        (true, false) => true,
        (false, true) => false,
        _ => (d - b).norm_squared() < (c - a).norm_squared(),
    }
}

/// The mesh, if it has a face and is within the limits.
pub(super) fn finish(
    positions: Vec<Point3<f64>>,
    faces: Vec<[VertexId; 3]>,
    limits: &ReadLimits,
) -> Result<TriMesh, Located> {
    if faces.is_empty() {
        return Err(Fault::NoFaces { n_vertices: positions.len() }.whole());
    }
    limits.check(positions.len() as u64, faces.len() as u64).map_err(Fault::whole)?;
    Ok(TriMesh { positions, faces })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn split(points: &[[f64; 2]]) -> Vec<[u32; 3]> {
        let positions: Vec<_> = points.iter().map(|p| Point3::new(p[0], p[1], 0.0)).collect();
        let corners: Vec<_> = (0..points.len()).map(VertexId::from).collect();
        let mut faces = Vec::new();
        push_polygon(&positions, &corners, &mut faces, &ReadLimits::default()).unwrap();
        faces.iter().map(|f| f.map(|v| v.0)).collect()
    }

    #[test]
    fn quads_are_split_along_the_inner_or_the_shorter_diagonal() {
        assert_eq!(split(&[[0., 0.], [1., 0.], [1., 1.], [0., 1.]]), [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(split(&[[0., 0.], [1., 0.], [4., 1.], [0., 1.]]), [[0, 1, 3], [1, 2, 3]]);
        // An arrow head with its notch at corner 1: only the diagonal from the notch stays inside.
        assert_eq!(split(&[[0., 0.], [1., 1.], [2., 0.], [1., 3.]]), [[0, 1, 3], [1, 2, 3]]);
        assert_eq!(split(&[[1., 1.], [2., 0.], [1., 3.], [0., 0.]]), [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn larger_polygons_become_fans_and_smaller_ones_are_errors() {
        let hexagon: Vec<[f64; 2]> = (0..6).map(|i| (f64::from(i)).sin_cos().into()).collect();
        assert_eq!(split(&hexagon), [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]]);
        let refused = push_polygon(&[], &[VertexId(0); 2], &mut Vec::new(), &ReadLimits::default());
        assert_eq!(refused, Err(Fault::TooFewCorners { corners: 2 }));
    }

    #[test]
    fn a_polygon_beyond_the_limit_is_not_split() {
        let limits = ReadLimits { max_faces: 3, ..ReadLimits::default() };
        let mut faces = Vec::new();
        let refused = push_polygon(&[], &[VertexId(0); 6], &mut faces, &limits);
        assert_eq!(refused, Err(Fault::OverLimit { items: "faces", limit: 3 }));
        assert!(faces.is_empty());
    }
}
