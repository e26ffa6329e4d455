//! Comparing the forms of many shapes.

use descriptors::{CanonicalForm, MatchOptions, Normalization, PreparedForm, match_forms};
use linalg::{DistanceMatrix, Matrix};
use nmds::{Embedding, classical_full};
use rayon::prelude::*;
use retrieval::pairwise_distances;

use crate::{Observer, PipelineError};

/// Points of every form that are matched with another one.
pub const MATCHED_POINTS: usize = 400;

/// Forms made ready to be matched with each other.
#[derive(Debug)]
pub struct PreparedForms(Vec<PreparedForm>);

impl PreparedForms {
    /// Prepares forms in parallel.
    ///
    /// # Errors
    /// [`PipelineError::Descriptor`].
    pub fn new(forms: &[CanonicalForm], normalization: Normalization) -> Result<Self, PipelineError> {
        let prepare =
            |form: &CanonicalForm| PreparedForm::new(&form.normalized(normalization), MATCHED_POINTS);
        Ok(Self(forms.par_iter().map(prepare).collect::<Result<_, _>>()?))
    }

    /// Number of forms.
    #[must_use]
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

/// The distances of all pairs of forms once aligned, in parallel; every pair is a step that
/// `observer` hears of.
///
/// # Errors
/// [`PipelineError::Descriptor`].
pub fn form_distances(
    forms: &PreparedForms,
    options: &MatchOptions,
    observer: &dyn Observer,
) -> Result<DistanceMatrix, PipelineError> {
    let distance = |i: usize, j: usize| Ok(match_forms(&forms.0[i], &forms.0[j], options)?.distance);
    observer.begin("alignment", forms.len() * forms.len().saturating_sub(1) / 2);
    pairwise_distances::<PipelineError>(forms.len(), distance, || observer.step())
}

/// The two-dimensional map of a matrix of distances by classical scaling, with all its eigenvalues.
///
/// # Errors
/// [`PipelineError::Nmds`].
pub fn map_of(distances: &DistanceMatrix) -> Result<Embedding, PipelineError> {
    Ok(classical_full(distances, 2)?)
}

/// Straight-line distances between the points of an embedding.
///
/// # Errors
/// [`PipelineError::Linalg`] when a coordinate is not finite.
pub fn embedded_distances(coords: &Matrix) -> Result<DistanceMatrix, PipelineError> {
    let distance = |i: usize, j: usize| (coords.row(i) - coords.row(j)).norm();
    Ok(DistanceMatrix::from_pairs(coords.nrows(), distance)?)
}
