//! Figure 3: canonical forms of two shapes by several methods, and their stress.
//!
//! Measures, for `DISTANCES` in `default`, `planar` (which ignores obtuse triangles), a class
//! `SHAPE` and `METHOD` in `MDS`, `NMDS`, `SMDS`, `Min-Var`, `BFS`:
//! * `DISTANCES SHAPE METHOD`: the ratio of the median stress to that of MDS with the same distances (1 for MDS);
//! * `DISTANCES SHAPE METHOD stress|low|high`: the median, the least and the greatest stress;
//! * `DISTANCES SHAPE METHOD range`: the ratio of the greatest to the least stress;
//! * `DISTANCES SHAPE METHOD off paper`: the relative difference of the median stress from that printed in the paper;
//! * `DISTANCES SHAPE A below B`: the ratio of the median stress of `B` to that of `A`.

use anyhow::Result;
use descriptors::CanonicalForm;
use geodesics::{FastMarchingOptions, Method, ObtuseTreatment, Sampling, Update};
use linalg::LandmarkDistances;
use nmds::{Embedding, Regularization, SpectralBasis, nystrom, paper_stress, spectral};
use report::numbers::significant;
use report::record::{Axis, AxisScale, Figure, FigurePanels, Mark, PlotPoint, SeriesKind, TileRow, Tiles};
use report::{Record, Table};
use surface::VertexId;

use crate::context::Context;
use crate::specimen::{DIM, Specimen};
use crate::surfaces::{aligned, tile};
use crate::sweep::{MeasuredNumbers, Panels, median, note, plots, point};

/// The methods in the order of the paper.
const METHODS: [&str; 5] = ["MDS", "NMDS", "SMDS", "Min-Var", "BFS"];

/// The embedding and the stress of every run of one method on one shape.
type Runs = Vec<(Embedding, f64)>;

