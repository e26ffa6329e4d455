//! Figure 6: how well n columns reconstruct all squared distances, against n.
//!
//! Measures, for `SHAPE` a class and `METHOD` in `NMDS`, `no regularisation`, `BFS`, `Min-Var`: `SHAPE METHOD over best`,
//! the geometric mean over n of the error of the method over that of the best projection; `SHAPE NMDS lowest`, the share
//! of n at which no other method but the projection is better.

use std::time::Instant;

use anyhow::Result;
use geodesics::{Sampling, Variance};
use linalg::LandmarkDistances;
use nmds::{Reconstruction, Regularization};
use report::results::{AxisScale, CurvesPanel, Series};
use surface::VertexId;

use crate::figure5::{ERROR, ERROR_UNIT, finish};
use crate::run::Context;
use crate::specimen::{Distances, Specimen};
use crate::sweep::{Measured, axis, medians, places, series, share_lowest};

/// The curves.
const METHODS: [&str; 5] = ["best projection R R⁺E", "NMDS", "no regularisation", "BFS", "Min-Var"];

/// Runs the experiment.
pub(crate) fn run(context: &Context<'_>) -> Result<()> {
    let start = Instant::now();
    let counts = &context.config.counts;
    let (mut panels, mut measured) = (Vec::new(), Measured::new());
    context.observer.begin("figure 6", context.specimens.len() * context.config.runs);
    for specimen in context.specimens {
        let mut runs: Vec<Vec<Vec<f64>>> = vec![Vec::new(); METHODS.len()];
        for first in specimen.first_samples(context.config.runs, context.args.seed) {
            let errors = errors(context, specimen, first)?;
            runs.iter_mut().zip(errors).for_each(|(all, one)| all.push(one));
            context.observer.step();
        }
        let curve = |(name, runs): (&str, &Vec<Vec<f64>>)| series(name, &places(counts), runs);
        let curves: Vec<Series> = METHODS.into_iter().zip(&runs).map(curve).collect();
        let best = medians(&curves[0]);
        for other in &curves[1..] {
            let logs = medians(other).iter().zip(&best).map(|(e, b)| (e / b).ln()).sum::<f64>();
            let mean = (logs / best.len().max(1) as f64).exp();
            measured.insert(format!("{} {} over best", specimen.label(), other.name), mean);
        }
        let others: Vec<&Series> = curves[2..].iter().collect();
        measured.insert(format!("{} NMDS lowest", specimen.label()), share_lowest(&curves[1], &others));
        panels.push(CurvesPanel {
            title: specimen.name().to_owned(),
            x: axis("samples n", "", AxisScale::Linear),
            y: axis(ERROR, ERROR_UNIT, AxisScale::Log),
            series: curves,
            marks: Vec::new(),
        });
    }
    let caption = format!(
        "Mean squared error of the reconstructed squared distances against the number of samples, half of whose eigenpairs \
         NMDS keeps. Lines: medians of {} runs that differ in the first sample; bands: all runs.",
        context.config.runs
    );
    finish(context, "figure6", start, &caption, panels, &measured)
}

/// The errors of one run, `[method][n]`.
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
