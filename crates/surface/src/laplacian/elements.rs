//! The triangles that functions on the surface are linear on.

use crate::triangle::Triangle;
use crate::triangulation::{GluedTriangle, Triangulation};

/// Two triangles on the same vertices are one when their sides differ by no more than this share.
const SAME: f64 = 1e-9;

/// Largest cotangent that enters a matrix: beyond it there is only rounding.
const STEEPEST: f64 = 1e9;

/// A triangle and how many sheets of the surface it represents.
#[derive(Debug, Clone, Copy)]
pub struct Element {
    /// The three vertices; one may occur twice.
    pub vertices: [u32; 3],
    /// Its base runs from the first vertex to the second, in units of the metric.
    pub triangle: Triangle,
    /// One for a face of the mesh, a half where front and back of the cover were flipped differently.
    pub share: f64,
}

/// The triangles of a cover, each with a share of a half. A front and its back are merged if both were flipped alike,
/// which holds everywhere except at boundaries and non-manifold edges.
pub(super) fn elements(cover: &Triangulation) -> Vec<Element> {
    let sorted = |triangle: &GluedTriangle| {
        let mut opposite = [0, 1, 2].map(|k| (triangle.vertices[k].0, triangle.lengths[k]));
        opposite.sort_by(|(v, l), (w, m)| v.cmp(w).then(l.total_cmp(m)));
        let [(a, bc), (b, ca), (c, ab)] = opposite;
        ([a, b, c], [ab, bc, ca])
    };
    let mut sorted: Vec<([u32; 3], [f64; 3])> = cover.triangles().iter().map(sorted).collect();
    let by_length = |a: &[f64; 3], b: &[f64; 3]| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]));
    sorted.sort_by(|(v, a), (w, b)| v.cmp(w).then(by_length(a, b)));
    let mut elements: Vec<Element> = Vec::with_capacity(sorted.len() / 2 + 1);
    let mut previous = [0.0; 3];
    for (vertices, sides) in sorted {
        let same = sides.iter().zip(previous).all(|(a, b)| (a - b).abs() <= SAME * a);
        match elements.last_mut() {
            Some(last) if last.vertices == vertices && same => last.share += 0.5,
            _ => {
                let [ab, bc, ca] = sides;
                elements.push(Element { vertices, triangle: Triangle::from_sides([ab, ca, bc]), share: 0.5 });
            }
        }
        previous = sides;
    }
    elements
}

impl Element {
    /// The cotangent weight of each pair of different vertices: `1/2 cot` of the angle opposite.
    pub fn weights(&self) -> impl Iterator<Item = ([u32; 2], f64)> {
        let [a, b, c] = self.vertices;
        let [at_a, at_b, at_c] = self.triangle.cotangents();
        let share = 0.5 * self.share;
        [([b, c], at_a), ([c, a], at_b), ([a, b], at_c)]
            .into_iter()
            .filter(|([i, j], _)| i != j)
            .map(move |(ends, cot)| (ends, share * cot.clamp(-STEEPEST, STEEPEST)))
    }
}
