//! From the polygons of a file to a triangle mesh.

use nalgebra::{Matrix4, Point3};
use surface::VertexId;

use super::facts::MeshFile;
use super::limits::ReadLimits;
use crate::error::{FEWEST_POINTS, Fault, Located};
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

/// A position whose coordinates are numbers; `vertex` only appears in messages.
pub(super) fn finite(position: impl Into<Point3<f64>>, vertex: usize) -> Result<Point3<f64>, Fault> {
    let position = position.into();
    match position.iter().find(|x| !x.is_finite()) {
        Some(&value) => Err(Fault::NonFinite { vertex: vertex as u64, value }),
        None => Ok(position),
    }
}

/// The place of a copy of a mesh, as an affine map; `None` if it stays where it is.
pub(super) type Placement = Option<Matrix4<f64>>;

/// The place that a map moves a mesh to.
pub(super) fn placed_by(map: Matrix4<f64>) -> Placement {
    (map != Matrix4::identity()).then_some(map)
}

/// The place of what has a place within something that is placed itself.
pub(super) fn placed_within(above: Placement, own: Placement) -> Placement {
    match (above, own) {
        (Some(above), Some(own)) => Some(above * own),
        (above, own) => above.or(own),
    }
}

/// Appends a copy of a mesh. Where its place mirrors it, corners change their order.
pub(super) fn append_placed(whole: &mut TriMesh, part: &TriMesh, place: Placement) -> Result<(), Fault> {
    let start = whole.n_vertices() as u32;
    let mut mirrors = false;
    if let Some(place) = place {
        let (linear, shift) =
            (place.fixed_view::<3, 3>(0, 0).into_owned(), place.fixed_view::<3, 1>(0, 3).into_owned());
        mirrors = linear.determinant() < 0.0;
        for (vertex, p) in part.positions.iter().enumerate() {
            whole.positions.push(finite(linear * p.coords + shift, vertex)?);
        }
    } else {
        whole.positions.extend_from_slice(&part.positions);
    }
    whole.faces.extend(part.faces.iter().map(|&[a, b, c]| {
        let face = if mirrors { [a, c, b] } else { [a, b, c] };
        face.map(|v| VertexId(v.0 + start))
    }));
    Ok(())
}

/// Vertices and faces that copies of meshes may always add up to.
const COPIES: u64 = 1 << 22;
/// Beyond, they may be this many times the bytes of the file.
const COPIES_RATIO: u64 = 64;

/// Refuses a small file in which copies of meshes add up to a huge one.
pub(super) fn check_copies(items: u64, n_bytes: u64) -> Result<(), Fault> {
    match COPIES.max(n_bytes.saturating_mul(COPIES_RATIO)) {
        limit if items > limit => Err(Fault::unsupported(
            format!(
                "its copies of meshes add up to more than {limit} vertices and faces, out of proportion to the file"
            ),
            "the file is damaged or malicious: if it is neither, export a single copy",
        )),
        _ => Ok(()),
    }
}

/// The file of a mesh, if that has a face or enough vertices for a point cloud, and is within the limits.
pub(super) fn finish(mesh: TriMesh, limits: &ReadLimits) -> Result<MeshFile, Located> {
    let (n_vertices, n_faces) = (mesh.n_vertices(), mesh.n_faces());
    if n_faces == 0 && n_vertices < FEWEST_POINTS {
        return Err(Fault::NoFaces { n_vertices }.whole());
    }
    limits.check(n_vertices as u64, n_faces as u64).map_err(Fault::whole)?;
    Ok(MeshFile { mesh, ..MeshFile::default() })
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
