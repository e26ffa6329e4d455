//! What the vertices that the front leaves in one round may lower.

use super::crossings::{Crossing, Reached};
use super::march::ROUNDING;
use super::sieve::Sieve;
use super::spokes::{Spokes, Ways};
use super::update::FAR;
use crate::prefetch::prefetch;

/// A way along an edge.
#[derive(Debug, Clone, Copy)]
pub(super) struct Step {
    pub(super) end: u32,
    pub(super) reached: Reached,
}

/// What the front is at, and what it knows.
#[derive(Debug, Clone, Copy)]
pub(super) struct Round<'a> {
    pub(super) spokes: &'a Spokes,
    pub(super) reached: &'a [Reached],
    /// The vertices that it leaves.
    pub(super) vertices: &'a [u32],
    /// What is nearer than this has been passed; for each vertex also what is nearer than the vertex.
    pub(super) passed: f64,
    /// Whether triangles may still lower vertices that it has passed.
    pub(super) corrects: bool,
}

impl Round<'_> {
    /// Crosses the triangles whose two other vertices have been passed, but are farther away than `vertex`, to
    /// the nearer one of them, too: `vertex` has been corrected.
    #[inline(never)]
    fn cross_both_ways(&self, vertex: u32, passed: f64, crossings: &mut Sieve<'_, Crossing>) {
        let distance = self.reached[vertex as usize].distance;
        let [first, end] = self.spokes.range_of(vertex);
        let mut before = end - 1;
        for spoke in first..end {
            let [at_before, at_end] =
                [before, spoke].map(|k| self.reached[self.spokes.at(k).end as usize].distance);
            let are_behind = [at_before, at_end].iter().all(|at| *at > distance && *at <= passed);
            let is_onward = at_before >= at_end;
            if are_behind && self.spokes.at(spoke).ways.allow_through(is_onward, true) {
                let crossing = Crossing { from: vertex, spoke, before, is_onward: u32::from(is_onward) };
                crossings.add(crossing, true);
            }
            before = spoke;
        }
    }
}

/// Room for what is found, kept from round to round.
#[derive(Debug, Default)]
pub(super) struct Departures {
    steps: Vec<Step>,
    crossings: Vec<Crossing>,
}

impl Departures {
    /// The steps that may lower a neighbour, and the triangles that the front crosses, from all vertices of a
    /// round but those where it `stops`.
    ///
    /// Of a triangle the farthest vertex is lowered, if the two others have been passed. It may have been, too:
    /// then only if it can be reached before the vertex that the front leaves.
    #[inline(never)]
    pub(super) fn find(
        &mut self,
        round: Round<'_>,
        stops: &impl Fn(u32, f64) -> bool,
    ) -> (&[Step], &[Crossing]) {
        let Round { spokes, reached, vertices, passed, corrects } = round;
        let mut most = 0;
        for own in vertices.iter().map(|vertex| spokes.of(*vertex)) {
            prefetch(own);
            most += own.len();
        }
        let blank = Step { end: 0, reached: Reached::NEVER };
        let mut steps = Sieve::new(&mut self.steps, most, blank);
        let mut crossings = Sieve::new(&mut self.crossings, 2 * most, Crossing::default());
        for &vertex in vertices {
            let Reached { distance, bend } = reached[vertex as usize];
            if stops(vertex, distance) {
                continue;
            }
            let own = spokes.of(vertex);
            let Some(last) = own.last() else { continue };
            let [first, end] = spokes.range_of(vertex);
            let bend_along = if spokes.bend_at(vertex) { distance } else { bend };
            let is_nearby = distance - bend <= (1.0 + FAR) * spokes.longest;
            let allowed = Ways::of_front(corrects, is_nearby);
            let passed = passed.max(distance);
            // What is farther away than this any triangle may lower, what is nearer only those completed late.
            let ahead_of = if corrects { distance } else { passed };
            let (mut before, mut at_before) = (end - 1, reached[last.end as usize].distance);
            for (number, spoke) in (first..).zip(own) {
                let at_end = reached[spoke.end as usize].distance;
                let ways = spoke.ways.only(allowed);
                let along = distance + spoke.length;
                let step = Step { end: spoke.end, reached: Reached { distance: along, bend: bend_along } };
                steps.add(step, (along <= at_end * (1.0 + ROUNDING)) & ways.allow(Ways::ALONG));
                let is_onward = at_before < at_end;
                // Not `min` and `max`, which look for NaN as well.
                let near = if at_before < at_end { at_before } else { at_end };
                let far = if at_before > at_end { at_before } else { at_end };
                let crossing =
                    Crossing { from: vertex, spoke: number, before, is_onward: u32::from(is_onward) };
                crossings.add(crossing, (near <= passed) & ways.allow_through(is_onward, far > ahead_of));
                (before, at_before) = (number, at_end);
            }
            if corrects && passed > distance {
                round.cross_both_ways(vertex, passed, &mut crossings);
            }
        }
        (steps.kept(), crossings.kept())
    }
}
