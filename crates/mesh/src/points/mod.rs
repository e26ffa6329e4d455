//! Surfaces of point clouds.
//!
//! Points are smoothed if they are noisy ([`smooth`]), then every point makes the triangles around itself in its tangent
//! plane ([`star`]), and triangles that points agree on become the surface ([`select`]).

mod fit;
mod select;
mod smooth;
mod star;

use base::Observer;
use nalgebra::Point3;
use serde::Serialize;
use surface::VertexId;

use crate::box_tree::BoxTree;
use crate::coincidence::coincident_pairs;
use crate::error::{MIN_POINTS, MeshError};
use crate::face_set::check_finite;
use crate::orientation::orient_consistently;
use crate::tri_mesh::TriMesh;

/// The surface of a point cloud.
#[derive(Debug, Clone, PartialEq)]
pub struct TriangulatedPoints {
    /// The surface. Its vertices are the points, in their order, moved if the points are noisy.
    pub mesh: TriMesh,
    /// For every point, the vertex that stands for it: itself if a face uses it, otherwise the nearest that is used. `None`
    /// for points far from the surface.
    pub vertex: Vec<Option<VertexId>>,
    /// What was done.
    pub report: PointsReport,
}

/// How points became a surface.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct PointsReport {
    /// Number of points.
    pub n_points: usize,
    /// Number of faces of the surface.
    pub n_faces: usize,
    /// Mean distance of a point from its neighbors in the surface, if they were spread evenly, in mesh units.
    pub spacing: f64,
    /// Standard deviation of the points from smooth patches, in mesh units: the noise, and curvature that the sampling is too
    /// coarse for.
    pub noise: f64,
    /// Fewest neighbors to which patches were fitted for smoothing; 0 if the points were left where they are.
    pub neighbors: usize,
    /// Points without a face, for which a vertex nearby stands, and copies of other points.
    pub replaced_points: usize,
    /// Points far from the surface, which are left out.
    pub outliers: usize,
}

impl PointsReport {
    /// One line for people.
    pub fn summary(&self) -> String {
        let mut text = format!("{} points without faces joined by {} faces", self.n_points, self.n_faces);
        if self.neighbors > 0 {
            let of_spacing = self.noise / self.spacing;
            text +=
                &format!(", after smoothing noise of {:.3e} ({of_spacing:.1} times the spacing)", self.noise);
        }
        if self.replaced_points > 0 {
            text += &format!("; the nearest vertex stands for {} of them", self.replaced_points);
        }
        if self.outliers > 0 {
            text += &format!("; {} far from the others left out", self.outliers);
        }
        text
    }
}

