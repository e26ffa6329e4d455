//! Figure 7: the excess of the stress over that of classical scaling of all pairs, against the number n of samples.
//!
//! Measures, for a class `SHAPE` and `METHOD` in `NMDS`, `no regularisation`, `Landmark MDS`, `SMDS`, `Min-Var`, `BFS`:
//! * `SHAPE METHOD first` and `SHAPE METHOD last`: the excess at the least and the greatest n, as a share of the optimum;
//! * `SHAPE NMDS lowest`: the share of n at which no other method is better;
//! * `SHAPE plateau`: the ratio of the excess of Landmark MDS at the greatest n to that at half of it;
//! * `SHAPE Landmark MDS over NMDS`: the ratio of their excesses at the greatest n.

use anyhow::Result;
use geodesics::{Sampling, Variance};
use linalg::LandmarkDistances;
use nmds::{
    Embedding, NmdsError, NystromOptions, Regularization, SpectralBasis, SpectralOptions, landmark_mds,
    nystrom, paper_stress, spectral,
};
use report::results::Series;
use surface::VertexId;

use crate::context::Context;
use crate::specimen::{DIM, Distances, Specimen};
use crate::sweep::{Measured, linear, log, medians, panel, share_lowest};

/// The curves.
const METHODS: [&str; 6] = ["NMDS", "no regularisation", "Landmark MDS", "SMDS", "BFS", "Min-Var"];

/// Runs the experiment.
pub(crate) fn run(context: &Context<'_>, specimens: &[Specimen<'_>]) -> Result<()> {
    let (mut panels, mut measured) = (Vec::new(), Measured::new());
    context.observer.begin("figure 7", specimens.len() * context.config.runs);
    for specimen in specimens {
        let curves = context.sweep(specimen, &METHODS, |first| excesses(context, specimen, first))?;
        note(specimen, &curves, &mut measured)?;
        panels.push(panel(
            specimen.name(),
            linear("samples n"),
            log("stress above classical MDS", "mesh units²"),
            curves,
        ));
    }
    let caption = format!(
        "Stress minus that of classical scaling of all pairs, against the number of samples. Lines: medians of {} runs that \
         differ in the first sample; bands: range of the runs.",
        context.config.runs
    );
    context.publish_curves(specimens, caption, panels, &measured)
}

fn note(specimen: &Specimen<'_>, curves: &[Series], measured: &mut Measured) -> Result<()> {
    let label = specimen.label();
    let optimum = specimen.optimum(&Distances::default())?.stress;
    for curve in curves {
        let values = medians(curve);
        let ends = [("first", values.first()), ("last", values.last())];
        for (end, value) in ends {
            let share = value.copied().unwrap_or(f64::NAN) / optimum;
            measured.insert(format!("{label} {} {end}", curve.name), share);
        }
    }
    let others: Vec<&Series> = curves[1..].iter().collect();
    measured.insert(format!("{label} NMDS lowest"), share_lowest(&curves[0], &others));
    let landmark = &curves[2].points;
    let last = landmark.last().map_or((f64::NAN, f64::NAN), |p| (p.x, p.median));
    let half = landmark.iter().rfind(|p| p.x <= last.0 / 2.0).map_or(f64::NAN, |p| p.median);
    measured.insert(format!("{label} plateau"), last.1 / half);
    let nmds = medians(&curves[0]).last().copied().unwrap_or(f64::NAN);
    measured.insert(format!("{label} Landmark MDS over NMDS"), last.1 / nmds);
    Ok(())
}

/// The excesses of the stress over the optimum in one run, as `[method][n]`.
fn excesses(context: &Context<'_>, specimen: &Specimen<'_>, first: VertexId) -> Result<Vec<Vec<f64>>> {
    let counts = &context.config.counts;
    let all = specimen.all_pairs(&Distances::default())?;
    let optimum = specimen.optimum(&Distances::default())?.stress;
    let spectrum = specimen.spectrum(context.config.eigenvectors)?;
    let basis =
        SpectralBasis { values: &spectrum.values, vectors: &spectrum.vectors, masses: &spectrum.masses };
    let nested = |distances: &Distances, sampling| specimen.nested(distances, sampling, first, counts);
    let excess = |embedding: Result<Embedding, NmdsError>| -> Result<f64> {
        Ok(paper_stress(&embedding?.coords, all.as_ref()) - optimum)
    };
    let nmds = |samples: &LandmarkDistances, regularization| {
        nystrom(samples, &NystromOptions { regularization, dim: DIM })
    };
    let half = |samples: &LandmarkDistances| {
        nmds(samples, Regularization::LowRank { rank: Some(samples.n_landmarks().div_ceil(2)) })
    };
    let mut found: Vec<Vec<f64>> = vec![Vec::new(); METHODS.len()];
    for samples in nested(&Distances::default(), Sampling::Farthest)? {
        found[0].push(excess(half(&samples))?);
        found[1].push(excess(nmds(&samples, Regularization::None))?);
        found[2].push(excess(landmark_mds(&samples, DIM))?);
        found[3].push(excess(spectral(&samples, &basis, &SpectralOptions::default()))?);
    }
    for samples in nested(&Distances::hops(), Sampling::Farthest)? {
        found[4].push(excess(half(&samples))?);
    }
    for samples in nested(&Distances::default(), Sampling::Incremental(Variance::Least))? {
        found[5].push(excess(half(&samples))?);
    }
    Ok(found)
}
