//! Figure 3: the forms of two shapes by several methods, and their stress.
//!
//! Measures, for `DISTANCES` in `default`, `planar`, `point-source` (the last two ignore obtuse corners),
//! `SHAPE` a class and `METHOD` in `MDS`, `NMDS`, `SMDS`, `Min-Var`, `BFS`: `DISTANCES SHAPE METHOD`, the
//! median stress over that of MDS by the same distances (1 for MDS itself); `DISTANCES SHAPE METHOD off paper`,
//! how far the median stress is from the printed one, as a share; `DISTANCES SHAPE A below B`, the stress of `B`
//! over that of `A`.

use std::time::Instant;

use anyhow::Result;
use descriptors::{CanonicalForm, MatchOptions, PreparedForm, ShapeMetric, match_forms};
use geodesics::{FastMarchingOptions, Method, ObtuseTreatment, Sampling, Update, Variance};
use linalg::LandmarkDistances;
use mesh::{TriMesh, orient_consistently};
use nmds::{
    Embedding, NystromOptions, Regularization, SpectralBasis, SpectralOptions, nystrom, paper_stress,
    spectral,
};
use report::figure3::{Figure3Surfaces, figure3};
use report::results::{Figure3Form, Figure3Record, Figure3Shape, Figure3Stress, write};
use report::tables::figure3_table;
use surface::VertexId;
use view::render::View;

use crate::run::Context;
use crate::specimen::{DIM, Distances, Specimen};
use crate::sweep::{Measured, median, point};

/// The columns, as the paper has them.
const METHODS: [&str; 5] = ["MDS", "NMDS", "SMDS", "Min-Var", "BFS"];

/// One method on one shape: an embedding and its stress for each run.
type Runs = Vec<(Embedding, f64)>;

/// The default, and what plain fast marching on the triangles as they are could have been.
fn settings() -> [Distances; 3] {
    let plain = |name, update| {
        let options = FastMarchingOptions { update, obtuse: ObtuseTreatment::Ignore };
        Distances { name, method: Method::FastMarching(options) }
    };
    [Distances::default(), plain("planar", Update::Planar), plain("point-source", Update::PointSource)]
}

/// Runs the experiment, writes `figure3.json` and its pictures and prints the stresses.
pub(crate) fn run(context: &Context<'_>) -> Result<()> {
    let start = Instant::now();
    let settings = settings();
    context.observer.begin("figure 3", settings.len() * context.specimens.len());
    let (mut stresses, mut measured, mut shown) = (Vec::new(), Measured::new(), Vec::new());
    for distances in &settings {
        for specimen in context.specimens {
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
        analysis: context.config.analysis.trim().to_owned(),
        provenance: context.provenance(context.setup(), start.elapsed()),
        shapes: shown.iter().map(|row| row.facts.clone()).collect(),
        stresses,
    };
    let rows: Vec<_> = shown
        .iter()
        .map(|row| Figure3Surfaces { facts: &row.facts, shape: &row.shape, forms: &row.forms })
        .collect();
    figure3(&rows, &View::default(), context.output("figure3"))?;
    write(&record, context.output("figure3.json"))?;
    context.say(&figure3_table(&record))
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
    for first in specimen.first_samples(config.runs, context.args.seed) {
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

/// Writes down what one way of measuring gave on one shape.
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

/// A row of the picture.
struct Shown {
    facts: Figure3Shape,
    shape: TriMesh,
    forms: Vec<TriMesh>,
}

/// The run of median stress of each method, its form turned to match that of MDS.
fn pictured(context: &Context<'_>, specimen: &Specimen<'_>, methods: &[Runs]) -> Result<Shown> {
    let mesh = specimen.shape.surface.mesh();
    let mut first: Option<PreparedForm> = None;
    let (mut forms, mut facts) = (Vec::new(), Vec::new());
    for (method, runs) in METHODS.into_iter().zip(methods) {
        let (embedding, stress) = &runs[median(&values(runs)).0];
        let form = CanonicalForm::new(embedding, mesh)?;
        let prepared = PreparedForm::new(&form, ShapeMetric::MATCHED_POINTS)?;
        let mut surface = form.to_mesh(mesh);
        if let Some(target) = &first {
            let motion = match_forms(&prepared, target, &MatchOptions::default())?.alignment;
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
