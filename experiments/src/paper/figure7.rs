//! Figure 7: the excess of the stress over that of classical scaling of all pairs, against the number n of samples.
//!
//! Measures, for a class `SHAPE` and `METHOD` in `NMDS`, `no regularization`, `Landmark MDS`, `SMDS`, `Min-Var`, `BFS`:
//! * `SHAPE METHOD last`: the excess at the greatest n, as a share of the optimum;
//! * `SHAPE NMDS lowest`: the share of n at which no other method is better;
//! * `SHAPE plateau`: the ratio of the excess of Landmark MDS at the greatest n to that at half of it;
//! * `SHAPE Landmark MDS over NMDS`: the ratio of their excesses at the greatest n.

use anyhow::Result;
use geodesics::Method;
use linalg::LandmarkDistances;
use nmds::{
    Embedding, NmdsError, Regularization, SpectralBasis, landmark_mds, nystrom, paper_stress, spectral,
};
use report::Record;
use report::record::{Axis, Series};

use crate::context::Context;
use crate::specimen::{DIM, Specimen};
use crate::sweep::{half, last, plot, share_lowest};

const METHODS: [&str; 6] = ["NMDS", "no regularization", "Landmark MDS", "SMDS", "BFS", "Min-Var"];

pub(crate) fn figure7(context: &Context<'_>) -> Result<Record> {
    context.on_specimens(context.options.runs, |specimen| {
        let curves = excesses(context, specimen)?;
        let optimum = specimen.optimum(Method::default())?.stress;
        let of_last = |curve: &Series| (format!("{} last", curve.name), last(curve) / optimum);
        let mut numbers: Vec<(String, f64)> = curves.iter().map(of_last).collect();
        let others: Vec<&Series> = curves[1..].iter().collect();
        let (landmark, points) = (last(&curves[2]), &curves[2].points);
        let most = points.last().map_or(f64::NAN, |p| p.x);
        let half = points.iter().rfind(|p| p.x <= most / 2.0).map_or(f64::NAN, |p| p.y);
        numbers.push(("NMDS lowest".to_owned(), share_lowest(&curves[0], &others)));
        numbers.push(("plateau".to_owned(), landmark / half));
        numbers.push(("Landmark MDS over NMDS".to_owned(), landmark / last(&curves[0])));
        let y = Axis::log("stress above classical MDS", "mesh units²");
        Ok((plot(&specimen.shape.name, Axis::linear("samples n"), y, curves), numbers))
    })
}

/// The excess of the stress over the optimum, as a curve for each method.
fn excesses(context: &Context<'_>, specimen: &Specimen<'_>) -> Result<Vec<Series>> {
    let all = specimen.all_pairs(Method::default())?;
    let optimum = specimen.optimum(Method::default())?.stress;
    let spectrum = specimen.spectrum(context.options.eigenvectors)?;
    let basis =
        SpectralBasis { values: &spectrum.values, vectors: &spectrum.vectors, masses: &spectrum.masses };
    let excess = |embedding: Result<Embedding, NmdsError>| -> Result<f64> {
        Ok(paper_stress(&embedding?.coords, all.as_ref())? - optimum)
    };
    let nmds = |samples: &LandmarkDistances, regularization| excess(nystrom(samples, regularization, DIM));
    let low_rank = |samples: &LandmarkDistances| nmds(samples, half(samples.n_landmarks()));
    let farthest = |samples: &LandmarkDistances| {
        Ok(vec![
            low_rank(samples)?,
            nmds(samples, Regularization::None)?,
            excess(landmark_mds(samples, DIM))?,
            excess(spectral(samples, &basis, SpectralBasis::MU, DIM))?,
        ])
    };
    context.sweep(specimen, &METHODS, farthest, low_rank)
}
