//! A builder of closed surfaces from loops of vertices.

use std::f64::consts::TAU;

use mesh::TriMesh;
use nalgebra::{Point3, Vector3};
use surface::VertexId;

use super::flat::triangulate;
use super::options::{Diagonals, PartMesh};
use crate::trig::sin_cos;

/// A closed polygon of vertices, without repeating the first. All loops of a solid run counter-clockwise as seen against
/// one direction, those of holes too.
pub(super) type Loop = Vec<VertexId>;

/// A closed polygon in a plane.
pub(super) type Outline = Vec<[f64; 2]>;

/// A surface under construction. Faces share vertices because they name the same loops, so it is closed as soon as
/// every loop has a face on either side.
pub(super) struct Solid {
    pub(super) mesh: TriMesh,
    options: PartMesh,
}

impl Solid {
    pub(super) fn new(options: PartMesh) -> Self {
        Self { mesh: TriMesh::default(), options }
    }

    /// Number of segments of a circle.
    pub(super) fn arcs(&self) -> usize {
        self.options.arcs.max(6)
    }

    /// New vertices.
    pub(super) fn ring(&mut self, points: impl IntoIterator<Item = Point3<f64>>) -> Loop {
        let first = self.mesh.n_vertices();
        self.mesh.positions.extend(points);
        (first..self.mesh.n_vertices()).map(VertexId::from).collect()
    }

    /// New vertices on an outline at the height `z`.
    pub(super) fn level(&mut self, outline: &[[f64; 2]], z: f64) -> Loop {
        self.ring(outline.iter().map(|&[x, y]| Point3::new(x, y, z)))
    }

    /// A planar face with holes that faces `up`.
    pub(super) fn cap(&mut self, outer: &[VertexId], holes: &[Loop], up: Vector3<f64>) {
        let u = up.cross(&Vector3::ith(up.iamin(), 1.0)).normalize();
        let v = up.cross(&u);
        let mut corners = outer.to_vec();
        let mut starts = Vec::new();
        for hole in holes {
            starts.push(corners.len());
            corners.extend(hole);
        }
        let flat = |c: &VertexId| self.mesh.positions[c.index()].coords;
        let points: Vec<[f64; 2]> = corners.iter().map(|c| [u.dot(&flat(c)), v.dot(&flat(c))]).collect();
        let triangles = triangulate(&points, &starts, self.options.diagonals);
        self.mesh.faces.extend(triangles.into_iter().map(|t| t.map(|i| corners[i])));
    }

    /// The wall between two loops as long as each other. It faces away from the axis, and towards the axis if `lower` is
    /// above `upper`.
    pub(super) fn wall(&mut self, lower: &[VertexId], upper: &[VertexId]) {
        let n = lower.len();
        for i in 0..n {
            let [[a, b], [d, c]] = [lower, upper].map(|ring| [ring[i], ring[(i + 1) % n]]);
            if self.options.diagonals == Diagonals::Even && self.is_planar([a, b, c, d]) {
                self.mesh.faces.extend([[a, b, d], [b, c, d]]);
            } else {
                self.mesh.faces.extend([[a, b, c], [a, c, d]]);
            }
        }
    }

    fn is_planar(&self, quad: [VertexId; 4]) -> bool {
        let [a, b, c, d] = quad.map(|v| self.mesh.positions[v.index()]);
        let volume = (b - a).cross(&(c - a)).dot(&(d - a)).abs();
        volume <= 1e-9 * (b - a).norm() * (c - a).norm() * (d - a).norm()
    }

    /// Walls of an outline, outer or of a hole, between two heights: the lower and the upper loop.
    pub(super) fn prism(&mut self, outline: &[[f64; 2]], z: [f64; 2], is_hole: bool) -> [Loop; 2] {
        let [lower, upper] = z.map(|z| self.level(outline, z));
        let [from, to] = if is_hole { [&upper, &lower] } else { [&lower, &upper] };
        self.wall(from, to);
        [lower, upper]
    }

    /// A plate between two heights, with holes.
    pub(super) fn extrude(&mut self, outline: &[[f64; 2]], holes: &[Outline], z: [f64; 2]) {
        let [under, top] = self.prism(outline, z, false);
        let [lower, upper] = self.bores(holes, z);
        self.cap(&under, &lower, -Vector3::z());
        self.cap(&top, &upper, Vector3::z());
    }

    /// The walls of holes between two heights: the lower and the upper loops.
    pub(super) fn bores(&mut self, holes: &[Outline], z: [f64; 2]) -> [Vec<Loop>; 2] {
        let prisms = holes.iter().map(|hole| <(Loop, Loop)>::from(self.prism(hole, z, true)));
        let (lower, upper) = prisms.unzip();
        [lower, upper]
    }

    /// Revolves a line of points (radius, height) about the z axis, from the lowest face to the highest.
    pub(super) fn revolve(&mut self, line: &[[f64; 2]]) {
        let rings: Vec<Loop> =
            line.iter().map(|&[radius, z]| self.level(&circle([0.0, 0.0], radius, self.arcs()), z)).collect();
        for (ends, pair) in line.windows(2).zip(rings.windows(2)) {
            if ends[0][1] != ends[1][1] {
                self.wall(&pair[0], &pair[1]);
            } else if ends[0][0] > ends[1][0] {
                self.cap(&pair[0], &pair[1..], Vector3::z());
            } else {
                self.cap(&pair[1], &pair[..1], -Vector3::z());
            }
        }
        self.cap(&rings[0], &[], -Vector3::z());
        self.cap(&rings[rings.len() - 1], &[], Vector3::z());
    }
}

/// A regular polygon whose corners lie on a circle.
pub(super) fn circle(center: [f64; 2], radius: f64, n: usize) -> Outline {
    (0..n).map(|i| on_circle(center, radius, TAU * i as f64 / n as f64)).collect()
}

pub(super) fn on_circle([x, y]: [f64; 2], radius: f64, angle: f64) -> [f64; 2] {
    let (sin, cos) = sin_cos(angle);
    [x + radius * cos, y + radius * sin]
}

/// A hexagon with this distance between opposite sides.
pub(super) fn hexagon(across_flats: f64) -> Outline {
    circle([0.0, 0.0], across_flats / 3f64.sqrt(), 6)
}

/// A rectangle around the origin, its corners rounded if `radius` is not zero.
pub(super) fn rectangle([length, width]: [f64; 2], radius: f64, arcs: usize) -> Outline {
    let quarter = arcs.div_ceil(4);
    let corner = |(sx, sy, turn): (f64, f64, f64)| {
        let center = [sx * (length / 2.0 - radius), sy * (width / 2.0 - radius)];
        let steps = if radius > 0.0 { quarter } else { 0 };
        (0..=steps).map(move |i| on_circle(center, radius, TAU / 4.0 * (turn + i as f64 / quarter as f64)))
    };
    let corners = [(1.0, 1.0, 0.0), (-1.0, 1.0, 1.0), (-1.0, -1.0, 2.0), (1.0, -1.0, 3.0)];
    corners.into_iter().flat_map(corner).collect()
}
