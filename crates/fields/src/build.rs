//! Building a field.

use std::sync::Mutex;

use geodesics::{DistanceSolver, FirstSample, Method, Observed, Sampling};
use linalg::{LandmarkDistances, Matrix};
use surface::VertexId;

use crate::distance_field::{DistanceField, Provenance};
use crate::error::FieldError;
use crate::metric::{ColumnError, LandmarkMetric};
use base::Observer;
use mesh::Surface;

/// How a field is built.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FieldOptions {
    /// How the distances from the landmarks are measured. Default: fast marching. Only [`Method::Exact`] certifies the
    /// intervals.
    pub method: Method,
    /// Number of landmarks, of two bytes per vertex each. Default: 100.
    pub landmarks: usize,
    /// Number of eigenpairs behind the estimates, of two bytes per vertex each. Default: half the landmarks.
    pub rank: Option<usize>,
}

impl Default for FieldOptions {
    fn default() -> Self {
        Self { method: Method::default(), landmarks: 100, rank: None }
    }
}

/// Columns that are exact whatever the method, and that its error is measured on: every so many landmarks, so from a tip of the
/// surface and from places in between.
const EXACT_COLUMNS: usize = 4;

/// The error of a method that counts, over the largest that was found in the exact columns. It widens intervals but changes no
/// estimate.
const SAFETY: f64 = 2.0;

impl DistanceField {
    /// Measures the distances from landmarks, each the farthest from those before it. The result does not depend on the number
    /// of threads.
    ///
    /// # Errors
    /// [`FieldError::Geodesic`] if the surface is not connected or there are no landmarks; [`FieldError::Nmds`] for an impossible rank;
    /// [`FieldError::Exceeded`].
    pub fn build(
        surface: &Surface,
        options: &FieldOptions,
        observer: &dyn Observer,
    ) -> Result<Self, FieldError> {
        let budget = observer.budget();
        let mesh = surface.intrinsic();
        let is_exact = options.method == Method::Exact;
        // Exact distances from the landmarks alone can be measured in parallel.
        let chooser = if is_exact { Method::default() } else { options.method };
        let chooser = chooser.prepare(mesh, observer)?;
        observer.begin("landmarks", options.landmarks);
        let observed = Observed { solver: chooser.as_ref(), observer };
        let sampler = Sampling::Farthest.start(&observed, FirstSample::Farthest, 0)?;
        let approximate = sampler.into_distances(options.landmarks)?;
        let mut landmarks = approximate.landmarks().to_vec();

        let n_exact = if is_exact { landmarks.len() } else { EXACT_COLUMNS.min(landmarks.len()) };
        let spread: Vec<usize> = (0..n_exact).map(|i| i * landmarks.len() / n_exact).collect();
        spread.iter().enumerate().for_each(|(to, from)| landmarks.swap(to, *from));
        let sources: Vec<VertexId> = landmarks[..n_exact].iter().map(|&v| VertexId::from(v)).collect();
        let solver = Method::Exact.prepare(mesh, observer)?;
        observer.begin("exact distances", n_exact);
        let exact = Observed { solver: solver.as_ref(), observer }.distance_columns(&sources)?;
        let (columns, error) = combined(&approximate, &spread, exact)?;
        drop(approximate);
        let distances = LandmarkDistances::new(landmarks, columns)?;
        budget.check()?;

        let rank = options.rank.unwrap_or(distances.n_landmarks().div_ceil(2));
        let metric = LandmarkMetric::new(&distances, n_exact, error, rank)?;
        Ok(Self {
            provenance: Provenance { method: options.method, repair: surface.input.repair },
            metric,
            landmarks: distances.landmarks().iter().map(|&v| VertexId::from(v)).collect(),
            surface: mesh.clone(),
            remap: surface.input.remap.clone(),
            exact: Mutex::default(),
        })
    }
}

/// The exact columns, followed by the other approximate ones, and the error of these. Column i of the exact ones is column
/// `spread[i]` of the others.
fn combined(
    approximate: &LandmarkDistances,
    spread: &[usize],
    exact: Matrix,
) -> Result<(Matrix, ColumnError), FieldError> {
    let n_exact = exact.ncols();
    if n_exact == approximate.n_landmarks() {
        return Ok((exact, ColumnError::NONE));
    }
    let mut error = ColumnError::NONE;
    let mut columns = approximate.to_matrix()?;
    spread.iter().enumerate().for_each(|(to, from)| columns.swap_columns(to, *from));
    for (mut column, exact) in columns.column_iter_mut().zip(exact.column_iter()) {
        for (found, exact) in column.iter().zip(exact.iter()) {
            error.over = error.over.max(SAFETY * (found - exact));
            error.under = error.under.max(SAFETY * (exact - found));
        }
        column.copy_from(&exact);
    }
    Ok((columns, error))
}
