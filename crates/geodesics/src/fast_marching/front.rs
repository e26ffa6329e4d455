//! The front: labels, buckets, and the loop over rounds.
//!
//! The steps of a round are functions that are not inlined: side by side in one function they leave each other too
//! few registers, which takes a tenth more time.

use base::{Budget, Exceeded};

use super::buckets::{Buckets, NOWHERE, Queued};
use super::one_ring::OneRings;
use super::relaxation::{EdgeRelaxation, ROUNDING, Relaxations, Round, TriangleSolver, VertexLabel};
use super::update::Stencil;

/// Limit of the mean number of visits per vertex, after which finalized vertices are no longer corrected. Real
/// surfaces need 1.1 with flipped edges, sheared sheets without flips up to a hundred. Where rounding decides, in
/// triangles without height or with unfolded corners, a few vertices might otherwise lower each other almost forever.
const VISITS_PER_VERTEX: usize = 256;

/// What a relaxation counts for in the meter of a budget.
const OPERATIONS: usize = 8;

#[derive(Debug, Default)]
struct Labels { labels: Vec<VertexLabel>, at: Vec<u32> }
impl Queued for Labels {
    fn distance(&self, v: u32) -> f64 { self.labels[v as usize].distance }
    fn bucket(&mut self, v: u32) -> &mut u32 { &mut self.at[v as usize] }
}
/// A front that advances bucket by bucket, each in one round or a few.
#[derive(Debug, Default)]
pub(super) struct VertexFront {
    labels: Labels,
    buckets: Buckets,
    /// The vertices of a round.
    round: Vec<u32>,
    relaxations: Relaxations,
    solver: TriangleSolver,
}

impl VertexFront {
    /// Prepares for a new run. Allocates only to grow.
    pub(super) fn reset(&mut self, rings: &OneRings) {
        let n = rings.order.len();
        self.labels.labels.clear();
        self.labels.labels.resize(n, VertexLabel::UNREACHED);
        self.labels.at.clear();
        self.labels.at.resize(n, NOWHERE);
        self.buckets.reset(rings.bucket_width, rings.longest);
    }

    /// Puts a vertex at a straight distance from the source into the front.
    pub(super) fn start(&mut self, vertex: u32, distance: f64) {
        lower(&mut self.labels, &mut self.buckets, vertex, VertexLabel { distance, pseudo_source: 0.0 });
    }

    #[inline]
    pub(super) fn distance(&self, vertex: u32) -> f64 {
        self.labels.labels[vertex as usize].distance
    }

    /// Runs until no vertex is left, without continuing from vertices where it `stops` at their distance.
    pub(super) fn run(
        &mut self,
        rings: &OneRings,
        budget: &Budget,
        stops: impl Fn(u32, f64) -> bool,
        update: impl Fn(Stencil, f64, f64) -> f64,
    ) -> Result<(), Exceeded> {
        let Self { labels, buckets, round, relaxations, solver } = self;
        let mut meter = budget.meter();
        let mut visits = VISITS_PER_VERTEX.saturating_mul(labels.labels.len());
        while let Some(finalized) = buckets.next_round(round, labels) {
            visits = visits.saturating_sub(round.len());
            let round = Round { rings, labels: &labels.labels, vertices: round, finalized, corrects: visits > 0 };
            let (edges, triangles) = relaxations.find(round, &stops);
            meter.count(OPERATIONS * (1 + edges.len() + triangles.len()))?;
            solver.solve(triangles, rings, &labels.labels, &update);
            // Triangles first: edges seldom lower what they have lowered.
            for (apex, label) in solver.results() {
                lower(labels, buckets, apex, label);
            }
            for EdgeRelaxation { end, label } in edges {
                lower(labels, buckets, *end, *label);
            }
        }
        budget.check()
    }
}

/// Lowers the label of a vertex, if it is an improvement.
#[inline]
fn lower(labels: &mut Labels, buckets: &mut Buckets, vertex: u32, label: VertexLabel) {
    let known = &mut labels.labels[vertex as usize];
    if label.distance < known.distance * (1.0 - ROUNDING) {
        *known = label;
        buckets.put(vertex, &mut labels.at[vertex as usize], label.distance);
    } else if label.distance <= known.distance * (1.0 + ROUNDING) {
        known.pseudo_source = known.pseudo_source.min(label.pseudo_source);
    }
}
