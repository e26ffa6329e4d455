//! The planar update, from vertex to vertex (Kimmel and Sethian 1998, `kimmel1998`).
//!
//! The nearest vertex that was not visited yet is finalized. It lowers the other ends of its edges, and in each of its
//! triangles the farther of the two other vertices, if the nearer one is finalized. A finalized vertex that is lowered
//! again is visited again.

use base::{Budget, Exceeded};
use surface::{Frontier, Rows, VertexId};

use super::triangles::{Triangles, around};
use super::unfold::HalfCorner;
use super::update::Stencil;
use super::window::ROUNDING;
use crate::plane::{cross, dot, norm, sub};
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
    pub(super) fn distance(&self, vertex: u32) -> f64 {
        self.front.distance(VertexId(vertex))
    }

    /// Runs from sources until no vertex is left, without continuing from vertices where it `stops` at their distance.
    /// `halves` are those of the obtuse corners that unfolding has split, by the vertices of their bases.
    pub(super) fn run(
        &mut self,
        triangles: &Triangles,
        halves: &Rows<HalfCorner>,
        sources: &[Source],
        budget: &Budget,
        stops: impl Fn(u32, f64) -> bool,
    ) -> Result<(), Exceeded> {
        let n = triangles.order.len();
        self.front.reset(n);
        for (vertex, distance) in sources.iter().flat_map(Source::reach) {
            self.front.relax(VertexId(triangles.rank[vertex.index()]), *distance);
        }
        let mut meter = budget.meter();
        self.visits = VISITS_PER_VERTEX.saturating_mul(n);
        while let Some((distance, VertexId(vertex))) = self.front.pop() {
            meter.count(OPERATIONS)?;
            self.visits = self.visits.saturating_sub(1);
            if stops(vertex, distance) {
                continue;
            }
            for (end, length) in triangles.ways_from(vertex) {
                self.lower(end, distance + length);
            }
            for corner in triangles.corners.row(vertex as usize) {
                self.update(triangles, *corner, distance);
            }
            for HalfCorner { base, apex, third } in halves.row(vertex as usize) {
                if self.is_finalized(base.0) {
                    let sides = [base.1, apex.1, *third];
                    let at_apex = Stencil::of_sides(sides).planar(distance, self.distance(base.0));
                    self.lower(apex.0, at_apex);
                }
            }
        }
        budget.check()
    }

    /// Lowers the farther of the two vertices that share a triangle with the one at a corner, if the nearer is final.
    #[inline]
    fn update(&mut self, triangles: &Triangles, corner: u32, distance: f64) {
        let (triangle, slot) = (triangles.at(corner / 3), corner as usize % 3);
        let ends = around(slot).map(|end| (triangle.vertex(end), end));
        let [next, prev] = ends.map(|(vertex, _)| self.distance(vertex));
        let [(near, near_slot), (far, far_slot)] = if next < prev { ends } else { [ends[1], ends[0]] };
        if !self.is_finalized(near) {
            return;
        }
        let corners = triangle.corners();
        let [to_near, to_far] = [near_slot, far_slot].map(|end| sub(corners[end], corners[slot]));
        let stencil = Stencil {
            base: norm(to_near),
            side: norm(to_far),
            dot: dot(to_near, to_far),
            cross: cross(to_near, to_far).abs(),
        };
        self.lower(far, stencil.planar(distance, self.distance(near)));
    }

    #[inline]
    fn is_finalized(&self, vertex: u32) -> bool {
        self.distance(vertex).is_finite() && !self.front.is_waiting(VertexId(vertex))
    }

    #[inline]
    fn lower(&mut self, vertex: u32, distance: f64) {
        let corrects = self.visits > 0 || !self.is_finalized(vertex);
        if corrects && distance < self.distance(vertex) * (1.0 - ROUNDING) {
            self.front.relax(VertexId(vertex), distance);
        }
    }
}
