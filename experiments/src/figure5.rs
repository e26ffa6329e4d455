//! Figures 5a and 5b: how well 100 columns reconstruct all squared distances, against the rank kept and
//! against the alpha of the regularised pseudo-inverse.
//!
//! 5a measures, for `SHAPE` a class: `SHAPE best rank`, the rank of least error of low rank; `SHAPE best rank over
//! n`; `SHAPE rise`, the error at rank n over the least; `SHAPE CUR over low-rank`, the least error of CUR over that of
//! low rank; `SHAPE low-rank below CUR`, the share of ranks at which low rank is no worse.
//!
//! 5b measures `SHAPE paper over best` and `SHAPE default over best`, the error at the paper's and at our alpha over the
//! least of the curve; `SHAPE none over best`; `SHAPE RPI over low-rank`, the least error over that of half rank.

use std::time::Instant;

use anyhow::Result;
use nmds::{Reconstruction, Regularization, RpiAlpha, sample_eigenvalues};
use report::curves::curves;
use report::results::{AxisScale, CurvesPanel, CurvesRecord, Mark, Series, write};
use report::tables::curves_table;

use geodesics::Sampling;

use crate::run::Context;
use crate::specimen::{Distances, Specimen};
use crate::sweep::{Measured, axis, median, medians, places, series, share_lowest};

/// What the vertical axis shows.
pub(crate) const ERROR: &str = "reconstruction error";

/// The paper's error, in the fourth power of the mesh unit.
pub(crate) const ERROR_UNIT: &str = "mesh units⁴";

/// The error of each run at each of `regularizations`.
fn errors(
    context: &Context<'_>,
    specimen: &Specimen<'_>,
    regularizations: &[Regularization],
) -> Result<Vec<Vec<f64>>> {
    let of = |known: &Reconstruction| -> Result<Vec<f64>> {
        regularizations.iter().map(|r| Ok(known.error(*r)?.mean_square)).collect()
    };
    let firsts = specimen.first_samples(context.config.runs, context.args.seed);
    firsts.into_iter().map(|first| of(&*specimen.reconstruction(context.config.samples, first)?)).collect()
}

/// Writes the record and its picture and prints the medians.
pub(crate) fn finish(
    context: &Context<'_>,
    name: &str,
    start: Instant,
    caption: &str,
    panels: Vec<CurvesPanel>,
    measured: &Measured,
) -> Result<()> {
    let record = CurvesRecord {
        expectations: context.check(|name| measured.get(name).copied())?,
        analysis: context.config.analysis.trim().to_owned(),
        provenance: context.provenance(context.setup(), start.elapsed()),
        caption: caption.to_owned(),
        panels,
    };
    curves(&record, context.output(name))?;
    write(&record, context.output(&format!("{name}.json")))?;
    context.say(&curves_table(&record))
}

/// Runs Figure 5a.
pub(crate) fn rank(context: &Context<'_>) -> Result<()> {
    let start = Instant::now();
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
        for (name, value) in [
            ("best rank", best),
            ("best rank over n", best / n as f64),
            ("rise", last / least(&low_rank)),
            ("CUR over low-rank", least(&cur) / least(&low_rank)),
            ("low-rank below CUR", share_lowest(&low_rank, &[&cur])),
        ] {
            measured.insert(format!("{} {name}", specimen.label()), value);
        }
        panels.push(CurvesPanel {
            title: specimen.name().to_owned(),
            x: axis(&format!("rank n₁ of n = {n} samples"), "", AxisScale::Linear),
            y: axis(ERROR, ERROR_UNIT, AxisScale::Log),
            series: vec![low_rank, cur],
            marks: Vec::new(),
        });
        context.observer.step();
    }
    let caption = format!(
        "Mean squared error of the reconstructed squared distances from {n} farthest samples, by how many eigenpairs \
         (low rank) or columns (CUR) are kept. Lines: medians of {} runs that differ in the first sample; bands: all runs.",
        context.config.runs
    );
    finish(context, "figure5a", start, &caption, panels, &measured)
}

/// Runs Figure 5b.
pub(crate) fn alpha(context: &Context<'_>) -> Result<()> {
    let start = Instant::now();
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
        let half = Regularization::LowRank { rank: Some(n.div_ceil(2)) };
        let low_rank = fixed("low rank, n₁ = n / 2", half)?;
        let paper = fixed("paper", Regularization::Rpi { alpha: RpiAlpha::Paper })?;
        let ours = fixed("default", Regularization::Rpi { alpha: RpiAlpha::default() })?;
        let level = |s: &Series| s.points[0].median;
        let best = medians(&rpi).into_iter().fold(f64::INFINITY, f64::min);
        for (name, value) in [
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
        panels.push(CurvesPanel {
            title: specimen.name().to_owned(),
            x: axis("α / σ₁⁴", "", AxisScale::Log),
            y: axis(ERROR, ERROR_UNIT, AxisScale::Log),
            series: vec![rpi, none, low_rank],
            marks,
        });
        context.observer.step();
    }
    let caption = format!(
        "Mean squared error of the reconstructed squared distances from {n} farthest samples, by the α of the regularised \
         pseudo-inverse, over the fourth power of the largest eigenvalue. Lines: medians of {} runs; bands: all runs.",
        context.config.runs
    );
    finish(context, "figure5b", start, &caption, panels, &measured)
}

/// The paper's alpha without its unit, `1 / σ1`; the median over the runs.
fn recommended(context: &Context<'_>, specimen: &Specimen<'_>) -> Result<f64> {
    let one = |first| -> Result<f64> {
        let counts = [context.config.samples];
        let samples = specimen.nested(&Distances::default(), Sampling::Farthest, first, &counts)?;
        Ok(RpiAlpha::Paper.relative(sample_eigenvalues(&samples[0])?[0].abs()))
    };
    let firsts = specimen.first_samples(context.config.runs, context.args.seed);
    let values: Vec<f64> = firsts.into_iter().map(one).collect::<Result<_>>()?;
    Ok(median(&values).1)
}