/// The surface through a cloud of points: triangles between neighbors, at most two at an edge.
///
/// 1. **Smoothing.** The noise is measured with patches, quadrics fitted to the nearest points: the smallest patches of
///    which a quarter are flat for their size tell the noise. If there is more than a small part of the spacing, every
///    point is projected onto the largest patch around it that fits within the noise (moving least squares; `alexa2003` in
///    `REFERENCES.bib`).
/// 2. **Triangles.** Every point takes its neighbors into its tangent plane, where the corners of its Voronoi cell are
///    the triangles of the Delaunay triangulation around it (`sharp2020` uses the union of these). Empty circles larger
///    than the neighborhood make no triangle, so boundaries and holes stay open.
/// 3. **Agreement.** A triangle is proposed by up to three points. Those with three proposals are taken first, then those with
///    two, each unless it overlaps a face that was taken, as seen in the tangent planes of its corners. Small gaps that are left
///    are closed.
///
/// Faces are oriented alike where that is possible. The result does not depend on threads, and scale changes nothing.
/// Parts that are closer to each other than the noise, or than two spacings, may be joined.
///
/// ```
/// use base::Observer;
/// use canonform_mesh::{shapes, triangulate_points, validate};
///
/// let ball = shapes::icosphere(4);
/// let found = triangulate_points(&ball.positions, &())?;
/// assert_eq!(found.mesh.n_faces(), ball.n_faces());
/// assert!((found.mesh.area() / ball.area() - 1.0).abs() < 1e-3);
/// assert_eq!(validate(&found.mesh).n_boundary_loops, 0);
/// # Ok::<(), canonform_mesh::MeshError>(())
/// ```
///
/// # Errors
/// [`MeshError::NonFinite`]; [`MeshError::TooFewPoints`], of which [`MIN_POINTS`] are needed; [`MeshError::NoSurface`] if no triangle
/// is agreed on; [`MeshError::Exceeded`].
pub fn triangulate_points(
    points: &[Point3<f64>],
    observer: &dyn Observer,
) -> Result<TriangulatedPoints, MeshError> {
    let budget = observer.budget();
    check_finite(points)?;
    let cloud = TriMesh { positions: points.to_vec(), faces: Vec::new() };
    let unit = cloud.unit();
    let scaled: Vec<Point3<f64>> = points.iter().map(|p| p / unit).collect();
    let (distinct, of_point) = without_copies(&scaled);
    if distinct.len() < MIN_POINTS {
        return Err(MeshError::TooFewPoints(distinct.len()));
    }
    let smooth = smooth::smooth(distinct.iter().map(|&i| scaled[i]).collect(), &budget)?;
    budget.check()?;
    let stars = star::stars(&smooth.points);
    budget.check()?;
    let faces = select::agreed(&stars);
    if faces.is_empty() {
        return Err(MeshError::NoSurface(points.len()));
    }
    let stands = stand_ins(&faces, &smooth.points, smooth.spacing);

    let mut mesh = cloud;
    for (&point, p) in distinct.iter().zip(&smooth.points) {
        if smooth.neighbors > 0 {
            mesh.positions[point] = p * unit;
        }
    }
    mesh.faces = faces.iter().map(|face| face.map(|v| VertexId::from(distinct[v as usize]))).collect();
    orient_consistently(&mut mesh);
    let vertex: Vec<Option<VertexId>> =
        of_point.iter().map(|&d| stands[d as usize].map(|v| VertexId::from(distinct[v as usize]))).collect();
    let is_replaced =
        |(point, vertex): &(usize, &Option<VertexId>)| vertex.is_some_and(|v| v.index() != *point);
    let report = PointsReport {
        n_points: points.len(),
        n_faces: mesh.n_faces(),
        spacing: smooth.spacing * unit,
        noise: smooth.noise * unit,
        neighbors: smooth.neighbors,
        replaced_points: vertex.iter().enumerate().filter(is_replaced).count(),
        outliers: vertex.iter().filter(|v| v.is_none()).count(),
    };
    Ok(TriangulatedPoints { mesh, vertex, report })
}

/// The first point in every position, ascending, and for each point its number among them.
fn without_copies(points: &[Point3<f64>]) -> (Vec<usize>, Vec<u32>) {
    let mut first: Vec<u32> = (0..points.len() as u32).collect();
    let pairs = coincident_pairs(points, 0..points.len() as u32);
    pairs.into_iter().for_each(|[one, other]| first[other as usize] = one);
    let distinct: Vec<usize> = (0..points.len()).filter(|&i| first[i] as usize == i).collect();
    let number = |first: &u32| distinct.partition_point(|&i| i < *first as usize) as u32;
    let of_point = first.iter().map(number).collect();
    (distinct, of_point)
}

/// For every point the vertex that stands for it.
fn stand_ins(faces: &[[u32; 3]], points: &[Point3<f64>], spacing: f64) -> Vec<Option<u32>> {
    /// Farthest stand-in, in spacings.
    const FARTHEST: f64 = 4.0;
    let mut is_used = vec![false; points.len()];
    faces.iter().flatten().for_each(|&v| is_used[v as usize] = true);
    let used = points.iter().copied().zip(0..).filter(|(_, v)| is_used[*v as usize]);
    let near = BoxTree::new(used);
    (0..points.len())
        .map(|i| match is_used[i] {
            true => Some(i as u32),
            false => near
                .nearest(&points[i], 1)
                .first()
                .filter(|(sq, _)| *sq <= (FARTHEST * spacing).powi(2))
                .map(|(_, v)| *v),
        })
        .collect()
}
