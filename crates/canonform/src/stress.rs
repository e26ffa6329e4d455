//! The stress of an embedding of a surface.

use geodesics::{DistanceSolver, Method};
use linalg::{LandmarkDistances, Matrix};
use nmds::{DistanceRows, estimate_paper_stress, paper_stress, sample_rows};
use serde::Serialize;
use surface::VertexId;

use crate::{EmbedOptions, Observer, StressChoice};

/// Up to this many vertices [`StressChoice::Auto`] is exact.
pub(crate) const EXACT_LIMIT: usize = 5000;

/// Rows an estimate is made from.
pub(crate) const ESTIMATE_ROWS: usize = 100;

/// The paper's stress of an embedding and how it was found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StressReport {
    /// Always `paper_stress`: `‖Z Z' + 1/2 J E J‖_F / p`, in squared mesh units.
    pub measure: &'static str,
    /// Name of the way the distances were measured that the embedding is held against.
    pub geodesic: &'static str,
    /// Its value.
    pub value: f64,
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

/// Rows marched when they are asked for.
struct MarchedRows<'a>(&'a dyn DistanceSolver);

impl DistanceRows for MarchedRows<'_> {
    fn n_points(&self) -> usize {
        self.0.n_vertices()
    }

    fn row_into(&self, i: usize, out: &mut [f64]) {
        self.0.distances_into(VertexId::from(i), out);
    }
}

/// The rows that are known already: those of the landmarks.
pub(crate) struct KnownRows<'a>(pub(crate) &'a LandmarkDistances);

impl DistanceRows for KnownRows<'_> {
    fn n_points(&self) -> usize {
        self.0.n_points()
    }

    fn row_into(&self, i: usize, out: &mut [f64]) {
        let landmark = self.0.landmarks().iter().position(|&l| l == i);
        out.copy_from_slice(self.0.column(landmark.unwrap_or_else(|| unreachable!("row {i} is not known"))));
    }
}

/// The stress of `coords`, found as the options say, against the distances of `solver`, which is the one of
/// `method`.
pub(crate) fn measure(
    coords: &Matrix,
    solver: &dyn DistanceSolver,
    method: Method,
    options: &EmbedOptions,
    observer: &dyn Observer,
) -> StressReport {
    let rows = MarchedRows(solver);
    let exact = match options.stress {
        StressChoice::Auto => rows.n_points() <= EXACT_LIMIT,
        StressChoice::Exact => true,
        StressChoice::Estimate | StressChoice::Skip => false,
    };
    let report = |value, kind, interval| {
        let (measure, geodesic) = ("paper_stress", method.name());
        StressReport { measure, geodesic, value, kind, interval }
    };
    observer.begin("stress", if exact { rows.n_points() } else { ESTIMATE_ROWS });
    if exact {
        let value = paper_stress(coords, &rows);
        report(value, StressKind::Exact, [value; 2])
    } else {
        let sample = sample_rows(rows.n_points(), ESTIMATE_ROWS, options.seed);
        let estimate = estimate_paper_stress(coords, &rows, &sample);
        report(estimate.value, StressKind::Estimated, estimate.interval)
    }
}
