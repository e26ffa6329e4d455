//! The direction of the view, and the scale at which the mesh fills the image.

use mesh::TriMesh;
use nalgebra::{Matrix3, Point3, SymmetricEigen, Vector3};
use surface::VertexId;

/// Direction of an orthographic view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum View {
    /// For shapes that stand upright: `up` points up in the image.
    ///
    /// At azimuth and elevation 0 the x axis points right (the y axis if `up` is along x).
    Upright {
        /// Angle in degrees by which the viewer moves around the shape, counter-clockwise seen from above.
        azimuth: f64,
        /// Angle in degrees by which the viewer looks down.
        elevation: f64,
        /// Up direction, of any length; z if zero or not finite.
        up: Vector3<f64>,
    },
    /// The direction in which [`fixed`](Self::fixed) saw a mesh: right, up, towards the viewer, as rows.
    Fixed(Matrix3<f64>),
    /// For canonical forms, which have no up: the longest principal axis of the surface runs along the longer side
    /// of the image (vertically in a square one), the second one along the other side.
    ///
    /// Axes are oriented such that the longer tail of the surface is left or below, so two forms of one shape give
    /// the same image whatever the signs of their axes. A mirror image is seen from its other side, with the same
    /// outline.
    Principal,
}

impl Default for View {
    /// From the right front and slightly above, z up.
    fn default() -> Self {
        Self::Upright { azimuth: 30.0, elevation: 12.0, up: Vector3::z() }
    }
}

/// The empty border, as a share of the shorter side.
const MARGIN: f64 = 0.04;

/// An orthographic camera whose image plane is measured in samples.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Camera {
    /// Rows: right, up, towards the viewer; orthonormal.
    pub(super) axes: Matrix3<f64>,
    /// Samples per mesh unit.
    scale: f64,
    /// Rotated coordinates of the center of the image, at depth zero.
    center: Vector3<f64>,
    /// Half the size of the image, in samples.
    half: [f64; 2],
}

impl Camera {
    /// The camera that sees all of a [drawable] mesh in an image of `size` samples.
    pub(super) fn fit(mesh: &TriMesh, view: &View, size: [u32; 2]) -> Self {
        let axes = view.axes(mesh, size[0] > size[1]);
        let [low, high] = bounds(mesh, &axes);
        let half = size.map(|s| f64::from(s) / 2.0);
        let border = 2.0 * MARGIN * half[0].min(half[1]);
        let room = |i: usize| (2.0 * (half[i] - border) / (high[i] - low[i])).max(0.0);
        let scale = room(0).min(room(1));
        // Without faces, or with all in one point, any scale will do.
        let scale = if scale.is_finite() { scale } else { 1.0 };
        let center = if mesh.faces.is_empty() { Vector3::zeros() } else { low + (high - low) / 2.0 };
        Self { axes, scale, center, half }
    }

    /// Column, row (downwards) and depth (larger is nearer) of a point, all in samples.
    pub(super) fn project(&self, point: &Point3<f64>) -> [f64; 3] {
        let p = (self.axes * point.coords - self.center) * self.scale;
        [self.half[0] + p.x, self.half[1] - p.y, p.z]
    }
}

/// Lower and upper corner of the bounding box of the faces, rotated by `axes`.
fn bounds(mesh: &TriMesh, axes: &Matrix3<f64>) -> [Vector3<f64>; 2] {
    let nothing = [Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY)];
    mesh.faces.iter().flatten().fold(nothing, |[low, high], v| {
        let turned = axes * mesh.positions[v.index()].coords;
        [low.inf(&turned), high.sup(&turned)]
    })
}

/// Width over height of a mesh in a view; 1 if the mesh has no extent.
pub fn aspect(mesh: &TriMesh, view: &View) -> f64 {
    let mesh = drawable(mesh);
    let [low, high] = bounds(&mesh, &view.axes(&mesh, false));
    let aspect = (high.x - low.x) / (high.y - low.y);
    if aspect.is_finite() && aspect > 0.0 { aspect } else { 1.0 }
}

