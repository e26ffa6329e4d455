//! Figure 3: canonical forms of two shapes by several methods, and their stress.
//!
//! Measures, for `DISTANCES` in `default`, `planar`, `point-source` (the last two ignore obtuse triangles), a class
//! `SHAPE` and `METHOD` in `MDS`, `NMDS`, `SMDS`, `Min-Var`, `BFS`:
//! * `DISTANCES SHAPE METHOD`: the ratio of the median stress to that of MDS with the same distances (1 for MDS);
//! * `DISTANCES SHAPE METHOD off paper`: the relative difference of the median stress from that printed in the paper;
//! * `DISTANCES SHAPE A below B`: the ratio of the median stress of `B` to that of `A`.

use anyhow::Result;
use descriptors::{CanonicalForm, PreparedForm, Reflections, match_forms};
use geodesics::{FastMarchingOptions, Method, ObtuseTreatment, Sampling, Update, Variance};
use linalg::LandmarkDistances;
use mesh::{TriMesh, orient_consistently};
use nmds::{
    Embedding, NystromOptions, Regularization, SpectralBasis, SpectralOptions, nystrom, paper_stress,
    spectral,
};
use report::figure3::{Figure3Surfaces, figure3};
use report::results::{Figure3Form, Figure3Record, Figure3Shape, Figure3Stress};
use surface::VertexId;
use view::render::View;

use crate::context::Context;
use crate::specimen::{DIM, Distances, Specimen};
use crate::sweep::{Measured, median, point};

/// The methods in the order of the paper.
const METHODS: [&str; 5] = ["MDS", "NMDS", "SMDS", "Min-Var", "BFS"];

/// The embedding and the stress of every run of one method on one shape.
type Runs = Vec<(Embedding, f64)>;

/// Our default, and two variants of fast marching that leave obtuse triangles as they are.
fn settings() -> [Distances; 3] {
    let plain = |name, update| {
        let options = FastMarchingOptions { update, obtuse: ObtuseTreatment::Ignore };
        Distances { name, method: Method::FastMarching(options) }
    };
    [Distances::default(), plain("planar", Update::Planar), plain("point-source", Update::PointSource)]
}

/// Runs the experiment.
pub(crate) fn run(context: &Context<'_>, specimens: &[Specimen<'_>]) -> Result<()> {
    let settings = settings();
    context.observer.begin("figure 3", settings.len() * specimens.len());
    let (mut stresses, mut measured, mut shown) = (Vec::new(), Measured::new(), Vec::new());
    for distances in &settings {
        for specimen in specimens {
            let methods = embeddings(context, specimen, distances)?;
            note(context, specimen, distances, &methods, &mut stresses, &mut measured);
            if distances.name == Distances::default().name {
                shown.push(pictured(context, specimen, &methods)?);
            }
            context.observer.step();
        }
    }
    let record = Figure3Record {
        expectations: context.check(|name| measured.get(name).copied())?,
        analysis: context.analysis(),
        provenance: context.provenance(context.setup(specimens)),
        shapes: shown.iter().map(|row| row.facts.clone()).collect(),
        stresses,
    };
    let rows: Vec<_> = shown
        .iter()
        .map(|row| Figure3Surfaces { facts: &row.facts, shape: &row.shape, forms: &row.forms })
        .collect();
    figure3(&rows, &View::default())?.save(context.folder.join(context.name))?;
    context.publish(&record)
}

