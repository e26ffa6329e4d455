//! Figures 5a and 5b: the error of reconstructing all squared distances from 100 columns, against the rank and against
//! the alpha of the regularised pseudo-inverse.
//!
//! 5a measures, for a class `SHAPE`:
//! * `SHAPE best rank`, the rank at which the error of the low-rank regularisation is least, and `SHAPE best rank over n`;
//! * `SHAPE good from` and `SHAPE good to`, the ends of the ranks at which its error is at most 1.5 times the least;
//! * `SHAPE rise`, the ratio of its error at rank n to the least;
//! * `SHAPE CUR over low-rank`, the ratio of the least error of CUR to that of low rank;
//! * `SHAPE low-rank below CUR`, the share of ranks at which the error of low rank is at most that of CUR.
//!
//! 5b measures `SHAPE paper over best`, `SHAPE default over best` and `SHAPE none over best`, the ratios of the error at
//! the paper's alpha, at our default and without regularisation to the least of the curve, and `SHAPE RPI over low-rank`,
//! the ratio of the least of the curve to the error of low rank at half of n, and `SHAPE best alpha`, relative to the fourth
//! power of the largest eigenvalue.

use anyhow::Result;
use geodesics::Sampling;
use nmds::{Reconstruction, Regularization, RpiAlpha, sample_eigenvalues};
use report::results::{CurvesPanel, Mark, Series};
use serde::Deserialize;

use crate::context::Context;
use crate::experiment::Experiment;
use crate::specimen::{Distances, Specimen};
use crate::sweep::{error_axis, half, least, linear, log, median, panel, places, series, share_lowest};

/// Figure 5a.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RankOptions {
    samples: usize,
    runs: usize,
    /// The ranks.
    counts: Vec<usize>,
}

/// Figure 5b.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct AlphaOptions {
    samples: usize,
    runs: usize,
    /// Decimal logarithms of alpha.
    exponents: Vec<f64>,
}

/// The error of each of some runs at each of some regularisations.
fn errors(
    context: &Context<'_>,
    specimen: &Specimen<'_>,
    [samples, runs]: [usize; 2],
    regularizations: &[Regularization],
) -> Result<Vec<Vec<f64>>> {
    let of = |known: &Reconstruction| -> Result<Vec<f64>> {
        regularizations.iter().map(|r| Ok(known.error(*r)?.mean_square)).collect()
    };
    let firsts = specimen.first_samples(runs, context.seed);
    firsts.into_iter().map(|first| of(&*specimen.reconstruction(samples, first)?)).collect()
}

impl Experiment for RankOptions {
    fn run(&self, context: &Context<'_>) -> Result<()> {
        let n = self.samples;
        context.publish_panels(1, |specimen| {
            let curve = |name: &str, of: fn(Option<usize>) -> Regularization| -> Result<Series> {
                let all: Vec<_> = self.counts.iter().map(|&rank| of(Some(rank))).collect();
                let errors = errors(context, specimen, [n, self.runs], &all)?;
                Ok(series(name, &places(&self.counts), &errors))
            };
            let low_rank = curve("low rank (eq. 12)", |rank| Regularization::LowRank { rank })?;
            let cur = curve("CUR (eq. 9)", |rank| Regularization::Cur { rank })?;
            let (best, error) = least(&low_rank);
            let last = low_rank.points.last().map_or(f64::NAN, |p| p.median);
            let good = || low_rank.points.iter().filter(|p| p.median <= 1.5 * error).map(|p| p.x);
            let numbers = vec![
                ("good from", good().next().unwrap_or(f64::NAN)),
                ("good to", good().next_back().unwrap_or(f64::NAN)),
                ("best rank", best),
                ("best rank over n", best / n as f64),
                ("rise", last / error),
                ("CUR over low-rank", least(&cur).1 / error),
                ("low-rank below CUR", share_lowest(&low_rank, &[&cur])),
            ];
            let x = linear(&format!("rank n₁ of n = {n} samples"));
            context.observer.step();
            Ok((panel(specimen.name(), x, error_axis(), vec![low_rank, cur]), numbers))
        })
    }
}

impl Experiment for AlphaOptions {
    fn run(&self, context: &Context<'_>) -> Result<()> {
        let n = self.samples;
        let alphas: Vec<f64> = self.exponents.iter().map(|e| 10f64.powf(*e)).collect();
        let ends = [alphas[0], alphas[alphas.len() - 1]];
        context.publish_panels(1, |specimen| {
            let errors = |of: &[Regularization]| errors(context, specimen, [n, self.runs], of);
            let relative = |c: &f64| Regularization::Rpi { alpha: RpiAlpha::Relative(*c) };
            let rpi =
                series("RPI (eq. 3)", &alphas, &errors(&alphas.iter().map(relative).collect::<Vec<_>>())?);
            let fixed = |name: &str, regularization| -> Result<Series> {
                Ok(series(name, &ends, &errors(&[regularization; 2])?))
            };
            let none = fixed("no regularisation (α = 0)", Regularization::None)?;
            let low_rank = fixed("low rank, n₁ = n / 2", half(n))?;
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
                Mark { x: self.recommended(context, specimen)?, name: "α = σ₁³ (paper)".to_owned() },
                Mark { x: RpiAlpha::default().relative(1.0), name: "10⁻¹⁰ (default)".to_owned() },
            ];
            let plain = panel(specimen.name(), log("α / σ₁⁴", ""), error_axis(), vec![rpi, none, low_rank]);
            context.observer.step();
            Ok((CurvesPanel { marks, ..plain }, numbers))
        })
    }
}

impl AlphaOptions {
    /// The paper's alpha as a multiple of the fourth power of the largest eigenvalue, the median of the runs.
    fn recommended(&self, context: &Context<'_>, specimen: &Specimen<'_>) -> Result<f64> {
        let one = |first| -> Result<f64> {
            let counts = [self.samples];
            let samples = specimen.nested(&Distances::default(), Sampling::Farthest, first, &counts)?;
            Ok(RpiAlpha::Paper.relative(sample_eigenvalues(&samples[0])?[0].abs()))
        };
        let firsts = specimen.first_samples(self.runs, context.seed);
        let values: Vec<f64> = firsts.into_iter().map(one).collect::<Result<_>>()?;
        Ok(median(&values).1)
    }
}
