//! The visible face and its depth at each sample.

use std::ops::Range;

use base::{Budget, Exceeded};
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

    /// Barycentric coordinates at the center of a sample; all in 0..=1 inside the face.
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

/// The samples by which the edges of a face may be off by rounding, and more.
const PADDING: f64 = 1.0;

impl DepthBuffer {
    pub(super) const BACKGROUND: u32 = u32::MAX;

    /// Draws all faces of a drawable mesh. Of two faces at the same depth the first stays.
    ///
    /// A face costs time in the rows that it crosses, and in the samples that it covers.
    pub(super) fn draw(
        mesh: &TriMesh,
        camera: &Camera,
        size: [u32; 2],
        budget: &Budget,
    ) -> Result<Self, Exceeded> {
        let size = size.map(|s| s as usize);
        let points: Vec<[f64; 3]> = mesh.positions.iter().map(|p| camera.project(p)).collect();
        let mut buffer = Self {
            size,
            depth: vec![f32::NEG_INFINITY; size[0] * size[1]],
            face: vec![Self::BACKGROUND; size[0] * size[1]],
            projected: Vec::with_capacity(mesh.n_faces()),
        };
        let mut meter = budget.meter();
        for (f, face) in mesh.faces.iter().enumerate() {
            let face = face.map(|v| v.index());
            let corners = face.map(|v| points[v]);
            let projected = Projected::new(face, corners);
            if let Some(projected) = &projected {
                meter.count(buffer.fill(f as u32, projected, corners))?;
            }
            buffer.projected.push(projected);
        }
        budget.check()?;
        Ok(buffer)
    }

    /// Draws a face; returns the number of rows and samples that it was compared with.
    fn fill(&mut self, index: u32, face: &Projected, corners: [[f64; 3]; 3]) -> usize {
        let mut work = 0;
        let rows = corners.map(|corner| corner[1]).into_iter();
        let rows = [rows.clone().fold(f64::INFINITY, f64::min), rows.fold(f64::NEG_INFINITY, f64::max)];
        for row in samples_between(rows, self.size[1]) {
            let center = row as f64 + 0.5;
            let Some([left, right]) = extent_within(&corners, [center - PADDING, center + PADDING]) else {
                continue;
            };
            let columns = samples_between([left - PADDING, right + PADDING], self.size[0]);
            work += 1 + columns.len();
            for column in columns {
                let at = face.at(column, row);
                // A little slack closes the seams between neighbors.
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
        work
    }
}

/// The samples with centers between two positions. Centers lie at halves.
fn samples_between([low, high]: [f64; 2], size: usize) -> Range<usize> {
    // Casts saturate, so far-away corners are safe.
    let end = (high + 0.5).floor().max(0.0) as usize;
    (low - 0.5).ceil().max(0.0) as usize..end.min(size)
}

/// The least and greatest column of a triangle between two rows; `None` if no part of it is there.
fn extent_within(corners: &[[f64; 3]; 3], [top, bottom]: [f64; 2]) -> Option<[f64; 2]> {
    let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
    for (i, [x, y, _]) in corners.iter().enumerate() {
        let [other_x, other_y, _] = corners[(i + 1) % 3];
        let mut reach = |x: f64| (left, right) = (left.min(x), right.max(x));
        if (top..=bottom).contains(y) {
            reach(*x);
        }
        for row in [top, bottom] {
            if (*y < row) != (other_y < row) {
                reach(x + (other_x - x) * ((row - y) / (other_y - y)));
            }
        }
    }
    (left <= right).then_some([left, right])
}
