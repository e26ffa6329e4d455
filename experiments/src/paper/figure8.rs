//! Figure 8: seconds from sampled distances to coordinates, against the number n of samples.
//!
//! Measures, at the greatest n: `RPI over low-rank`, `none over low-rank` and `SMDS over low-rank`, ratios of the times of
//! methods that take turns.

use anyhow::{Context as _, Result};
use descriptors::LaplaceSpectrum;
use geodesics::{Method, Sampling};
use linalg::LandmarkDistances;
use nmds::{Regularization, RpiAlpha, SpectralBasis, nystrom, spectral};
use report::Record;
use report::record::Axis;

use crate::context::Context;
use crate::specimen::DIM;
use crate::sweep::{curves, half, last, places, plot, plots, timed};

const METHODS: [&str; 5] =
    ["NMDS, low rank", "NMDS, no regularization", "NMDS, RPI", "SMDS", "SMDS, eigenfunctions given"];

/// Runs that compute the eigenfunctions, which take a hundred times as long as anything else.
const BASES: usize = 2;

pub(crate) fn figure8(context: &Context<'_>) -> Result<Record> {
    let options = &context.options;
    let specimen = context.specimens.first().context("there is no shape to measure")?;
    let surface = specimen.shape.surface.intrinsic();
    context.observer.begin("figure 8", options.runs);
    let first = specimen.first_samples(1, context.seed)[0];
    let sampled = specimen.nested(Method::default(), Sampling::Farthest, first, &options.counts)?;
    let spectrum = specimen.spectrum(options.eigenvectors)?;
    let basis =
        SpectralBasis { values: &spectrum.values, vectors: &spectrum.vectors, masses: &spectrum.masses };
    let mut of_basis = f64::INFINITY;
    for _ in 0..BASES {
        let (_, seconds) = timed(|| LaplaceSpectrum::new(surface, options.eigenvectors, &()))?;
        of_basis = of_basis.min(seconds);
    }
    let nmds = |samples: &LandmarkDistances, regularization| -> Result<f64> {
        Ok(timed(|| nystrom(samples, regularization, DIM))?.1)
    };
    let mut runs = Vec::new();
    for _ in 0..options.runs {
        let mut run = Vec::new();
        for samples in &sampled {
            let low_rank = nmds(samples, half(samples.n_landmarks()))?;
            let none = nmds(samples, Regularization::None)?;
            let rpi = nmds(samples, Regularization::Rpi { alpha: RpiAlpha::default() })?;
            let (_, smds) = timed(|| spectral(samples, &basis, SpectralBasis::MU, DIM))?;
            run.push(vec![low_rank, none, rpi, of_basis + smds, smds]);
        }
        runs.push(run);
        context.observer.step();
    }
    let curves = curves(&METHODS, &places(&options.counts), &runs);
    let over =
        |(name, i): (&str, usize)| (format!("{name} over low-rank"), last(&curves[i]) / last(&curves[0]));
    let measured = [("none", 1), ("RPI", 2), ("SMDS", 3)].into_iter().map(over).collect();
    let title = format!("{}, {} vertices", specimen.shape.name, specimen.n_vertices());
    let plot = plot(title, Axis::linear("samples n"), Axis::log("time without distances", "seconds"), curves);
    Ok(Record { figures: vec![plots("curves", vec![plot])], ..context.record(&[], measured) })
}
