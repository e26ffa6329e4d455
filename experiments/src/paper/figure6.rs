//! Figure 6: the error of reconstructing all squared distances from n columns, against n.
//!
//! Measures, for a class `SHAPE` and `METHOD` in `NMDS`, `no regularization`, `BFS`, `Min-Var`: `SHAPE METHOD over best`,
//! the geometric mean over n of the ratio of its error to that of the best projection; `SHAPE NMDS lowest`, the share of n
//! at which no other method except the projection is better.

use anyhow::Result;
use geodesics::Method;
use linalg::LandmarkDistances;
use nmds::{Reconstruction, Regularization};
use report::Record;
use report::record::{Axis, Series};

use crate::context::Context;
use crate::sweep::{error_axis, half, mean, medians, plot, share_lowest};

const METHODS: [&str; 5] = ["best projection R R⁺E", "NMDS", "no regularization", "BFS", "Min-Var"];

pub(crate) fn figure6(context: &Context<'_>) -> Result<Record> {
    context.on_specimens(context.options.runs, |specimen| {
        let all = specimen.all_pairs(Method::default())?;
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
        let over_best = |other: &Series| {
            let logs = medians(other).into_iter().zip(&best).map(|(error, best)| (error / best).ln());
            (format!("{} over best", other.name), mean(logs).exp())
        };
        let mut numbers: Vec<(String, f64)> = curves[1..].iter().map(over_best).collect();
        let others: Vec<&Series> = curves[2..].iter().collect();
        numbers.push(("NMDS lowest".to_owned(), share_lowest(&curves[1], &others)));
        Ok((plot(&specimen.shape.name, Axis::linear("samples n"), error_axis(), curves), numbers))
    })
}
