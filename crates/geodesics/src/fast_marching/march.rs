//! The front on its way over a surface.
//!
//! The loops of a round are functions that are not inlined: side by side in one function they leave each
//! other too few registers, which takes a tenth more time.

use super::bands::Bands;
use super::crossings::{CrossingSolver, Reached};
use super::departures::{Departures, Round, Step};
use super::spokes::Spokes;
use super::update::Sector;

/// Distances that differ by less than this share are equal but for rounding: a correction is not worth
/// another visit, and of two ways the one that bent earlier is taken, whatever their order.
pub(super) const ROUNDING: f64 = 1e-13;

/// Visits that a vertex may get on the average before triangles stop to correct. Over flipped edges real
/// surfaces need 1.1; in triangles without height, where rounding decides, or with unfolded corners, a few
/// vertices may otherwise lower each other almost for ever. Sheared sheets left unflipped need up to a hundred.
const VISITS_PER_VERTEX: usize = 256;

/// A front that goes on band by band, each in one round or a few.
///
/// All vertices of a round find what they may lower before anything is lowered, so the result does not
/// depend on their order.
#[derive(Debug, Default)]
pub(super) struct March {
    reached: Vec<Reached>,
    bands: Bands,
    /// The vertices of a round.
    round: Vec<u32>,
    departures: Departures,
    solver: CrossingSolver,
}

impl March {
    /// Forgets everything, for a front over `spokes`. Allocates only to grow.
    pub(super) fn reset(&mut self, spokes: &Spokes) {
        let n = spokes.order.len();
        self.reached.clear();
        self.reached.resize(n, Reached::NEVER);
        self.bands.reset(n, spokes.band, spokes.longest);
    }

    /// Puts a vertex at a straight distance from the source into the front.
    pub(super) fn start(&mut self, vertex: u32, distance: f64) {
        lower(&mut self.reached, &mut self.bands, vertex, Reached { distance, bend: 0.0 });
    }

    #[inline]
    pub(super) fn distance(&self, vertex: u32) -> f64 {
        self.reached[vertex as usize].distance
    }

    /// Lets the front run until it stops at every vertex where `stops` says so of its distance.
    pub(super) fn run(
        &mut self,
        spokes: &Spokes,
        stops: impl Fn(u32, f64) -> bool,
        update: impl Fn(Sector, f64, f64) -> f64,
    ) {
        let Self { reached, bands, round, departures, solver } = self;
        let mut visits = VISITS_PER_VERTEX.saturating_mul(reached.len());
        while let Some(passed) = bands.next_round(round, |v| reached[v as usize].distance) {
            visits = visits.saturating_sub(round.len());
            let round = Round { spokes, reached, vertices: round, passed, corrects: visits > 0 };
            let (steps, crossings) = departures.find(round, &stops);
            solver.solve(crossings, spokes, reached, &update);
            // Triangles first: what they have lowered is seldom lowered by edges.
            for (apex, found) in solver.found() {
                lower(reached, bands, apex, found);
            }
            for Step { end, reached: found } in steps {
                lower(reached, bands, *end, *found);
            }
        }
    }
}

/// Lowers what is known of a vertex to what was found.
#[inline]
fn lower(reached: &mut [Reached], bands: &mut Bands, vertex: u32, found: Reached) {
    let known = &mut reached[vertex as usize];
    if found.distance < known.distance * (1.0 - ROUNDING) {
        *known = found;
        bands.put(vertex, found.distance);
    } else if found.distance <= known.distance * (1.0 + ROUNDING) {
        known.bend = known.bend.min(found.bend);
    }
}
