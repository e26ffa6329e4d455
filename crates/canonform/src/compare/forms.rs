//! Distances between the forms of a collection.

use descriptors::{CanonicalForm, Normalization};
use linalg::{DistanceMatrix, Matrix};
use rayon::prelude::*;
use rigid::{Reflections, Similarity, align_points};

use crate::error::Error;
use base::Observer;

/// The alignments of all pairs of forms.
#[derive(Debug, Clone)]
pub struct FormAlignments {
    /// Root mean square distances between the aligned forms.
    pub distances: DistanceMatrix,
    /// For every pair `i < j`, row by row, the motion that takes form `i` onto form `j`, both scaled as was chosen.
    pub alignments: Vec<Similarity>,
}

/// Aligns all pairs of forms, in parallel. `observer` counts every pair as a step.
///
/// ```
/// use canonform::descriptors::Normalization;
/// use canonform::Surface;
/// use canonform::compare::form_alignments;
/// use canonform::embed::{FormOptions, embed};
/// use canonform::mesh::shapes;
///
/// let sheet = shapes::grid(21, 17, 0.1);
/// let forms = [&sheet, &shapes::fold(&sheet, 0.8, 1.2), &shapes::icosphere(3)].map(|mesh| {
///     let surface = Surface::new(mesh, &Default::default(), &()).unwrap();
///     embed(&surface, &FormOptions::default(), &()).unwrap().form(&surface).unwrap()
/// });
/// let found = form_alignments(&forms, Normalization::UnitArea, &())?;
/// assert!(found.distances.get(0, 1) < 0.1 * found.distances.get(0, 2), "folding does not change the form");
/// # Ok::<(), canonform::Error>(())
/// ```
///
/// # Errors
/// [`Error::Descriptor`].
pub fn form_alignments(
    forms: &[CanonicalForm],
    normalization: Normalization,
    observer: &dyn Observer,
) -> Result<FormAlignments, Error> {
    let prepare = |form: &CanonicalForm| form.normalized(normalization).prepared();
    let forms: Vec<_> = forms.par_iter().map(prepare).collect::<Result<_, _>>()?;
    let n = forms.len();
    let pairs: Vec<(usize, usize)> = (0..n).flat_map(|i| (i + 1..n).map(move |j| (i, j))).collect();
    observer.begin("alignment", pairs.len());
    let one = |&(i, j): &(usize, usize)| {
        let found = align_points(&forms[i], &forms[j], Reflections::Allow);
        observer.step();
        found
    };
    let found: Vec<_> = pairs.par_iter().map(one).collect();
    let mut next = found.iter();
    let distances = DistanceMatrix::from_pairs(n, |_, _| next.next().map_or(f64::NAN, |m| m.gap.rms))?;
    Ok(FormAlignments { distances, alignments: found.iter().map(|m| m.map).collect() })
}

/// Straight-line distances between the points of an embedding.
///
/// # Errors
/// [`Error::Linalg`] if a coordinate is not finite.
pub fn embedded_distances(coords: &Matrix) -> Result<DistanceMatrix, Error> {
    let distance = |i: usize, j: usize| (coords.row(i) - coords.row(j)).norm();
    Ok(DistanceMatrix::from_pairs(coords.nrows(), distance)?)
}
