//! Figure 7: the excess of the stress over that of classical scaling of all pairs, against the number n of samples.
//!
//! Measures, for a class `SHAPE` and `METHOD` in `NMDS`, `no regularisation`, `Landmark MDS`, `SMDS`, `Min-Var`, `BFS`:
//! * `SHAPE METHOD first` and `SHAPE METHOD last`: the excess at the least and the greatest n, as a share of the optimum;
//! * `SHAPE NMDS lowest`: the share of n at which no other method is better;
//! * `SHAPE plateau`: the ratio of the excess of Landmark MDS at the greatest n to that at half of it;
//! * `SHAPE Landmark MDS over NMDS`: the ratio of their excesses at the greatest n.

use anyhow::Result;
use linalg::LandmarkDistances;
use nmds::{
    Embedding, NmdsError, NystromOptions, Regularization, SpectralBasis, SpectralOptions, landmark_mds,
    nystrom, paper_stress, spectral,
};
use report::results::Series;

use crate::context::Context;
use crate::specimen::{DIM, Distances, Specimen};
use crate::sweep::{Measured, half, last, linear, log, panel, share_lowest};

const METHODS: [&str; 6] = ["NMDS", "no regularisation", "Landmark MDS", "SMDS", "BFS", "Min-Var"];

pub(crate) fn run(context: &Context<'_>) -> Result<()> {
    let (mut panels, mut measured) = (Vec::new(), Measured::new());
    context.observer.begin("figure 7", context.specimens.len() * context.config.runs);
    for specimen in context.specimens {
        let curves = excesses(context, specimen)?;
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
    context.publish_curves(caption, panels, &measured)
}

fn note(specimen: &Specimen<'_>, curves: &[Series], measured: &mut Measured) -> Result<()> {
    let label = specimen.label();
    let optimum = specimen.optimum(&Distances::default())?.stress;
    for curve in curves {
        let first = curve.points.first().map_or(f64::NAN, |p| p.median);
        for (end, value) in [("first", first), ("last", last(curve))] {
            measured.insert(format!("{label} {} {end}", curve.name), value / optimum);
        }
    }
    let others: Vec<&Series> = curves[1..].iter().collect();
    measured.insert(format!("{label} NMDS lowest"), share_lowest(&curves[0], &others));
    let (landmark, points) = (last(&curves[2]), &curves[2].points);
    let most = points.last().map_or(f64::NAN, |p| p.x);
    let half = points.iter().rfind(|p| p.x <= most / 2.0).map_or(f64::NAN, |p| p.median);
    measured.insert(format!("{label} plateau"), landmark / half);
    measured.insert(format!("{label} Landmark MDS over NMDS"), landmark / last(&curves[0]));
    Ok(())
}

/// The excess of the stress over the optimum, as a curve for each method.
fn excesses(context: &Context<'_>, specimen: &Specimen<'_>) -> Result<Vec<Series>> {
    let all = specimen.all_pairs(&Distances::default())?;
    let optimum = specimen.optimum(&Distances::default())?.stress;
    let spectrum = specimen.spectrum(context.config.eigenvectors)?;
    let basis =
        SpectralBasis { values: &spectrum.values, vectors: &spectrum.vectors, masses: &spectrum.masses };
    let excess = |embedding: Result<Embedding, NmdsError>| -> Result<f64> {
        Ok(paper_stress(&embedding?.coords, all.as_ref())? - optimum)
    };
    let nmds = |samples: &LandmarkDistances, regularization| {
        excess(nystrom(samples, &NystromOptions { regularization, dim: DIM }))
    };
    let low_rank = |samples: &LandmarkDistances| nmds(samples, half(samples.n_landmarks()));
    let farthest = |samples: &LandmarkDistances| {
        Ok(vec![
            low_rank(samples)?,
            nmds(samples, Regularization::None)?,
            excess(landmark_mds(samples, DIM))?,
            excess(spectral(samples, &basis, &SpectralOptions::default()))?,
        ])
    };
    context.sweep(specimen, &METHODS, farthest, low_rank)
}
