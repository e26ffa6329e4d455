//! Ways to compare forms.

use std::time::Instant;

use anyhow::Result;
use canonform::form_alignments;
use descriptors::{
    CanonicalForm, FormViews, LaplaceSpectrum, Normalization, PreparedForm, Signature, form_spectrum,
    moment_signature, shape_dna,
};
use linalg::DistanceMatrix;
use rayon::prelude::*;

use super::made::MadeForm;
use crate::context::Context;
use crate::sweep::mean;

/// A way to compare forms.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FormComparison {
    /// [`FormViews`].
    Views,
    /// The distance of aligned forms.
    Aligned,
    /// The spectrum of straight distances.
    Spectrum,
    /// The spectrum of the surface of the form.
    Surface,
    /// The moments of the form.
    Moments,
}

impl FormComparison {
    pub(super) const ALL: [Self; 5] =
        [Self::Views, Self::Aligned, Self::Spectrum, Self::Surface, Self::Moments];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Views => "views",
            Self::Aligned => "alignment",
            Self::Spectrum => "spectrum",
            Self::Surface => "surface",
            Self::Moments => "moments",
        }
    }

    /// The distances between all forms, and the mean seconds of a signature.
    pub(super) fn distances(self, made: &[MadeForm], context: &Context<'_>) -> Result<(DistanceMatrix, f64)> {
        match self {
            Self::Views => {
                let (views, seconds) = each(made, |made| Ok(FormViews::new(&made.form)))?;
                Ok((between(&views, FormViews::distance)?, seconds))
            }
            Self::Aligned => {
                let unit = |made: &MadeForm| made.form.normalized(Normalization::UnitArea);
                let (_, seconds) = each(made, |made| Ok(PreparedForm::new(&unit(made))?))?;
                let forms: Vec<CanonicalForm> = made.iter().map(|made| made.form.clone()).collect();
                Ok((form_alignments(&forms, Normalization::UnitArea, context.observer)?.distances, seconds))
            }
            Self::Spectrum => by_signature(made, |made| Ok(form_spectrum(&made.form)?)),
            Self::Surface => by_signature(made, |made| {
                Ok(shape_dna(&LaplaceSpectrum::describing(&made.mesh.intrinsic(), &())?))
            }),
            Self::Moments => by_signature(made, |made| Ok(moment_signature(&made.form))),
        }
    }
}

fn by_signature(
    made: &[MadeForm],
    signature: impl Fn(&MadeForm) -> Result<Signature> + Sync,
) -> Result<(DistanceMatrix, f64)> {
    let (signatures, seconds) = each(made, signature)?;
    Ok((between(&signatures, Signature::distance)?, seconds))
}

/// A value of every form, and the mean seconds that one takes.
fn each<T: Send>(made: &[MadeForm], work: impl Fn(&MadeForm) -> Result<T> + Sync) -> Result<(Vec<T>, f64)> {
    let one = |made: &MadeForm| {
        let start = Instant::now();
        Ok((work(made)?, start.elapsed().as_secs_f64()))
    };
    let found = made.par_iter().map(one).collect::<Result<Vec<_>>>()?;
    let seconds = mean(found.iter().map(|(_, seconds)| *seconds));
    Ok((found.into_iter().map(|(value, _)| value).collect(), seconds))
}

fn between<T>(all: &[T], distance: impl Fn(&T, &T) -> f64) -> Result<DistanceMatrix> {
    Ok(DistanceMatrix::from_pairs(all.len(), |i, j| distance(&all[i], &all[j]))?)
}
