//! Figure 8: seconds from sampled distances to coordinates, against n.
//!
//! Measures, all at the greatest n: `RPI over low-rank`, `none over low-rank` and `SMDS over low-rank`, ratios of
//! the times of methods that ran in turn.

use std::time::Instant;

use anyhow::{Context as _, Result};
use geodesics::Sampling;
use linalg::LandmarkDistances;
use nmds::{NystromOptions, Regularization, RpiAlpha, SpectralBasis, SpectralOptions, nystrom, spectral};
use report::results::{AxisScale, CurvesPanel};

use descriptors::LaplaceSpectrum;

use crate::figure5::finish;
use crate::run::Context;
use crate::specimen::{DIM, Distances};
use crate::sweep::{Measured, axis, medians, places, series};

/// The curves.
const METHODS: [&str; 5] =
    ["NMDS, low rank", "NMDS, no regularisation", "NMDS, RPI", "SMDS", "SMDS, eigenfunctions given"];

/// The eigenfunctions are found only this often: they take a hundred times as long as anything else.
const BASES: usize = 2;

/// Runs the experiment.
pub(crate) fn run(context: &Context<'_>) -> Result<()> {
    let start = Instant::now();
    let config = &context.config;
    let specimen = context.specimens.first().context("there is no shape to measure")?;
    let surface = &specimen.shape.surface.intrinsic;
    context.observer.begin("figure 8", config.runs);
    let first = specimen.first_samples(1, context.args.seed)[0];
    let sampled = specimen.nested(&Distances::default(), Sampling::Farthest, first, &config.counts)?;
    let spectrum = specimen.spectrum(config.eigenvectors)?;
    let basis =
        SpectralBasis { values: &spectrum.values, vectors: &spectrum.vectors, masses: &spectrum.masses };
    let mut of_basis = f64::INFINITY;
    for _ in 0..BASES {
        let begun = Instant::now();
        LaplaceSpectrum::new(surface, config.eigenvectors)?;
        of_basis = of_basis.min(begun.elapsed().as_secs_f64());
    }
    let nmds = |samples: &LandmarkDistances, regularization| -> Result<f64> {
        let begun = Instant::now();
        nystrom(samples, &NystromOptions { regularization, dim: DIM })?;
        Ok(begun.elapsed().as_secs_f64())
    };
    let mut runs: Vec<Vec<Vec<f64>>> = vec![Vec::new(); METHODS.len()];
    for _ in 0..config.runs {
        let mut times: Vec<Vec<f64>> = vec![Vec::new(); METHODS.len()];
        for samples in &sampled {
            let half = Regularization::LowRank { rank: Some(samples.n_landmarks().div_ceil(2)) };
            times[0].push(nmds(samples, half)?);
            times[1].push(nmds(samples, Regularization::None)?);
            times[2].push(nmds(samples, Regularization::Rpi { alpha: RpiAlpha::default() })?);
            let begun = Instant::now();
            spectral(samples, &basis, &SpectralOptions::default())?;
            let seconds = begun.elapsed().as_secs_f64();
            times[3].push(of_basis + seconds);
            times[4].push(seconds);
        }
        runs.iter_mut().zip(times).for_each(|(all, one)| all.push(one));
        context.observer.step();
    }
    let curves: Vec<_> = METHODS
        .into_iter()
        .zip(&runs)
        .map(|(name, runs)| series(name, &places(&config.counts), runs))
        .collect();
    let last = |i: usize| medians(&curves[i]).last().copied().unwrap_or(f64::NAN);
    let measured: Measured = [("none", 1), ("RPI", 2), ("SMDS", 3)]
        .into_iter()
        .map(|(name, i)| (format!("{name} over low-rank"), last(i) / last(0)))
        .collect();
    let panels = vec![CurvesPanel {
        title: format!("{}, {} vertices", specimen.name(), specimen.n_vertices()),
        x: axis("samples n", "", AxisScale::Linear),
        y: axis("time without distances", "seconds", AxisScale::Log),
        series: curves,
        marks: Vec::new(),
    }];
    let caption = format!(
        "Wall-clock seconds from the distances of the samples to the coordinates. SMDS takes {} eigenfunctions of the surface. Lines: medians of {} runs, the methods in turn; \
         bands: all runs.",
        config.eigenvectors, config.runs
    );
    finish(context, "figure8", start, &caption, panels, &measured)
}
