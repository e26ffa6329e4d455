//! Figure 6: the error of reconstructing all squared distances from n columns, against n.
//!
//! Measures, for a class `SHAPE` and `METHOD` in `NMDS`, `no regularisation`, `BFS`, `Min-Var`: `SHAPE METHOD over best`,
//! the geometric mean over n of the ratio of its error to that of the best projection; `SHAPE NMDS lowest`, the share of n
//! at which no other method except the projection is better.

use anyhow::Result;
use linalg::LandmarkDistances;
use nmds::{Reconstruction, Regularization};
use report::results::Series;

use crate::context::Context;
use crate::specimen::Distances;
use crate::sweep::{Measured, error_axis, half, linear, medians, panel, share_lowest};

const METHODS: [&str; 5] = ["best projection R R⁺E", "NMDS", "no regularisation", "BFS", "Min-Var"];

pub(crate) fn run(context: &Context<'_>) -> Result<()> {
    let (mut panels, mut measured) = (Vec::new(), Measured::new());
    context.observer.begin("figure 6", context.specimens.len() * context.config.runs);
    for specimen in context.specimens {
        let all = specimen.all_pairs(&Distances::default())?;
        let known = |samples: &LandmarkDistances| Reconstruction::new(samples, all.as_ref());
        let farthest = |samples: &LandmarkDistances| {
            let known = known(samples)?;
            let low_rank = known.error(half(samples.n_landmarks()))?;
            let none = known.error(Regularization::None)?;
            Ok(vec![known.best_projection().mean_square, low_rank.mean_square, none.mean_square])
        };
        let low_rank =
            |samples: &LandmarkDistances| Ok(known(samples)?.error(half(samples.n_landmarks()))?.mean_square);
        let curves = context.sweep(specimen, &METHODS, farthest, low_rank)?;
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
    context.publish_curves(caption, panels, &measured)
}