/// All runs of all methods, in the order of [`METHODS`].
fn embeddings(context: &Context<'_>, specimen: &Specimen<'_>, distances: &Distances) -> Result<Vec<Runs>> {
    let config = &context.config;
    let all = specimen.all_pairs(distances)?;
    let judged = |embedding: Embedding| {
        let stress = paper_stress(&embedding.coords, all.as_ref());
        (embedding, stress)
    };
    let low_rank = Regularization::LowRank { rank: Some(config.rank) };
    let nmds = |samples: &LandmarkDistances| {
        nystrom(samples, &NystromOptions { regularization: low_rank, dim: DIM })
    };
    let optimum = specimen.optimum(distances)?;
    let mut methods: Vec<Runs> = vec![vec![(optimum.embedding.clone(), optimum.stress)]];
    methods.resize_with(METHODS.len(), Runs::new);
    let spectrum = specimen.spectrum(config.eigenvectors)?;
    let basis =
        SpectralBasis { values: &spectrum.values, vectors: &spectrum.vectors, masses: &spectrum.masses };
    for first in specimen.first_samples(config.runs, context.seed) {
        let sampled = |distances: &Distances, sampling, first: VertexId| -> Result<LandmarkDistances> {
            Ok(specimen.nested(distances, sampling, first, &[config.samples])?.remove(0))
        };
        let farthest = sampled(distances, Sampling::Farthest, first)?;
        methods[1].push(judged(nmds(&farthest)?));
        methods[2].push(judged(spectral(&farthest, &basis, &SpectralOptions::default())?));
        let least = sampled(distances, Sampling::Incremental(Variance::Least), first)?;
        methods[3].push(judged(nmds(&least)?));
        let hops = sampled(&Distances::hops(), Sampling::Farthest, first)?;
        methods[4].push(judged(nmds(&hops)?));
    }
    Ok(methods)
}

/// Records the stresses of one shape for one kind of distances.
fn note(
    context: &Context<'_>,
    specimen: &Specimen<'_>,
    distances: &Distances,
    methods: &[Runs],
    stresses: &mut Vec<Figure3Stress>,
    measured: &mut Measured,
) {
    let key = format!("{} {}", distances.name, specimen.label());
    let medians: Vec<f64> = methods.iter().map(|runs| median(&values(runs)).1).collect();
    for (i, (method, runs)) in METHODS.into_iter().zip(methods).enumerate() {
        let paper = context.printed(specimen.label(), method);
        measured.insert(format!("{key} {method}"), medians[i] / medians[0]);
        if let Some(paper) = paper {
            measured.insert(format!("{key} {method} off paper"), (medians[i] / paper - 1.0).abs());
        }
        for (j, other) in METHODS.into_iter().enumerate() {
            measured.insert(format!("{key} {method} below {other}"), medians[j] / medians[i]);
        }
        let range = point(0.0, &values(runs));
        stresses.push(Figure3Stress {
            shape: specimen.name().to_owned(),
            distances: distances.name.to_owned(),
            method: method.to_owned(),
            median: range.median,
            low: range.low,
            high: range.high,
            runs: range.runs,
            paper,
        });
    }
}

fn values(runs: &Runs) -> Vec<f64> {
    runs.iter().map(|(_, stress)| *stress).collect()
}

/// A row of the figure.
struct Shown {
    facts: Figure3Shape,
    shape: TriMesh,
    forms: Vec<TriMesh>,
}

/// The form of each method from the run of median stress, aligned with that of MDS.
fn pictured(context: &Context<'_>, specimen: &Specimen<'_>, methods: &[Runs]) -> Result<Shown> {
    let mesh = specimen.shape.surface.mesh();
    let mut first: Option<PreparedForm> = None;
    let (mut forms, mut facts) = (Vec::new(), Vec::new());
    for (method, runs) in METHODS.into_iter().zip(methods) {
        let (embedding, stress) = &runs[median(&values(runs)).0];
        let form = CanonicalForm::new(embedding, mesh)?;
        let prepared = PreparedForm::new(&form)?;
        let mut surface = form.to_mesh(mesh);
        if let Some(target) = &first {
            let motion = match_forms(&prepared, target, Reflections::Allow).alignment;
            surface.positions.iter_mut().for_each(|p| *p = motion.apply(p));
        }
        first.get_or_insert(prepared);
        orient_consistently(&mut surface);
        forms.push(surface);
        let paper = context.printed(specimen.label(), method);
        facts.push(Figure3Form { method: method.to_owned(), stress: *stress, paper });
    }
    let mut shape = mesh.clone();
    orient_consistently(&mut shape);
    let facts = Figure3Shape {
        name: specimen.name().to_owned(),
        label: specimen.label().to_owned(),
        n_vertices: mesh.n_vertices(),
        forms: facts,
    };
    Ok(Shown { facts, shape, forms })
}
