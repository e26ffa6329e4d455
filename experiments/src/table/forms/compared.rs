//! Ways to compare forms.

use std::time::Instant;

use anyhow::Result;
use canonform::form_alignments;
use descriptors::{
    CanonicalForm, FormViews, Normalization, PreparedForm, Signature, geodesic_spectrum, moment_signature,
};
use linalg::{DistanceMatrix, LandmarkDistances, Matrix};
use rayon::prelude::*;

use super::made::MadeForm;
use crate::context::Context;
use crate::sweep::mean;

/// Points of a form from which straight lines are measured.
const LANDMARKS: usize = 100;

/// A way to compare forms.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FormComparison {
    /// [`FormViews`].
    Views,
    /// The distance of aligned forms.
    Aligned,
    /// The spectrum of the lengths of straight lines through the form.
    Spectrum,
    /// The moments of the form.
    Moments,
}

impl FormComparison {
    pub(super) const ALL: [Self; 4] = [Self::Views, Self::Aligned, Self::Spectrum, Self::Moments];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Views => "views",
            Self::Aligned => "alignment",
            Self::Spectrum => "spectrum",
            Self::Moments => "moments",
        }
    }

    /// The distances between all forms, and the mean seconds of a signature.
    pub(super) fn distances(self, made: &[MadeForm], context: &Context<'_>) -> Result<(DistanceMatrix, f64)> {
        let forms: Vec<&CanonicalForm> = made.iter().map(|made| &made.form).collect();
        match self {
            Self::Views => {
                let (views, seconds) = each(&forms, |form| Ok(FormViews::new(form)))?;
                Ok((between(&views, FormViews::distance)?, seconds))
            }
            Self::Aligned => {
                let (_, seconds) =
                    each(&forms, |form| Ok(PreparedForm::new(&form.normalized(Normalization::UnitArea))?))?;
                let forms: Vec<CanonicalForm> = forms.into_iter().cloned().collect();
                Ok((form_alignments(&forms, Normalization::UnitArea, context.observer)?.distances, seconds))
            }
            Self::Spectrum => by_signature(&forms, spectrum),
            Self::Moments => by_signature(&forms, |form| Ok(moment_signature(form))),
        }
    }
}

/// The geodesic spectrum, with straight lines through the form in the place of distances on the surface.
fn spectrum(form: &CanonicalForm) -> Result<Signature> {
    let points = form.points();
    let n = LANDMARKS.min(points.len());
    let columns = Matrix::from_fn(points.len(), n, |i, j| (points[i] - points[j]).norm());
    let lines = LandmarkDistances::new((0..n).collect(), columns)?;
    let area = form.area().unwrap_or_else(|| form.spread().powi(2));
    Ok(geodesic_spectrum(&lines, form.weights(), area)?)
}

fn by_signature(
    forms: &[&CanonicalForm],
    signature: impl Fn(&CanonicalForm) -> Result<Signature> + Sync,
) -> Result<(DistanceMatrix, f64)> {
    let (signatures, seconds) = each(forms, signature)?;
    Ok((between(&signatures, Signature::distance)?, seconds))
}

/// A value of every form, and the mean seconds that one takes.
fn each<T: Send>(
    forms: &[&CanonicalForm],
    work: impl Fn(&CanonicalForm) -> Result<T> + Sync,
) -> Result<(Vec<T>, f64)> {
    let one = |form: &&CanonicalForm| {
        let start = Instant::now();
        Ok((work(form)?, start.elapsed().as_secs_f64()))
    };
    let found = forms.par_iter().map(one).collect::<Result<Vec<_>>>()?;
    let seconds = mean(found.iter().map(|(_, seconds)| *seconds));
    Ok((found.into_iter().map(|(value, _)| value).collect(), seconds))
}

fn between<T>(all: &[T], distance: impl Fn(&T, &T) -> f64) -> Result<DistanceMatrix> {
    Ok(DistanceMatrix::from_pairs(all.len(), |i, j| distance(&all[i], &all[j]))?)
}
