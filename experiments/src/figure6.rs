//! Figure 6: the error of reconstructing all squared distances from n columns, against n.
//!
//! Measures, for a class `SHAPE` and `METHOD` in `NMDS`, `no regularisation`, `BFS`, `Min-Var`: `SHAPE METHOD over best`,
//! the geometric mean over n of the ratio of its error to that of the best projection; `SHAPE NMDS lowest`, the share of n
//! at which no other method except the projection is better.

use anyhow::Result;
use geodesics::{Sampling, Variance};
use linalg::LandmarkDistances;
use nmds::{Reconstruction, Regularization};
use report::results::Series;
use surface::VertexId;

use crate::context::Context;
use crate::specimen::{Distances, Specimen};
use crate::sweep::{Measured, error_axis, linear, medians, panel, share_lowest};

/// The curves.
const METHODS: [&str; 5] = ["best projection R R⁺E", "NMDS", "no regularisation", "BFS", "Min-Var"];

/// Runs the experiment.
pub(crate) fn run(context: &Context<'_>, specimens: &[Specimen<'_>]) -> Result<()> {
    let (mut panels, mut measured) = (Vec::new(), Measured::new());
    context.observer.begin("figure 6", specimens.len() * context.config.runs);
    for specimen in specimens {
        let curves = context.sweep(specimen, &METHODS, |first| errors(context, specimen, first))?;
        let best = medians(&curves[0]);
        for other in &curves[1..] {
            let logs = medians(other).iter().zip(&best).map(|(e, b)| (e / b).ln()).sum::<f64>();
            let mean = (logs / best.len().max(1) as f64).exp();
            measured.insert(format!("{} {} over best", specimen.label(), other.name), mean);
        }
        let others: Vec<&Series> = curves[2..].iter().collect();
        measured.insert(format!("{} NMDS lowest", specimen.label()), share_lowest(&curves[1], &others));
        panels.push(panel(specimen.name(), linear("samples n"), error_axis(), curves));
    }
    let caption = format!(
        "Mean squared error of all squared distances reconstructed from n samples; NMDS keeps n/2 eigenpairs. Lines: medians \
         of {} runs that differ in the first sample; bands: range of the runs.",
        context.config.runs
    );
    context.publish_curves(specimens, caption, panels, &measured)
}

/// The errors of one run as `[method][n]`.
fn errors(context: &Context<'_>, specimen: &Specimen<'_>, first: VertexId) -> Result<Vec<Vec<f64>>> {
    let counts = &context.config.counts;
    let all = specimen.all_pairs(&Distances::default())?;
    let nested = |distances: &Distances, sampling| specimen.nested(distances, sampling, first, counts);
    let known = |samples: &LandmarkDistances| Reconstruction::new(samples, all.as_ref());
    let half = |n: usize| Regularization::LowRank { rank: Some(n.div_ceil(2)) };
    let mut found: Vec<Vec<f64>> = vec![Vec::new(); METHODS.len()];
    for samples in nested(&Distances::default(), Sampling::Farthest)? {
        let known = known(&samples)?;
        found[0].push(known.best_projection().mean_square);
        found[1].push(known.error(half(samples.n_landmarks()))?.mean_square);
        found[2].push(known.error(Regularization::None)?.mean_square);
    }
    for samples in nested(&Distances::hops(), Sampling::Farthest)? {
        found[3].push(known(&samples)?.error(half(samples.n_landmarks()))?.mean_square);
    }
    for samples in nested(&Distances::default(), Sampling::Incremental(Variance::Least))? {
        found[4].push(known(&samples)?.error(half(samples.n_landmarks()))?.mean_square);
    }
    Ok(found)
}