impl View {
    /// The direction in which this view shows `mesh`, independent of the mesh, for images that are wider than high
    /// (`landscape`) or not. Use it to show other meshes from the same direction.
    pub fn fixed(&self, mesh: &TriMesh, landscape: bool) -> Self {
        Self::Fixed(self.axes(&drawable(mesh), landscape))
    }

    /// Orthonormal rows: right, up, towards the viewer of a [drawable] mesh.
    fn axes(&self, mesh: &TriMesh, landscape: bool) -> Matrix3<f64> {
        match *self {
            Self::Upright { azimuth, elevation, up } => upright(azimuth, elevation, up),
            Self::Fixed(axes) => axes,
            Self::Principal => {
                let [first, second] = principal_axes(mesh);
                let (right, up) = if landscape { (first, second) } else { (second, first) };
                rows(right, up)
            }
        }
    }
}

/// The mesh with those of its faces whose three corners exist and are finite.
pub(super) fn drawable(mesh: &TriMesh) -> TriMesh {
    let usable =
        |v: &VertexId| mesh.positions.get(v.index()).is_some_and(|p| p.iter().all(|c| c.is_finite()));
    let faces = mesh.faces.iter().filter(|face| face.iter().all(usable)).copied().collect();
    TriMesh { positions: mesh.positions.clone(), faces }
}

fn rows(right: Vector3<f64>, up: Vector3<f64>) -> Matrix3<f64> {
    Matrix3::from_rows(&[right.transpose(), up.transpose(), right.cross(&up).transpose()])
}

fn upright(azimuth: f64, elevation: f64, up: Vector3<f64>) -> Matrix3<f64> {
    let up = up.try_normalize(0.0).filter(|unit| unit.iter().all(|c| c.is_finite()));
    let up = up.unwrap_or_else(Vector3::z);
    let finite = |degrees: f64| if degrees.is_finite() { degrees.to_radians() } else { 0.0 };
    let (azimuth, elevation) = (finite(azimuth), finite(elevation));
    let reference = if up.x.abs() > 0.9 { Vector3::y() } else { Vector3::x() };
    let right = (reference - up * up.dot(&reference)).normalize();
    let towards = right.cross(&up);
    let right_turned = right * azimuth.cos() - towards * azimuth.sin();
    let towards_turned = right_turned.cross(&up);
    rows(right_turned, up * elevation.cos() - towards_turned * elevation.sin())
}

/// The two longest principal axes of the surface, orthonormal; x and y if it has no extent.
fn principal_axes(mesh: &TriMesh) -> [Vector3<f64>; 2] {
    // Four weighted points, the corners and the centroid, have exactly the first and second moments of a face, so
    // the axes do not depend on the triangulation.
    let points = (0..mesh.n_faces()).flat_map(|f| {
        let ([a, b, c], area) = (mesh.triangle(f).map(|p| p.coords), mesh.area_vector(f).norm());
        [(area / 12.0, a), (area / 12.0, b), (area / 12.0, c), (area * 0.75, (a + b + c) / 3.0)]
    });
    let points: Vec<(f64, Vector3<f64>)> = points.collect();
    let area: f64 = points.iter().map(|p| p.0).sum();
    if !(area > 0.0 && area.is_finite()) {
        return [Vector3::x(), Vector3::y()];
    }
    let mean: Vector3<f64> = points.iter().map(|(w, p)| p * (w / area)).sum();
    let covariance: Matrix3<f64> =
        points.iter().map(|(w, p)| (p - mean) * (p - mean).transpose() * (w / area)).sum();
    let eigen = SymmetricEigen::new(covariance);
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| eigen.eigenvalues[j].total_cmp(&eigen.eigenvalues[i]));
    let signed = |k: usize| {
        let axis: Vector3<f64> = eigen.eigenvectors.column(order[k]).into_owned();
        let skew: f64 = points.iter().map(|(w, p)| w / area * (p - mean).dot(&axis).powi(3)).sum();
        if skew > 0.0 { -axis } else { axis }
    };
    [signed(0), signed(1)]
}
