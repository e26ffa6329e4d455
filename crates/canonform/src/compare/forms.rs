//! Comparing the forms of many shapes.

use descriptors::{
    Alignment, CanonicalForm, FormMatch, MatchOptions, Normalization, PreparedForm, match_forms,
};
use linalg::{DistanceMatrix, Matrix};
use nmds::{Embedding, classical_full};
use rayon::prelude::*;

use crate::{Error, Observer};

/// Points of every form that are matched with another one.
pub const MATCHED_POINTS: usize = 400;

/// Forms made ready to be matched with each other.
#[derive(Debug)]
pub struct PreparedForms(Vec<PreparedForm>);

impl PreparedForms {
    /// Prepares forms in parallel.
    ///
    /// # Errors
    /// [`Error::Descriptor`].
    pub fn new(forms: &[CanonicalForm], normalization: Normalization) -> Result<Self, Error> {
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

/// How all pairs of forms match.
#[derive(Debug, Clone)]
pub struct FormMatches {
    /// Their distances once aligned.
    pub distances: DistanceMatrix,
    /// For every pair `i < j`, row by row, the motion that takes form `i` onto form `j`, both as they were prepared.
    pub alignments: Vec<Alignment>,
}

/// Aligns all pairs of forms, in parallel; every pair is a step that `observer` hears of.
///
/// # Errors
/// [`Error::Descriptor`], the first in order of the pairs, and [`Error::Linalg`].
pub fn form_matches(
    forms: &PreparedForms,
    options: &MatchOptions,
    observer: &dyn Observer,
) -> Result<FormMatches, Error> {
    let n = forms.len();
    let pairs: Vec<(usize, usize)> = (0..n).flat_map(|i| (i + 1..n).map(move |j| (i, j))).collect();
    observer.begin("alignment", pairs.len());
    let one = |&(i, j): &(usize, usize)| {
        let found = match_forms(&forms.0[i], &forms.0[j], options);
        observer.step();
        found
    };
    let found: Vec<_> = pairs.par_iter().map(one).collect();
    let found: Vec<FormMatch> = found.into_iter().collect::<Result<_, _>>()?;
    let mut next = found.iter();
    let distances = DistanceMatrix::from_pairs(n, |_, _| next.next().map_or(f64::NAN, |m| m.distance))?;
    Ok(FormMatches { distances, alignments: found.iter().map(|m| m.alignment).collect() })
}

/// The distances of all pairs of forms once aligned, in parallel; every pair is a step that
/// `observer` hears of.
///
/// # Errors
/// Those of [`form_matches`].
pub fn form_distances(
    forms: &PreparedForms,
    options: &MatchOptions,
    observer: &dyn Observer,
) -> Result<DistanceMatrix, Error> {
    Ok(form_matches(forms, options, observer)?.distances)
}

/// The two-dimensional map of a matrix of distances by classical scaling, with all its eigenvalues.
///
/// # Errors
/// [`Error::Nmds`].
pub fn map_of(distances: &DistanceMatrix) -> Result<Embedding, Error> {
    Ok(classical_full(distances, 2)?)
}

/// Straight-line distances between the points of an embedding.
///
/// # Errors
/// [`Error::Linalg`] when a coordinate is not finite.
pub fn embedded_distances(coords: &Matrix) -> Result<DistanceMatrix, Error> {
    let distance = |i: usize, j: usize| (coords.row(i) - coords.row(j)).norm();
    Ok(DistanceMatrix::from_pairs(coords.nrows(), distance)?)
}

/// The form of a description, at unit area, made ready to be matched. Where size counts it does so as a number of
/// its own, see [`fuse`](descriptors::fuse), so that a body and its likeness in another size still have forms that match.
///
/// # Errors
/// [`Error::Descriptor`].
pub fn prepare_form(form: &CanonicalForm) -> Result<PreparedForm, Error> {
    Ok(PreparedForm::new(&form.normalized(Normalization::UnitArea), MATCHED_POINTS)?)
}
