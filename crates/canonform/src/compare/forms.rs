//! Distances between the forms of a collection.

use descriptors::{CanonicalForm, Normalization};
use linalg::{DistanceMatrix, Matrix};
use rayon::prelude::*;
use rigid::{Reflections, align_points};

use crate::error::Error;
use base::Observer;

/// Aligns all pairs of forms, in parallel: the root mean square distances between aligned forms. `observer` counts every pair as
/// a step.
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
/// let distances = form_alignments(&forms, Normalization::UnitArea, &())?;
/// assert!(distances.get(0, 1) < 0.1 * distances.get(0, 2), "folding does not change the form");
/// # Ok::<(), canonform::Error>(())
/// ```
///
/// # Errors
/// [`Error::Descriptor`].
pub fn form_alignments(
    forms: &[CanonicalForm],
    normalization: Normalization,
    observer: &dyn Observer,
) -> Result<DistanceMatrix, Error> {
    let prepare = |form: &CanonicalForm| form.normalized(normalization).prepared();
    let forms: Vec<_> = forms.par_iter().map(prepare).collect::<Result<_, _>>()?;
    observer.begin("alignment", forms.len() * forms.len().saturating_sub(1) / 2);
    let distance = |i: usize, j: usize| {
        observer.step();
        align_points(&forms[i], &forms[j], Reflections::Allow).gap.rms
    };
    Ok(DistanceMatrix::from_pairs(forms.len(), distance)?)
}

/// Straight-line distances between the points of an embedding.
///
/// # Errors
/// [`Error::Linalg`] if a coordinate is not finite.
pub fn embedded_distances(coords: &Matrix) -> Result<DistanceMatrix, Error> {
    let distance = |i: usize, j: usize| (coords.row(i) - coords.row(j)).norm();
    Ok(DistanceMatrix::from_pairs(coords.nrows(), distance)?)
}
