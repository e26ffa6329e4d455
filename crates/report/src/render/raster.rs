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

    /// The largest depth at the centers of some samples, or a little more, as [`at`](Self::at) and the depths of the
    /// corners give it with any rounding.
    fn greatest_depth(&self, columns: &Range<usize>, rows: &Range<usize>) -> f32 {
        let slopes = self.slopes.map(|slope| slope.dot(&self.depths));
        let end = |slope: f64, range: &Range<usize>| {
            (if slope > 0.0 { range.end - 1 } else { range.start }) as f64 + 0.5
        };
        let [column, row] = [end(slopes[0], columns), end(slopes[1], rows)];
        let magnitude = self.origin.abs()
            + self.slopes[0].abs() * columns.end as f64
            + self.slopes[1].abs() * rows.end as f64;
        let rounding = 16.0 * f64::EPSILON * magnitude.dot(&self.depths.abs());
        (self.origin.dot(&self.depths) + slopes[0] * column + slopes[1] * row + rounding) as f32
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
    /// The least depth in each tile, row by row: nothing behind it is visible there.
    tiles: Vec<f32>,
}

/// Columns and rows of a tile, in samples.
const TILE: usize = 8;

/// The samples by which the edges of a face may be off by rounding, and more.
const PADDING: f64 = 1.0;

impl DepthBuffer {
    pub(super) const BACKGROUND: u32 = u32::MAX;

    /// Draws all faces. Of two faces at the same depth the first stays.
    ///
    /// A face costs time in the tiles that it crosses, and in those where it is not hidden behind earlier faces.
    pub(super) fn draw(
        mesh: &TriMesh,
        faces: &[[usize; 3]],
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
            projected: Vec::with_capacity(faces.len()),
            tiles: vec![f32::NEG_INFINITY; size[0].div_ceil(TILE) * size[1].div_ceil(TILE)],
        };
        let mut meter = budget.meter();
        for (f, &face) in faces.iter().enumerate() {
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

    /// Draws a face; returns the number of tiles and samples that it was compared with.
    fn fill(&mut self, index: u32, face: &Projected, corners: [[f64; 3]; 3]) -> usize {
        let [columns, rows] = [0, 1].map(|axis| {
            let at = corners.map(|corner| corner[axis]);
            samples_between(
                at.into_iter().fold(f64::INFINITY, f64::min),
                at.into_iter().fold(f64::NEG_INFINITY, f64::max),
                self.size[axis],
            )
        });
        let (mut work, n_tiles) = (0, self.size[0].div_ceil(TILE));
        for tile_row in tiles(&rows) {
            let rows = part(&rows, tile_row);
            let band = [rows.start as f64 - PADDING, rows.end as f64 + PADDING];
            let Some([left, right]) = extent_within(&corners, band) else { continue };
            let reached = samples_between(left - PADDING, right + PADDING, self.size[0]);
            let columns = columns.start.max(reached.start)..columns.end.min(reached.end);
            for tile_column in tiles(&columns) {
                work += 1;
                let columns = part(&columns, tile_column);
                let tile = tile_row * n_tiles + tile_column;
                if face.greatest_depth(&columns, &rows) <= self.tiles[tile] {
                    continue;
                }
                work += columns.len() * rows.len();
                if self.fill_tile(index, face, &columns, &rows) {
                    self.tiles[tile] = self.least_depth(tile_column, tile_row);
                }
            }
        }
        work
    }

    /// Draws the part of a face that covers some samples; returns whether it is visible at any of them.
    fn fill_tile(
        &mut self,
        index: u32,
        face: &Projected,
        columns: &Range<usize>,
        rows: &Range<usize>,
    ) -> bool {
        let mut is_visible = false;
        for row in rows.clone() {
            for column in columns.clone() {
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
                    is_visible = true;
                }
            }
        }
        is_visible
    }

    fn least_depth(&self, tile_column: usize, tile_row: usize) -> f32 {
        let [columns, rows] =
            [(tile_column, 0), (tile_row, 1)].map(|(tile, axis)| part(&(0..self.size[axis]), tile));
        let rows = rows.map(|row| &self.depth[row * self.size[0]..][columns.clone()]);
        rows.flatten().copied().fold(f32::INFINITY, f32::min)
    }
}

