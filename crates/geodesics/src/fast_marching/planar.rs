//! The planar update, from vertex to vertex (Kimmel and Sethian 1998, `kimmel1998`).
//!
//! The nearest vertex that was not visited yet is finalized. It lowers the other ends of its edges, and in each of its
//! triangles the farther of the two other vertices, if the nearer one is finalized. A finalized vertex that is lowered
//! again is visited again.

use base::{Budget, Exceeded};
use surface::{CornerId, Frontier, Rows, VertexId, scalar_product, twice_area};

use super::triangles::Triangles;
use super::unfold::HalfCorner;
use super::window::ROUNDING;
use crate::plane::{around, cross, dot, norm, sub};
use crate::source::Source;

/// Limit of the mean number of visits per vertex, after which finalized vertices are no longer corrected. Where
/// rounding decides, a few vertices might otherwise lower each other almost forever.
const VISITS_PER_VERTEX: usize = 256;

/// What a visit counts for in the meter of a budget.
const OPERATIONS: usize = 64;

/// A front of vertices.
#[derive(Debug, Default)]
pub(super) struct PlanarFront {
    front: Frontier,
    visits: usize,
}

impl PlanarFront {
    #[inline]
    pub(super) fn distance(&self, vertex: VertexId) -> f64 {
        self.front.distance(vertex)
    }

    /// Runs from sources until no vertex is left, without continuing from vertices where it `stops` at their distance.
    /// `halves` are those of the obtuse corners that unfolding has split, by the vertices of their bases.
    pub(super) fn run(
        &mut self,
        triangles: &Triangles,
        halves: &Rows<HalfCorner>,
        sources: &[Source],
        budget: &Budget,
        stops: impl Fn(VertexId, f64) -> bool,
    ) -> Result<(), Exceeded> {
        let n = triangles.order.len();
        self.front.reset(n);
        for (vertex, distance) in sources.iter().flat_map(Source::reach) {
            self.front.relax(triangles.number(*vertex), *distance);
        }
        let mut meter = budget.meter();
        self.visits = VISITS_PER_VERTEX.saturating_mul(n);
        while let Some((distance, vertex)) = self.front.pop() {
            meter.count(OPERATIONS)?;
            self.visits = self.visits.saturating_sub(1);
            if stops(vertex, distance) {
                continue;
            }
            for (end, length) in triangles.ways_from(vertex) {
                self.lower(end, distance + length);
            }
            for corner in triangles.corners.row(vertex.index()) {
                self.update(triangles, *corner, distance);
            }
            for HalfCorner { base, apex, third } in halves.row(vertex.index()) {
                if self.is_finalized(base.0) {
                    let sides = [base.1, apex.1, *third];
                    let (dot, cross) = (scalar_product(*third, base.1, apex.1), twice_area(sides));
                    let known = [distance, self.distance(base.0)];
                    self.lower(apex.0, planar_update(base.1, dot, cross, known));
                }
            }
        }
        budget.check()
    }

    /// Lowers the farther of the two vertices that share a triangle with the one at a corner, if the nearer is final.
    #[inline]
    fn update(&mut self, triangles: &Triangles, corner: CornerId, distance: f64) {
        let (triangle, slot) = (triangles.at(corner.face()), corner.slot());
        let ends = around(slot).map(|end| (triangle.vertex(end), end));
        let [next, prev] = ends.map(|(vertex, _)| self.distance(vertex));
        let [(near, near_slot), (far, far_slot)] = if next < prev { ends } else { [ends[1], ends[0]] };
        if !self.is_finalized(near) {
            return;
        }
        let corners = triangle.corners();
        let [to_near, to_far] = [near_slot, far_slot].map(|end| sub(corners[end], corners[slot]));
        let (dot, cross) = (dot(to_near, to_far), cross(to_near, to_far).abs());
        self.lower(far, planar_update(norm(to_near), dot, cross, [distance, self.distance(near)]));
    }

    #[inline]
    fn is_finalized(&self, vertex: VertexId) -> bool {
        self.distance(vertex).is_finite() && !self.front.is_waiting(vertex)
    }

    #[inline]
    fn lower(&mut self, vertex: VertexId, distance: f64) {
        let corrects = self.visits > 0 || !self.is_finalized(vertex);
        if corrects && distance < self.distance(vertex) * (1.0 - ROUNDING) {
            self.front.relax(vertex, distance);
        }
    }
}

/// Distance at `C` of a front that is a straight line, from the distances at `A` and `B`, for the base `|AB|` and the scalar
/// and cross product of `AB` and `AC`; infinite if the characteristic through `C` misses the base.
///
/// Kimmel and Sethian 1998 (`kimmel1998`): the larger root of their quadratic, here by the unit gradient whose
/// component along the base is `(at_b - at_a) / |AB|`.
fn planar_update(base: f64, dot: f64, cross: f64, [at_a, at_b]: [f64; 2]) -> f64 {
    let rise = at_b - at_a;
    let sq_height = (base - rise) * (base + rise);
    let (height, sq_base) = (sq_height.sqrt(), base * base);
    let crossing = dot * height - cross * rise;
    let distance = at_a + (rise * dot + height * cross) / sq_base;
    let is_hit = (sq_height > 0.0) & (crossing >= 0.0) & (crossing <= sq_base * height);
    if is_hit { distance } else { f64::INFINITY }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_planar_update_is_exact_for_a_straight_front() {
        let update = |known| planar_update(2.0, 2.0 * 0.7, 2.0 * 1.5, known);
        for angle in [-0.35f64, -0.1, 0.0, 0.2, 0.4] {
            let (gx, gy) = angle.sin_cos();
            let front = |p: [f64; 2]| 5.0 + gx * p[0] + gy * p[1];
            let t = update([front([0.0, 0.0]), front([2.0, 0.0])]);
            assert!((t - front([0.7, 1.5])).abs() < 1e-13);
        }
        assert_eq!([1.9, 2.1].map(|at_b| update([0.0, at_b])), [f64::INFINITY; 2]);
    }
}
