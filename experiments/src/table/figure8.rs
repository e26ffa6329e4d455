//! Figure 8: seconds from sampled distances to coordinates, against the number n of samples.
//!
//! Measures, at the greatest n: `RPI over low-rank`, `none over low-rank` and `SMDS over low-rank`, ratios of the times of
//! methods that take turns.

use anyhow::{Context as _, Result};
use geodesics::Sampling;
use linalg::LandmarkDistances;
use nmds::{NystromOptions, Regularization, RpiAlpha, SpectralBasis, SpectralOptions, nystrom, spectral};

use descriptors::LaplaceSpectrum;
use serde::Deserialize;

use crate::context::Context;
use crate::experiment::Experiment;
use crate::specimen::{DIM, Distances};
use crate::sweep::{MeasuredNumbers, curves, half, last, linear, log, panel, places, timed};

const METHODS: [&str; 5] =
    ["NMDS, low rank", "NMDS, no regularisation", "NMDS, RPI", "SMDS", "SMDS, eigenfunctions given"];

/// Runs that compute the eigenfunctions, which take a hundred times as long as anything else.
const BASES: usize = 2;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Figure8Options {
    runs: usize,
    eigenvectors: usize,
    /// Numbers of samples.
    counts: Vec<usize>,
}

impl Experiment for Figure8Options {
    fn run(&self, context: &Context<'_>) -> Result<()> {
        let specimen = context.specimens.first().context("there is no shape to measure")?;
        let surface = specimen.shape.surface.intrinsic();
        context.observer.begin("figure 8", self.runs);
        let first = specimen.first_samples(1, context.seed)[0];
        let sampled = specimen.nested(&Distances::default(), Sampling::Farthest, first, &self.counts)?;
        let spectrum = specimen.spectrum(self.eigenvectors)?;
        let basis =
            SpectralBasis { values: &spectrum.values, vectors: &spectrum.vectors, masses: &spectrum.masses };
        let mut of_basis = f64::INFINITY;
        for _ in 0..BASES {
            let (_, seconds) = timed(|| LaplaceSpectrum::new(surface, self.eigenvectors, &()))?;
            of_basis = of_basis.min(seconds);
        }
        let nmds = |samples: &LandmarkDistances, regularization| -> Result<f64> {
            Ok(timed(|| nystrom(samples, &NystromOptions { regularization, dim: DIM }))?.1)
        };
        let mut runs: Vec<Vec<Vec<f64>>> = vec![Vec::new(); METHODS.len()];
        for _ in 0..self.runs {
            let mut times: Vec<Vec<f64>> = vec![Vec::new(); METHODS.len()];
            for samples in &sampled {
                times[0].push(nmds(samples, half(samples.n_landmarks()))?);
                times[1].push(nmds(samples, Regularization::None)?);
                times[2].push(nmds(samples, Regularization::Rpi { alpha: RpiAlpha::default() })?);
                let (_, seconds) = timed(|| spectral(samples, &basis, &SpectralOptions::default()))?;
                times[3].push(of_basis + seconds);
                times[4].push(seconds);
            }
            runs.iter_mut().zip(times).for_each(|(all, one)| all.push(one));
            context.observer.step();
        }
        let curves = curves(&METHODS, &places(&self.counts), &runs);
        let measured: MeasuredNumbers = [("none", 1), ("RPI", 2), ("SMDS", 3)]
            .into_iter()
            .map(|(name, i)| (format!("{name} over low-rank"), last(&curves[i]) / last(&curves[0])))
            .collect();
        let panels = vec![panel(
            format!("{}, {} vertices", specimen.name(), specimen.n_vertices()),
            linear("samples n"),
            log("time without distances", "seconds"),
            curves,
        )];
        context.publish_curves(panels, context.of_specimens(), &measured)
    }
}
