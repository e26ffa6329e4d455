//! Ways to compare forms.

use std::time::Instant;

use anyhow::Result;
use canonform::compare::form_alignments;
use descriptors::{CanonicalForm, LaplaceSpectrum, Normalization, Signature, shape_dna};
use linalg::DistanceMatrix;
use rayon::prelude::*;

use super::made::MadeForm;
use crate::context::Context;
use crate::sweep::mean;

/// A way to compare forms.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FormComparison {
    /// The distance of aligned forms.
    Aligned,
    /// The spectrum of straight distances: [`descriptors::SampledForm::spectrum`].
    Spectrum,
    /// The spectrum of the surface of the form.
    Surface,
}

impl FormComparison {
    pub(super) const ALL: [Self; 3] = [Self::Aligned, Self::Spectrum, Self::Surface];

    /// Whether forms of any number of dimensions can be compared in this way.
    pub(super) fn any_dimension(self) -> bool {
        self == Self::Spectrum
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Aligned => "alignment",
            Self::Spectrum => "spectrum",
            Self::Surface => "surface",
        }
    }

    /// The distances between all forms, and the mean seconds of a signature.
    pub(super) fn distances(self, made: &[MadeForm], context: &Context<'_>) -> Result<(DistanceMatrix, f64)> {
        match self {
            Self::Aligned => {
                let unit = |made: &MadeForm| Ok(made.solid()?.form.normalized(Normalization::UnitArea));
                let (_, seconds) = each(made, |made| Ok(unit(made)?.prepared()?))?;
                let forms: Vec<CanonicalForm> = made.iter().map(unit).collect::<Result<_>>()?;
                Ok((form_alignments(&forms, Normalization::UnitArea, context.observer)?.distances, seconds))
            }
            Self::Spectrum => by_signature(made, |made| Ok(made.sampled.spectrum(made.unit)?)),
            Self::Surface => by_signature(made, |made| {
                Ok(shape_dna(&LaplaceSpectrum::describing(&made.solid()?.mesh.intrinsic(), &())?))
            }),
        }
    }
}

fn by_signature(
    made: &[MadeForm],
    signature: impl Fn(&MadeForm) -> Result<Signature> + Sync,
) -> Result<(DistanceMatrix, f64)> {
    let (signatures, seconds) = each(made, signature)?;
    let distance = |i: usize, j: usize| signatures[i].distance(&signatures[j]);
    Ok((DistanceMatrix::from_pairs(signatures.len(), distance)?, seconds))
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