/// Our default, and the planar update, which leaves obtuse triangles as they are.
fn settings() -> [(&'static str, Method); 2] {
    let options = FastMarchingOptions { update: Update::Planar, obtuse: ObtuseTreatment::Ignore };
    [("default", Method::default()), ("planar", Method::FastMarching(options))]
}

const FORMS: &str = "Shapes (left) and their canonical forms by each method. Every form fills its tile and is rotated to match the first of its row. Under it: its stress in squared mesh units, from the run of median stress, and the number printed in the paper.";
const STRESS: &str = "Median and range of the stress over runs that differ in the first sample, for two kinds of distances, and the numbers printed in the paper.";

pub(crate) fn figure3(context: &Context<'_>) -> Result<Record> {
    let settings = settings();
    context.observer.begin("figure 3", settings.len() * context.specimens.len());
    let (mut measured, mut rows, mut tiles) = (MeasuredNumbers::new(), Vec::new(), Vec::new());
    let mut panels = Panels::default();
    let x = Axis { scale: AxisScale::Category, ..Axis::linear("") };
    let axes = [x, Axis::log("stress", "squared mesh units")];
    for specimen in context.specimens {
        for (distances, method) in settings {
            let is_default = method == Method::default();
            let methods = embeddings(context, specimen, method)?;
            let key = format!("{distances} {}", specimen.shape.label);
            let series = format!("{distances} distances");
            let ranges: Vec<PlotPoint> =
                methods.iter().zip(0..).map(|(runs, i)| point(f64::from(i), &values(runs))).collect();
            let paper = |method: &str| context.printed(&specimen.shape.label, method);
            for (method, range) in METHODS.into_iter().zip(&ranges) {
                let mut add = |kind, point| {
                    panels.add(&specimen.shape.name, axes.clone(), (&series, kind), point);
                };
                add(SeriesKind::Filled, range.clone());
                // The paper has one number for all kinds of distances.
                if let Some(paper) = paper(method).filter(|_| is_default) {
                    add(SeriesKind::Hollow, PlotPoint::new(range.x, paper, ""));
                }
                let PlotPoint { y, low, high, .. } = *range;
                let numbers = [("stress", y), ("low", low), ("high", high), ("range", high / low)];
                let off = paper(method).map(|paper| ("off paper", (y / paper - 1.0).abs()));
                note(&mut measured, &format!("{key} {method}"), numbers.into_iter().chain(off));
                measured.insert(format!("{key} {method}"), y / ranges[0].y);
                let below = METHODS.into_iter().zip(&ranges).map(|(other, of)| (other, of.y / y));
                note(&mut measured, &format!("{key} {method} below"), below);
                let names = [specimen.shape.name.as_str(), distances, method].map(Into::into);
                let numbers = [y.into(), low.into(), high.into(), paper(method).into()];
                rows.push([&names[..], &numbers].concat());
            }
            if is_default {
                tiles.push(pictured(specimen, &methods, paper)?);
            }
            context.observer.step();
        }
    }
    let mark = |(i, name): (usize, &str)| Mark { x: i as f64, name: name.to_owned() };
    let marks: Vec<Mark> = METHODS.into_iter().enumerate().map(mark).collect();
    panels.0.iter_mut().for_each(|plot| plot.marks.clone_from(&marks));
    let heads = ["shape"].into_iter().chain(METHODS).map(str::to_owned).collect();
    let tiles = FigurePanels::Tiles(Tiles { is_paired: false, heads, rows: tiles });
    let caption = "Stress in squared mesh units over runs that differ in the first sample.";
    let headings = ["shape", "distances", "method", "median", "least", "greatest", "paper"];
    Ok(Record {
        figures: vec![
            Figure { part: "forms".to_owned(), caption: FORMS.to_owned(), panels: tiles },
            Figure { caption: STRESS.to_owned(), ..plots("stress", panels.0) },
        ],
        tables: vec![Table::new(caption, headings, rows)],
        ..context.record(&[], measured)
    })
}

/// All runs of all methods, in the order of [`METHODS`].
fn embeddings(context: &Context<'_>, specimen: &Specimen<'_>, distances: Method) -> Result<Vec<Runs>> {
    let options = &context.options;
    let all = specimen.all_pairs(distances)?;
    let judged = |embedding: Embedding| {
        let stress = paper_stress(&embedding.coords, all.as_ref())?;
        Ok::<_, linalg::LinalgError>((embedding, stress))
    };
    let low_rank = Regularization::LowRank { rank: Some(options.rank) };
    let nmds = |samples: &LandmarkDistances| nystrom(samples, low_rank, DIM);
    let optimum = specimen.optimum(distances)?;
    let mut methods: Vec<Runs> = vec![vec![(optimum.embedding.clone(), optimum.stress)]];
    methods.resize_with(METHODS.len(), Runs::new);
    let spectrum = specimen.spectrum(options.eigenvectors)?;
    let basis =
        SpectralBasis { values: &spectrum.values, vectors: &spectrum.vectors, masses: &spectrum.masses };
    for first in specimen.first_samples(options.runs, context.seed) {
        let sampled = |distances: Method, sampling, first: VertexId| -> Result<LandmarkDistances> {
            Ok(specimen.nested(distances, sampling, first, &[options.samples])?.remove(0))
        };
        let farthest = sampled(distances, Sampling::Farthest, first)?;
        methods[1].push(judged(nmds(&farthest)?)?);
        methods[2].push(judged(spectral(&farthest, &basis, SpectralBasis::MU, DIM)?)?);
        let least = sampled(distances, Sampling::MinVariance, first)?;
        methods[3].push(judged(nmds(&least)?)?);
        let hops = sampled(Method::BreadthFirst, Sampling::Farthest, first)?;
        methods[4].push(judged(nmds(&hops)?)?);
    }
    Ok(methods)
}

/// A shape, and the form of each method from the run of median stress, aligned with that of MDS.
fn pictured(
    specimen: &Specimen<'_>,
    methods: &[Runs],
    paper: impl Fn(&str) -> Option<f64>,
) -> Result<TileRow> {
    let mesh = specimen.shape.surface.mesh();
    let mut first = None;
    let distances = specimen.all_pairs(Method::default())?;
    let distances = distances.row(0);
    let mut tiles = vec![tile(mesh, false, distances, vec![format!("{} vertices", mesh.n_vertices())])];
    for (method, runs) in METHODS.into_iter().zip(methods) {
        let (embedding, stress) = &runs[median(&values(runs)).0];
        let form = aligned(&CanonicalForm::new(embedding, mesh)?, mesh, &mut first)?;
        let printed = paper(method).map(|paper| format!("paper {paper}"));
        let captions = [format!("stress {}", significant(*stress, 4))].into_iter().chain(printed).collect();
        tiles.push(tile(&form, true, distances, captions));
    }
    Ok(TileRow { name: specimen.shape.name.clone(), tiles })
}

fn values(runs: &Runs) -> Vec<f64> {
    runs.iter().map(|(_, stress)| *stress).collect()
}
