//! Distances between the forms of a collection.

use descriptors::{
    Alignment, CanonicalForm, FormMatch, MatchOptions, Normalization, PreparedForm, ShapeMetric, match_forms,
};
use linalg::{DistanceMatrix, Matrix};
use nmds::{Embedding, classical_full};
use rayon::prelude::*;

use crate::{Error, Observer};

/// Forms prepared to be matched with each other.
#[derive(Debug)]
pub struct PreparedForms(Vec<PreparedForm>);

impl PreparedForms {
    /// Prepares forms in parallel.
    ///
    /// # Errors
    /// [`Error::Descriptor`].
    pub fn new(forms: &[CanonicalForm], normalization: Normalization) -> Result<Self, Error> {
        let prepare = |form: &CanonicalForm| {
            PreparedForm::new(&form.normalized(normalization), ShapeMetric::MATCHED_POINTS)
        };
        Ok(Self(forms.par_iter().map(prepare).collect::<Result<_, _>>()?))
    }
}

/// The alignments of all pairs of forms.
#[derive(Debug, Clone)]
pub struct FormMatches {
    /// Distances between the aligned forms.
    pub distances: DistanceMatrix,
    /// For every pair `i < j`, row by row, the motion that takes form `i` onto form `j`, both as they were prepared.
    pub alignments: Vec<Alignment>,
}

/// Aligns all pairs of forms, in parallel. `observer` counts every pair as a step.
///
/// ```
/// use canonform::descriptors::{MatchOptions, Normalization};
/// use canonform::{FormOptions, PreparedForms, Surface, embed, form_matches, mesh::shapes};
///
/// let sheet = shapes::grid(21, 17, 0.1);
/// let forms = [&sheet, &shapes::fold(&sheet, 0.8, 1.2), &shapes::icosphere(3)].map(|mesh| {
///     let surface = Surface::new(mesh, &Default::default()).unwrap();
///     embed(&surface, &FormOptions::default(), &()).unwrap().form(&surface).unwrap()
/// });
/// let prepared = PreparedForms::new(&forms, Normalization::UnitArea)?;
/// let found = form_matches(&prepared, &MatchOptions::default(), &())?;
/// assert!(found.distances.get(0, 1) < 0.1 * found.distances.get(0, 2), "folding does not change the form");
/// # Ok::<(), canonform::Error>(())
/// ```
///
/// # Errors
/// [`Error::Descriptor`], for the first pair that fails, and [`Error::Linalg`].
pub fn form_matches(
    forms: &PreparedForms,
    options: &MatchOptions,
    observer: &dyn Observer,
) -> Result<FormMatches, Error> {
    let n = forms.0.len();
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

/// The distances between all pairs of aligned forms. As [`form_matches`].
///
/// # Errors
/// As [`form_matches`].
pub fn form_distances(
    forms: &PreparedForms,
    options: &MatchOptions,
    observer: &dyn Observer,
) -> Result<DistanceMatrix, Error> {
    Ok(form_matches(forms, options, observer)?.distances)
}

/// The two-dimensional map of a matrix of distances by classical scaling, with all eigenvalues.
///
/// # Errors
/// [`Error::Nmds`].
pub fn map_of(distances: &DistanceMatrix) -> Result<Embedding, Error> {
    Ok(classical_full(distances, 2)?)
}

/// Straight-line distances between the points of an embedding.
///
/// # Errors
/// [`Error::Linalg`] if a coordinate is not finite.
pub fn embedded_distances(coords: &Matrix) -> Result<DistanceMatrix, Error> {
    let distance = |i: usize, j: usize| (coords.row(i) - coords.row(j)).norm();
    Ok(DistanceMatrix::from_pairs(coords.nrows(), distance)?)
}
