//! The stress of an embedding of a surface.

use std::borrow::Borrow;

use budget::Exceeded;
use geodesics::{DistanceSolver, Method};
use linalg::{LandmarkDistances, Matrix};
use nmds::{DistanceRows, StressEstimate, estimate_paper_stress, sample_rows, stress};
use serde::Serialize;
use surface::{VertexId, unit_for};

use crate::observer::Observer;

/// [`StressChoice::Auto`] is exact up to this many vertices.
const EXACT_LIMIT: usize = 5000;

/// Number of rows an estimate is made from.
const ESTIMATE_ROWS: usize = 100;

/// How the stress of an embedding is measured.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StressOptions {
    /// From which distances. Default: [`StressChoice::Auto`].
    pub choice: StressChoice,
    /// How these distances are measured. Default: as those that the embedding was made from. With better ones,
    /// poor distances cannot hide behind their own stress.
    pub against: Option<Method>,
    /// Seed of the rows that an estimate is made from. Default: 0.
    pub seed: u64,
}

/// From which distances a stress is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum StressChoice {
    /// From all pairs up to 5,000 vertices, estimated beyond.
    #[default]
    Auto,
    /// From the distances between all pairs of vertices.
    Exact,
    /// From the distances of 100 vertices to all others.
    Estimate,
    /// Not measured.
    Skip,
}

impl StressChoice {
    /// The vertices whose distances to all others are needed, of `n_vertices`; `None` for all of them.
    pub(super) fn rows(self, n_vertices: usize, seed: u64) -> Option<Vec<usize>> {
        let is_exact = match self {
            Self::Auto => n_vertices <= EXACT_LIMIT,
            Self::Exact => true,
            Self::Estimate | Self::Skip => false,
        };
        (!is_exact).then(|| sample_rows(n_vertices, ESTIMATE_ROWS, seed))
    }
}

/// The paper's stress of an embedding and how it was measured.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StressReport {
    /// Always `paper_stress`: `‖Z Z' + 1/2 J E J‖_F / p`, in squared mesh units.
    pub measure: &'static str,
    /// Name of the method that measured the distances.
    pub geodesic: &'static str,
    /// Its value.
    pub value: f64,
    /// Kruskal's stress `sqrt(sum (d_ij - |z_i - z_j|)^2 / sum d_ij^2)` over the same pairs: the relative error of the
    /// distances, without a unit.
    pub normalized: f64,
    /// Exact or estimated.
    pub kind: StressKind,
    /// A 95 % confidence interval; the value twice when it is exact.
    pub interval: [f64; 2],
}

/// Where a stress comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum StressKind {
    /// All pairs of vertices.
    Exact,
    /// A sample of rows.
    Estimated,
}

impl StressReport {
    /// The stress of `coords` against distances by `method`: of the given rows, or of all.
    pub(super) fn new(
        coords: &Matrix,
        distances: &dyn DistanceRows,
        rows: Option<&[usize]>,
        method: Method,
    ) -> Result<Self, Exceeded> {
        // The fourth powers of very short or very long lengths vanish or overflow.
        let unit = unit_for(coords.amax());
        if unit != 1.0 {
            let distances = ScaledRows { rows: distances, unit };
            let scaled = Self::new(&(coords / unit), &distances, rows, method)?;
            let back = |value: f64| value * unit * unit;
            return Ok(Self { value: back(scaled.value), interval: scaled.interval.map(back), ..scaled });
        }
        let (value, normalized, kind, interval) = match rows {
            None => {
                let found = stress(coords, distances)?;
                (found.paper, found.normalized, StressKind::Exact, [found.paper; 2])
            }
            Some(rows) => {
                let StressEstimate { value, normalized, interval, .. } =
                    estimate_paper_stress(coords, distances, rows)?;
                (value, normalized, StressKind::Estimated, interval)
            }
        };
        Ok(Self { measure: "paper_stress", geodesic: method.name(), value, normalized, kind, interval })
    }
}

/// Rows divided by a unit of length.
struct ScaledRows<'a> {
    rows: &'a dyn DistanceRows,
    unit: f64,
}

impl DistanceRows for ScaledRows<'_> {
    fn n_points(&self) -> usize {
        self.rows.n_points()
    }

    fn row_into(&self, i: usize, out: &mut [f64]) -> Result<(), Exceeded> {
        self.rows.row_into(i, out)?;
        out.iter_mut().for_each(|distance| *distance /= self.unit);
        Ok(())
    }
}

/// Rows that are solved when they are needed.
struct SolvedRows<'a>(&'a dyn DistanceSolver);

impl DistanceRows for SolvedRows<'_> {
    fn n_points(&self) -> usize {
        self.0.n_vertices()
    }

    fn row_into(&self, i: usize, out: &mut [f64]) -> Result<(), Exceeded> {
        self.0.distances_into(VertexId::from(i), out)
    }
}

/// The rows of landmarks, looked up.
pub(super) struct KnownRows<T>(pub(super) T);

impl<T: Borrow<LandmarkDistances> + Sync> DistanceRows for KnownRows<T> {
    fn n_points(&self) -> usize {
        self.0.borrow().n_points()
    }

    fn row_into(&self, i: usize, out: &mut [f64]) -> Result<(), Exceeded> {
        let known = self.0.borrow();
        let landmark = known.landmarks().iter().position(|&l| l == i);
        out.copy_from_slice(known.column(landmark.unwrap_or_else(|| unreachable!("row {i} is not known"))));
        Ok(())
    }
}

/// Measures the stress of `coords` against the distances of `solver`, which belongs to `method`.
pub(super) fn measure(
    coords: &Matrix,
    solver: &dyn DistanceSolver,
    method: Method,
    options: &StressOptions,
    observer: &dyn Observer,
) -> Result<StressReport, Exceeded> {
    let rows = options.choice.rows(solver.n_vertices(), options.seed);
    observer.begin("stress", rows.as_ref().map_or(solver.n_vertices(), Vec::len));
    StressReport::new(coords, &SolvedRows(solver), rows.as_deref(), method)
}
