//! Figures 5a and 5b: the error of reconstructing all squared distances from 100 columns, against the rank and against
//! the alpha of the regularized pseudo-inverse.
//!
//! 5a measures, for a class `SHAPE`:
//! * `SHAPE best rank`, the rank at which the error of the low-rank regularization is least, and `SHAPE best rank over n`;
//! * `SHAPE good from` and `SHAPE good to`, the ends of the ranks at which its error is at most 1.5 times the least;
//! * `SHAPE rise`, the ratio of its error at rank n to the least;
//! * `SHAPE CUR over low-rank`, the ratio of the least error of CUR to that of low rank;
//! * `SHAPE low-rank below CUR`, the share of ranks at which the error of low rank is at most that of CUR.
//!
//! 5b measures `SHAPE paper over best`, `SHAPE default over best` and `SHAPE none over best`, the ratios of the error at
//! the paper's alpha, at our default and without regularization to the least of the curve, and `SHAPE RPI over low-rank`,
//! the ratio of the least of the curve to the error of low rank at half of n, and `SHAPE best alpha`, relative to the fourth
//! power of the largest eigenvalue.

use anyhow::Result;
use geodesics::{Method, Sampling};
use nmds::{Reconstruction, Regularization, RpiAlpha, sample_eigenvalues};
use report::Record;
use report::record::{Axis, Mark, Plot, Series};

use crate::context::Context;
use crate::specimen::Specimen;
use crate::sweep::{error_axis, half, last, least, median, places, plot, series, share_lowest};

/// The error of each run at each of some regularizations.
fn errors(
    context: &Context<'_>,
    specimen: &Specimen<'_>,
    regularizations: &[Regularization],
) -> Result<Vec<Vec<f64>>> {
    let of = |known: &Reconstruction| -> Result<Vec<f64>> {
        regularizations.iter().map(|r| Ok(known.error(*r)?.mean_square)).collect()
    };
    let firsts = specimen.first_samples(context.options.runs, context.seed);
    let samples = context.options.samples;
    firsts.into_iter().map(|first| of(&*specimen.reconstruction(samples, first)?)).collect()
}

pub(crate) fn figure5a(context: &Context<'_>) -> Result<Record> {
    let (n, counts) = (context.options.samples, &context.options.counts);
    context.on_specimens(1, |specimen| {
        let curve = |name: &str, of: fn(Option<usize>) -> Regularization| -> Result<Series> {
            let all: Vec<_> = counts.iter().map(|&rank| of(Some(rank))).collect();
            Ok(series(name, &places(counts), &errors(context, specimen, &all)?))
        };
        let low_rank = curve("low rank (eq. 12)", |rank| Regularization::LowRank { rank })?;
        let cur = curve("CUR (eq. 9)", |rank| Regularization::Cur { rank })?;
        let (best, error) = least(&low_rank);
        let good = || low_rank.points.iter().filter(|p| p.y <= 1.5 * error).map(|p| p.x);
        let numbers = vec![
            ("good from", good().next().unwrap_or(f64::NAN)),
            ("good to", good().next_back().unwrap_or(f64::NAN)),
            ("best rank", best),
            ("best rank over n", best / n as f64),
            ("rise", last(&low_rank) / error),
            ("CUR over low-rank", least(&cur).1 / error),
            ("low-rank below CUR", share_lowest(&low_rank, &[&cur])),
        ];
        let x = Axis::linear(&format!("rank n₁ of n = {n} samples"));
        context.observer.step();
        Ok((plot(&specimen.shape.name, x, error_axis(), vec![low_rank, cur]), numbers))
    })
}

pub(crate) fn figure5b(context: &Context<'_>) -> Result<Record> {
    let alphas: Vec<f64> = context.options.exponents.iter().map(|e| 10f64.powf(*e)).collect();
    let ends = [alphas[0], alphas[alphas.len() - 1]];
    context.on_specimens(1, |specimen| {
        let curve = |name: &str, places: &[f64], of: &[Regularization]| -> Result<Series> {
            Ok(series(name, places, &errors(context, specimen, of)?))
        };
        let fixed = |name: &str, regularization| curve(name, &ends, &[regularization; 2]);
        let relative = |c: &f64| Regularization::Rpi { alpha: RpiAlpha::Relative(*c) };
        let rpi = curve("RPI (eq. 3)", &alphas, &alphas.iter().map(relative).collect::<Vec<_>>())?;
        let none = fixed("no regularization (α = 0)", Regularization::None)?;
        let low_rank = fixed("low rank, n₁ = n / 2", half(context.options.samples))?;
        let paper = fixed("paper", Regularization::Rpi { alpha: RpiAlpha::Paper })?;
        let ours = fixed("default", Regularization::Rpi { alpha: RpiAlpha::default() })?;
        let (best_alpha, best) = least(&rpi);
        let numbers = vec![
            ("best alpha", best_alpha),
            ("paper over best", least(&paper).1 / best),
            ("default over best", least(&ours).1 / best),
            ("none over best", least(&none).1 / best),
            ("RPI over low-rank", best / least(&low_rank).1),
        ];
        let marks = vec![
            Mark { x: recommended(context, specimen)?, name: "α = σ₁³ (paper)".to_owned() },
            Mark { x: RpiAlpha::default().relative(1.0), name: "10⁻¹⁰ (default)".to_owned() },
        ];
        let plain =
            plot(&specimen.shape.name, Axis::log("α / σ₁⁴", ""), error_axis(), vec![rpi, none, low_rank]);
        context.observer.step();
        Ok((Plot { marks, ..plain }, numbers))
    })
}

/// The paper's alpha as a multiple of the fourth power of the largest eigenvalue, the median of the runs.
fn recommended(context: &Context<'_>, specimen: &Specimen<'_>) -> Result<f64> {
    let one = |first| -> Result<f64> {
        let counts = [context.options.samples];
        let samples = specimen.nested(Method::default(), Sampling::Farthest, first, &counts)?;
        Ok(RpiAlpha::Paper.relative(sample_eigenvalues(&samples[0])?[0].abs()))
    };
    let firsts = specimen.first_samples(context.options.runs, context.seed);
    Ok(median(&firsts.into_iter().map(one).collect::<Result<Vec<_>>>()?).1)
}
