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
use nmds::{Reconstruction, Regularization, RpiAlpha, sample_eigenvalues};
use report::results::{CurvesPanel, Mark, Series};

use geodesics::Sampling;

use crate::context::Context;
use crate::specimen::{Distances, Specimen};
use crate::sweep::{
    Measured, error_axis, half, linear, log, median, medians, panel, places, series, share_lowest,
};

/// The error of each run at each of `regularizations`.
fn errors(
    context: &Context<'_>,
    specimen: &Specimen<'_>,
    regularizations: &[Regularization],
) -> Result<Vec<Vec<f64>>> {
    let of = |known: &Reconstruction| -> Result<Vec<f64>> {
        regularizations.iter().map(|r| Ok(known.error(*r)?.mean_square)).collect()
    };
    let firsts = specimen.first_samples(context.config.runs, context.seed);
    firsts.into_iter().map(|first| of(&*specimen.reconstruction(context.config.samples, first)?)).collect()
}

pub(crate) fn rank(context: &Context<'_>) -> Result<()> {
    let (ranks, n) = (&context.config.counts, context.config.samples);
    let (mut panels, mut measured) = (Vec::new(), Measured::new());
    context.observer.begin("figure 5a", context.specimens.len());
    for specimen in context.specimens {
        let curve = |name: &str, regularization: fn(Option<usize>) -> Regularization| -> Result<Series> {
            let all: Vec<_> = ranks.iter().map(|&rank| regularization(Some(rank))).collect();
            Ok(series(name, &places(ranks), &errors(context, specimen, &all)?))
        };
        let low_rank = curve("low rank (eq. 12)", |rank| Regularization::LowRank { rank })?;
        let cur = curve("CUR (eq. 9)", |rank| Regularization::Cur { rank })?;
        let least = |s: &Series| medians(s).into_iter().fold(f64::INFINITY, f64::min);
        let best = low_rank.points.iter().find(|p| p.median == least(&low_rank)).map_or(f64::NAN, |p| p.x);
        let last = low_rank.points.last().map_or(f64::NAN, |p| p.median);
        let good = || low_rank.points.iter().filter(|p| p.median <= 1.5 * least(&low_rank)).map(|p| p.x);
        for (name, value) in [
            ("good from", good().next().unwrap_or(f64::NAN)),
            ("good to", good().next_back().unwrap_or(f64::NAN)),
            ("best rank", best),
            ("best rank over n", best / n as f64),
            ("rise", last / least(&low_rank)),
            ("CUR over low-rank", least(&cur) / least(&low_rank)),
            ("low-rank below CUR", share_lowest(&low_rank, &[&cur])),
        ] {
            measured.insert(format!("{} {name}", specimen.label()), value);
        }
        panels.push(panel(
            specimen.name(),
            linear(&format!("rank n₁ of n = {n} samples")),
            error_axis(),
            vec![low_rank, cur],
        ));
        context.observer.step();
    }
    let caption = format!(
        "Mean squared error of all squared distances reconstructed from {n} farthest samples, against the number of \
         eigenpairs (low rank) or columns (CUR) that are kept. Lines: medians of {} runs that differ in the first sample; \
         bands: range of the runs.",
        context.config.runs
    );
    context.publish_curves(caption, panels, &measured)
}

pub(crate) fn alpha(context: &Context<'_>) -> Result<()> {
    let n = context.config.samples;
    let alphas: Vec<f64> = context.config.exponents.iter().map(|e| 10f64.powf(*e)).collect();
    let (mut panels, mut measured) = (Vec::new(), Measured::new());
    context.observer.begin("figure 5b", context.specimens.len());
    for specimen in context.specimens {
        let relative = |c: &f64| Regularization::Rpi { alpha: RpiAlpha::Relative(*c) };
        let swept: Vec<_> = alphas.iter().map(relative).collect();
        let rpi = series("RPI (eq. 3)", &alphas, &errors(context, specimen, &swept)?);
        let fixed = |name: &str, regularization: Regularization| -> Result<Series> {
            let runs = errors(context, specimen, &[regularization])?;
            let level = |run: &Vec<f64>| vec![run[0]; 2];
            let ends = [alphas[0], alphas[alphas.len() - 1]];
            Ok(series(name, &ends, &runs.iter().map(level).collect::<Vec<_>>()))
        };
        let none = fixed("no regularisation (α = 0)", Regularization::None)?;
        let low_rank = fixed("low rank, n₁ = n / 2", half(n))?;
        let paper = fixed("paper", Regularization::Rpi { alpha: RpiAlpha::Paper })?;
        let ours = fixed("default", Regularization::Rpi { alpha: RpiAlpha::default() })?;
        let level = |s: &Series| s.points[0].median;
        let best = medians(&rpi).into_iter().fold(f64::INFINITY, f64::min);
        let best_alpha = rpi.points.iter().find(|p| p.median == best).map_or(f64::NAN, |p| p.x);
        for (name, value) in [
            ("best alpha", best_alpha),
            ("paper over best", level(&paper) / best),
            ("default over best", level(&ours) / best),
            ("none over best", level(&none) / best),
            ("RPI over low-rank", best / level(&low_rank)),
        ] {
            measured.insert(format!("{} {name}", specimen.label()), value);
        }
        let marks = vec![
            Mark { x: recommended(context, specimen)?, name: "α = σ₁³ (paper)".to_owned() },
            Mark { x: RpiAlpha::default().relative(1.0), name: "10⁻¹⁰ (default)".to_owned() },
        ];
        let plain = panel(specimen.name(), log("α / σ₁⁴", ""), error_axis(), vec![rpi, none, low_rank]);
        panels.push(CurvesPanel { marks, ..plain });
        context.observer.step();
    }
    let caption = format!(
        "Mean squared error of all squared distances reconstructed from {n} farthest samples, against the α of the \
         regularised pseudo-inverse divided by the fourth power of the largest eigenvalue. Lines: medians of {} runs; bands: \
         range of the runs.",
        context.config.runs
    );
    context.publish_curves(caption, panels, &measured)
}

/// The paper's alpha as a multiple of the fourth power of the largest eigenvalue, the median of the runs.
fn recommended(context: &Context<'_>, specimen: &Specimen<'_>) -> Result<f64> {
    let one = |first| -> Result<f64> {
        let counts = [context.config.samples];
        let samples = specimen.nested(&Distances::default(), Sampling::Farthest, first, &counts)?;
        Ok(RpiAlpha::Paper.relative(sample_eigenvalues(&samples[0])?[0].abs()))
    };
    let firsts = specimen.first_samples(context.config.runs, context.seed);
    let values: Vec<f64> = firsts.into_iter().map(one).collect::<Result<_>>()?;
    Ok(median(&values).1)
}