/// The samples with centers between two positions. Centers lie at halves.
fn samples_between(low: f64, high: f64, size: usize) -> Range<usize> {
    // Casts saturate, so far-away corners are safe.
    let end = (high + 0.5).floor().max(0.0) as usize;
    (low - 0.5).ceil().max(0.0) as usize..end.min(size)
}

/// The tiles that some columns or rows lie in.
fn tiles(samples: &Range<usize>) -> Range<usize> {
    if samples.is_empty() { 0..0 } else { samples.start / TILE..samples.end.div_ceil(TILE) }
}

/// The columns or rows that lie in a tile.
fn part(samples: &Range<usize>, tile: usize) -> Range<usize> {
    samples.start.max(tile * TILE)..samples.end.min((tile + 1) * TILE)
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

#[cfg(test)]
mod tests {
    use super::super::camera::View;
    use super::*;
    use crate::tests::meshes::{mesh, sphere};

    /// Long needles in all directions, and a large face in front of some of them.
    fn needles(n: usize) -> TriMesh {
        let mut points = Vec::new();
        let mut faces = Vec::new();
        for i in 0..n {
            let t = 0.7 * i as f64;
            let ([sin, cos], depth) = ([t.sin(), t.cos()], (1.3 * t).sin());
            let first = points.len();
            points.extend([[cos, depth, sin], [-cos, -depth, -sin], [1e-3 * sin, 0.5 * depth, -1e-3 * cos]]);
            faces.push([0, 1, 2].map(|corner| (first + corner) as u32));
        }
        let first = points.len() as u32;
        points.extend([[-0.9, -0.2, -0.8], [0.9, 0.1, -0.7], [0.0, 0.0, 0.9]]);
        faces.push([first, first + 1, first + 2]);
        mesh(&points, &faces)
    }

    fn drawn(mesh: &TriMesh, side: u32) -> (DepthBuffer, usize) {
        let faces = super::super::camera::drawable_faces(mesh);
        let camera = Camera::fit(mesh, &faces, &View::default(), [side; 2], 0.05);
        let mut buffer = DepthBuffer::draw(mesh, &faces, &camera, [side; 2], &Budget::unlimited()).unwrap();
        // Drawing everything once more compares the same tiles and changes nothing.
        let (depth, face) = (buffer.depth.clone(), buffer.face.clone());
        let mut work = 0;
        for (f, corners) in faces.iter().enumerate() {
            if let Some(projected) = buffer.projected[f] {
                let corners = corners.map(|v| camera.project(&mesh.positions[v]));
                work += buffer.fill(f as u32, &projected, corners);
            }
        }
        assert!(depth == buffer.depth && face == buffer.face);
        (buffer, work)
    }

    #[test]
    fn every_sample_shows_the_nearest_face_that_covers_it() {
        for mesh in [needles(150), sphere(20)] {
            let (buffer, _) = drawn(&mesh, 97);
            for row in 0..97 {
                for column in 0..97 {
                    let (mut depth, mut face) = (f32::NEG_INFINITY, DepthBuffer::BACKGROUND);
                    for (f, projected) in buffer.projected.iter().enumerate() {
                        let Some(projected) = projected else { continue };
                        let at = projected.at(column, row);
                        let here = at.dot(&projected.depths) as f32;
                        if at.min() >= -1e-9 && here > depth {
                            (depth, face) = (here, f as u32);
                        }
                    }
                    let sample = row * 97 + column;
                    assert_eq!((buffer.depth[sample], buffer.face[sample]), (depth, face), "{column}, {row}");
                }
            }
        }
    }

    #[test]
    fn needles_cost_their_length_and_not_the_area_around_them() {
        let (side, n) = (400, 300);
        let (_, work) = drawn(&needles(n), side);
        assert!(work < 60 * n * side as usize, "{work}");
    }

    #[test]
    fn a_cancelled_picture_is_an_error() {
        let budget = Budget::unlimited();
        budget.cancel();
        let found = super::super::render(&sphere(8), &Default::default(), &budget);
        assert_eq!(found.unwrap_err(), Exceeded::Cancelled);
    }
}
