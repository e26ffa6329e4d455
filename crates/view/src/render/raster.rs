//! The visible face and its depth at each sample.

use mesh::TriMesh;
use nalgebra::Vector3;

use super::camera::Camera;

/// A face projected onto the image plane.
#[derive(Debug, Clone, Copy)]
pub(super) struct Projected {
    /// The three vertices.
    pub(super) vertices: [usize; 3],
    /// Barycentric coordinates at the origin of the image.
    origin: Vector3<f64>,
    /// Their change per sample to the right and down.
    pub(super) slopes: [Vector3<f64>; 2],
    /// Depth of the three corners.
    depths: Vector3<f64>,
}

impl Projected {
    /// `None` for a face seen edge-on.
    fn new(vertices: [usize; 3], corners: [[f64; 3]; 3]) -> Option<Self> {
        let [a, b, c] = corners;
        let double_area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        let side = |p: [f64; 3], q: [f64; 3]| (p[0] - q[0]).powi(2) + (p[1] - q[1]).powi(2);
        let rounding = 1e-10 * side(a, b).max(side(b, c)).max(side(c, a));
        if double_area.abs() <= rounding || !double_area.is_finite() {
            return None;
        }
        // The coordinate of a corner is the relative area of the triangle over the opposite edge.
        let edge = |p: [f64; 3], q: [f64; 3]| {
            let (right, down) = ((p[1] - q[1]) / double_area, (q[0] - p[0]) / double_area);
            [-(right * p[0] + down * p[1]), right, down]
        };
        let edges = [edge(b, c), edge(c, a), edge(a, b)];
        let column = |k: usize| Vector3::new(edges[0][k], edges[1][k], edges[2][k]);
        Some(Self {
            vertices,
            origin: column(0),
            slopes: [column(1), column(2)],
            depths: Vector3::new(a[2], b[2], c[2]),
        })
    }

    /// Barycentric coordinates at the centre of a sample; all in 0..=1 inside the face.
    pub(super) fn at(&self, column: usize, row: usize) -> Vector3<f64> {
        self.origin + self.slopes[0] * (column as f64 + 0.5) + self.slopes[1] * (row as f64 + 0.5)
    }
}

/// The nearest face at every sample.
pub(super) struct DepthBuffer {
    /// Columns and rows of samples.
    pub(super) size: [usize; 2],
    /// Depth in samples, larger is nearer; minus infinity for the background.
    pub(super) depth: Vec<f32>,
    /// Index into `projected`; [`DepthBuffer::BACKGROUND`] for the background.
    pub(super) face: Vec<u32>,
    /// All drawable faces in order; `None` for those seen edge-on.
    pub(super) projected: Vec<Option<Projected>>,
}

impl DepthBuffer {
    pub(super) const BACKGROUND: u32 = u32::MAX;

    /// Draws all faces. Of two faces at the same depth the first stays.
    pub(super) fn draw(mesh: &TriMesh, faces: &[[usize; 3]], camera: &Camera, size: [u32; 2]) -> Self {
        let size = size.map(|s| s as usize);
        let points: Vec<[f64; 3]> = mesh.positions.iter().map(|p| camera.project(p)).collect();
        let mut buffer = Self {
            size,
            depth: vec![f32::NEG_INFINITY; size[0] * size[1]],
            face: vec![Self::BACKGROUND; size[0] * size[1]],
            projected: Vec::with_capacity(faces.len()),
        };
        for (f, &face) in faces.iter().enumerate() {
            let corners = face.map(|v| points[v]);
            let projected = Projected::new(face, corners);
            if let Some(projected) = &projected {
                buffer.fill(f as u32, projected, corners);
            }
            buffer.projected.push(projected);
        }
        buffer
    }

    fn fill(&mut self, index: u32, face: &Projected, corners: [[f64; 3]; 3]) {
        let range = |axis: usize| {
            let low = corners.iter().map(|c| c[axis]).fold(f64::INFINITY, f64::min);
            let high = corners.iter().map(|c| c[axis]).fold(f64::NEG_INFINITY, f64::max);
            // Sample centres lie at halves. Casts saturate, so far-away corners are safe.
            let end = (high + 0.5).floor().max(0.0) as usize;
            (low - 0.5).ceil().max(0.0) as usize..end.min(self.size[axis])
        };
        let (columns, rows) = (range(0), range(1));
        for row in rows {
            for column in columns.clone() {
                let at = face.at(column, row);
                // A little slack closes the seams between neighbours.
                if at.min() < -1e-9 {
                    continue;
                }
                let depth = at.dot(&face.depths) as f32;
                let sample = row * self.size[0] + column;
                if depth > self.depth[sample] {
                    self.depth[sample] = depth;
                    self.face[sample] = index;
                }
            }
        }
    }
}
