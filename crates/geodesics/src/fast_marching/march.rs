//! The front on its way over a surface.

use super::spokes::{Spoke, Spokes, Ways};
use super::update::Sector;
use crate::heap::Front;
use crate::prefetch::prefetch;

/// Distances that differ by less than this share are equal but for rounding: a correction is not worth
/// another visit, and of two ways the one that bent earlier is taken, whatever their order.
const ROUNDING: f64 = 1e-13;

/// Corrections that a vertex may get on the average. Over flipped edges real surfaces need less than half a
/// one; in triangles without height, where rounding decides, or with unfolded corners, a few vertices may
/// otherwise lower each other almost for ever. Sheared sheets left unflipped need up to a hundred.
const CORRECTIONS_PER_VERTEX: usize = 256;

/// Where the ways to the two ends of a base bent at different distances, this share of the difference
/// is added to the lesser: the mean error over the reference meshes is least between 0.3 and 0.4, where
/// errors of either sign balance.
const LATER_BEND: f64 = 0.35;

/// A front and where the ways to its vertices last bent.
#[derive(Debug, Default)]
pub(super) struct March {
    front: Front,
    /// For every vertex, the distance from the source at which the way to it last bent; zero for a
    /// straight one.
    bends: Vec<f64>,
    /// What the vertex that the front leaves has found for its neighbours. They get it when it has found
    /// everything, or the result would depend on the order of its spokes.
    arrivals: Vec<(u32, Arrival)>,
}

impl March {
    /// Forgets everything. Allocates only to grow.
    pub(super) fn reset(&mut self, n: usize) {
        self.front.reset(n);
        self.bends.clear();
        self.bends.resize(n, 0.0);
    }

    /// Puts a vertex at a straight distance from the source into the front.
    pub(super) fn start(&mut self, vertex: u32, distance: f64) {
        self.front.relax(vertex, distance);
    }

    #[inline]
    pub(super) fn distance(&self, vertex: u32) -> f64 {
        self.front.distance(vertex)
    }

    /// Lets the front run until it stops at every vertex where `stops` says so of its distance.
    pub(super) fn run(
        &mut self,
        spokes: &Spokes,
        stops: impl Fn(u32, f64) -> Stop,
        solve: impl Fn(Sector, f64, f64) -> f64,
    ) {
        // How far the front has been. A corrected vertex is behind it: the other end of a base then counts
        // as passed although it lies farther away, or the result would depend on the order of the spokes.
        let mut passed = 0.0f64;
        let mut corrections = CORRECTIONS_PER_VERTEX * self.bends.len();
        while let Some((distance, vertex)) = self.front.pop() {
            if distance < passed {
                corrections = corrections.saturating_sub(1);
            }
            if let Some(next) = self.front.nearest() {
                prefetch(spokes.of(next));
            }
            passed = passed.max(distance);
            // Later on, triangles lower only what the front has not passed; edges always end by themselves.
            let lowers = |known: f64| corrections > 0 || known > passed;
            match stops(vertex, distance) {
                Stop::No => {}
                Stop::Here => continue,
                Stop::Everywhere => break,
            }
            let bend = self.bends[vertex as usize];
            let bend_along = if spokes.bend_at(vertex) { distance } else { bend };
            // Through a triangle whose base the front has passed at its other end, too.
            let through = |sector: Sector, at_other: f64, bend_of_other: f64| {
                let bend = bend.min(bend_of_other) + LATER_BEND * (bend - bend_of_other).abs();
                Arrival { distance: bend + solve(sector, distance - bend, at_other - bend), bend }
            };
            let mut before = Spoke { end: vertex, ways: Ways::NONE, length: 0.0, dot: 0.0, cross: 0.0 };
            let mut at_before = f64::INFINITY;
            let mut arrival_before = Arrival::NEVER;
            for spoke in spokes.of(vertex) {
                let at_end = self.front.distance(spoke.end);
                let mut arrival = Arrival::NEVER;
                if at_end > distance && spoke.ways.allow(Ways::ALONG) {
                    arrival = Arrival { distance: distance + spoke.length, bend: bend_along };
                }
                if at_before <= passed && lowers(at_end) && spoke.ways.allow(Ways::ONWARD) {
                    let sector = spoke.onward_from(&before);
                    if at_end > distance || (at_before < at_end && sector.may_complete_late()) {
                        arrival.lower(through(sector, at_before, self.bends[before.end as usize]));
                    }
                }
                if at_end <= passed && lowers(at_before) && spoke.ways.allow(Ways::BACK) {
                    let sector = spoke.back_to(&before);
                    if at_before > distance || (at_end < at_before && sector.may_complete_late()) {
                        arrival_before.lower(through(sector, at_end, self.bends[spoke.end as usize]));
                    }
                }
                if arrival_before.distance <= at_before * (1.0 + ROUNDING) {
                    self.arrivals.push((before.end, arrival_before));
                }
                (before, at_before, arrival_before) = (*spoke, at_end, arrival);
            }
            if arrival_before.distance <= at_before * (1.0 + ROUNDING) {
                self.arrivals.push((before.end, arrival_before));
            }
            while let Some((vertex, arrival)) = self.arrivals.pop() {
                self.relax(vertex, arrival);
            }
        }
    }

    #[inline]
    fn relax(&mut self, vertex: u32, arrival: Arrival) {
        let known = self.front.distance(vertex);
        let bend = &mut self.bends[vertex as usize];
        if arrival.distance < known * (1.0 - ROUNDING) {
            self.front.relax(vertex, arrival.distance);
            *bend = arrival.bend;
        } else if arrival.distance <= known * (1.0 + ROUNDING) {
            *bend = bend.min(arrival.bend);
        }
    }
}

/// Whether the front goes on from a vertex.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stop {
    No,
    /// Not from this vertex.
    Here,
    /// Not from this vertex or any that is farther.
    Everywhere,
}

/// A distance that a vertex may have, and the bend of its way.
#[derive(Debug, Clone, Copy)]
struct Arrival {
    distance: f64,
    bend: f64,
}

impl Arrival {
    const NEVER: Self = Self { distance: f64::INFINITY, bend: f64::INFINITY };

    #[inline]
    fn lower(&mut self, other: Self) {
        if other.distance < self.distance * (1.0 - ROUNDING) {
            *self = other;
        } else if other.distance <= self.distance * (1.0 + ROUNDING) {
            self.bend = self.bend.min(other.bend);
        }
    }
}
