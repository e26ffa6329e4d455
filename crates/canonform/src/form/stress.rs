//! The stress of an embedding of a surface.

use geodesics::{DistanceSolver, Method};
use linalg::{LandmarkDistances, LinalgError, Matrix};
use nmds::{DistanceRows, RowSample, Stress, estimate_stress, sample_rows};
use serde::Serialize;
use surface::VertexId;

use super::plan::check_memory;
use crate::error::Error;
use base::Observer;
use mesh::Surface;

/// [`StressChoice::Auto`] measures one row for this many samples.
const SAMPLES_PER_ROW: usize = 7;

/// Fewest rows with a useful interval.
const MIN_ROWS: usize = 3;

/// Fewest rows where the interval is what the number of samples was searched for.
const MIN_ROWS_OF_SEARCH: usize = 32;

/// Number of rows of [`StressChoice::Estimate`].
const ESTIMATE_ROWS: usize = 100;

/// As many vertices as methods are compared on by all pairs.
const COMPARED_EXACTLY: usize = 5000;

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
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum StressChoice {
    /// Exactly where the method measures all pairs, else from one row for every 7 samples, at least 3, or 32 with samples
    /// chosen automatically
    ///
    /// So an estimate takes less than a fifth of the time for distances.
    #[default]
    Auto,
    /// From the distances between all pairs of vertices
    Exact,
    /// From the distances of 100 vertices to all others
    Estimate,
    /// Not at all
    Skip,
}

impl StressChoice {
    /// Number of rows that an estimate for a form of `n_samples` samples is made from; `None` for all of them.
    fn n_rows(self, n_vertices: usize, n_samples: usize, searched: bool) -> Option<usize> {
        let n = match self {
            Self::Auto => {
                let fewest = if searched { MIN_ROWS_OF_SEARCH } else { MIN_ROWS };
                (n_samples / SAMPLES_PER_ROW).max(fewest)
            }
            Self::Exact => return None,
            Self::Estimate | Self::Skip => ESTIMATE_ROWS,
        };
        (n < n_vertices).then_some(n)
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
    /// A 95 % confidence interval of `normalized`.
    pub normalized_interval: [f64; 2],
    /// Exact or estimated.
    pub kind: StressKind,
    /// A 95 % confidence interval; the value twice when it is exact.
    pub interval: [f64; 2],
    /// Number of vertices whose distances to all others were used.
    pub rows: usize,
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
    /// The stress of `coords` against distances by `method`, of a sample of their rows.
    fn new(
        coords: &Matrix,
        distances: &dyn DistanceRows,
        sample: &RowSample,
        method: Method,
    ) -> Result<Self, Error> {
        let Stress { value, normalized, interval, normalized_interval, n_rows: rows } =
            estimate_stress(coords, distances, sample)?;
        let kind = match rows == distances.n_points() {
            true => StressKind::Exact,
            false => StressKind::Estimated,
        };
        let (measure, geodesic) = ("paper_stress", method.name());
        Ok(Self { measure, geodesic, value, normalized, normalized_interval, kind, interval, rows })
    }
}

/// Distances that several embeddings of one surface are measured against, all by the same rows.
pub struct SharedStress {
    method: Method,
    distances: Box<dyn DistanceRows>,
    sample: RowSample,
}

impl SharedStress {
    /// Measures the distances: between all pairs of vertices, or from 100 vertices to all others. [`StressChoice::Auto`] takes
    /// all pairs up to 5,000 vertices.
    ///
    /// # Errors
    /// [`Error::TooLarge`], [`Error::Exceeded`] and those of the solver.
    pub fn new(
        surface: &Surface,
        method: Method,
        options: &StressOptions,
        observer: &dyn Observer,
    ) -> Result<Self, Error> {
        let p = surface.mesh().n_vertices();
        let is_exact = match options.choice {
            StressChoice::Auto => p <= COMPARED_EXACTLY,
            StressChoice::Exact => true,
            StressChoice::Estimate | StressChoice::Skip => false,
        };
        check_memory(p, if is_exact { p } else { ESTIMATE_ROWS.min(p) }, &observer.budget())?;
        observer.begin("stress", 1);
        let solver = method.prepare(surface.intrinsic(), observer)?;
        if is_exact {
            let distances = Box::new(solver.distance_matrix()?);
            return Ok(Self { method, distances, sample: RowSample::all(p) });
        }
        let rows = sample_rows(p, ESTIMATE_ROWS, options.seed);
        let sources: Vec<VertexId> = rows.iter().copied().map(VertexId::from).collect();
        let distances = Box::new(LandmarkDistances::new(rows.clone(), solver.distance_columns(&sources)?)?);
        Ok(Self { method, distances, sample: RowSample::from_rows(rows, p) })
    }

    /// The stress of coordinates.
    ///
    /// # Errors
    /// [`Error::Nmds`].
    pub fn measure(&self, coords: &Matrix) -> Result<StressReport, Error> {
        StressReport::new(coords, self.distances.as_ref(), &self.sample, self.method)
    }
}

/// Rows that are solved when they are needed.
pub(super) struct SolvedRows<'a>(pub(super) &'a dyn DistanceSolver);

impl DistanceRows for SolvedRows<'_> {
    fn n_points(&self) -> usize {
        self.0.n_vertices()
    }

    fn row_into(&self, i: usize, out: &mut [f64]) -> Result<(), LinalgError> {
        Ok(self.0.distances_into(VertexId::from(i), out)?)
    }
}

impl StressReport {
    /// The stress of coordinates against distances by `method`, which may be known, or are solved row by row. Distances from the
    /// samples tell what rows are worth measuring; `searched` says whether the number of samples was searched for.
    pub(super) fn against(
        (rows, are_known): (&dyn DistanceRows, bool),
        method: Method,
        coords: &Matrix,
        (samples, searched): (&LandmarkDistances, bool),
        options: &StressOptions,
        observer: &dyn Observer,
    ) -> Result<Self, Error> {
        let p = coords.nrows();
        let n_rows = match options.choice {
            StressChoice::Auto if are_known => None,
            choice => choice.n_rows(p, samples.n_landmarks(), searched),
        };
        observer.begin("stress", if are_known { 0 } else { n_rows.unwrap_or(p) });
        let sample = match n_rows {
            None => RowSample::all(p),
            Some(m) => RowSample::by_landmarks(coords, samples, m, options.seed)?,
        };
        Self::new(coords, rows, &sample, method)
    }
}
