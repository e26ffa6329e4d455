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
use mesh::TriMesh;
use nmds::{
    Embedding, NystromOptions, Regularization, SpectralBasis, SpectralOptions, nystrom, paper_stress,
    spectral,
};
use report::results::{Figure3Form, Figure3Results, Figure3Shape, Figure3Stress, SeriesPoint};
use serde::Deserialize;
use surface::VertexId;

use crate::config::Printed;
use crate::context::Context;
use crate::experiment::Experiment;
use crate::specimen::{DIM, Distances, Specimen};
use crate::surfaces::{aligned, oriented};
use crate::sweep::{MeasuredNumbers, median, note, point};

/// The methods in the order of the paper.
const METHODS: [&str; 5] = ["MDS", "NMDS", "SMDS", "Min-Var", "BFS"];

/// The embedding and the stress of every run of one method on one shape.
type Runs = Vec<(Embedding, f64)>;

/// Our default, and the planar update, which leaves obtuse triangles as they are.
fn settings() -> [Distances; 2] {
    let options = FastMarchingOptions { update: Update::Planar, obtuse: ObtuseTreatment::Ignore };
    [Distances::default(), Distances { name: "planar", method: Method::FastMarching(options) }]
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Figure3Options {
    samples: usize,
    rank: usize,
    runs: usize,
    eigenvectors: usize,
    /// Stresses by shape.
    printed: Printed,
}

impl Experiment for Figure3Options {
    fn run(&self, context: &Context<'_>) -> Result<()> {
        let settings = settings();
        context.observer.begin("figure 3", settings.len() * context.specimens.len());
        let (mut stresses, mut measured) = (Vec::new(), MeasuredNumbers::new());
        let (mut shapes, mut surfaces) = (Vec::new(), Vec::new());
        for distances in &settings {
            for specimen in context.specimens {
                let methods = self.embeddings(context, specimen, distances)?;
                self.record(context, specimen, distances, &methods, &mut stresses, &mut measured);
                if distances.name == Distances::default().name {
                    let (facts, surface) = self.pictured(context, specimen, &methods)?;
                    shapes.push(facts);
                    surfaces.push(surface);
                }
                context.observer.step();
            }
        }
        let provenance = context.of_specimens();
        let results = Figure3Results { shapes, stresses };
        results.tiles(&surfaces)?.save(context.folder.join(context.name))?;
        context.publish(results, provenance, &measured)
    }
}

impl Figure3Options {
    /// All runs of all methods, in the order of [`METHODS`].
    fn embeddings(
        &self,
        context: &Context<'_>,
        specimen: &Specimen<'_>,
        distances: &Distances,
    ) -> Result<Vec<Runs>> {
        let all = specimen.all_pairs(distances)?;
        let judged = |embedding: Embedding| {
            let stress = paper_stress(&embedding.coords, all.as_ref())?;
            Ok::<_, linalg::LinalgError>((embedding, stress))
        };
        let low_rank = Regularization::LowRank { rank: Some(self.rank) };
        let nmds = |samples: &LandmarkDistances| {
            nystrom(samples, &NystromOptions { regularization: low_rank, dim: DIM })
        };
        let optimum = specimen.optimum(distances)?;
        let mut methods: Vec<Runs> = vec![vec![(optimum.embedding.clone(), optimum.stress)]];
        methods.resize_with(METHODS.len(), Runs::new);
        let spectrum = specimen.spectrum(self.eigenvectors)?;
        let basis =
            SpectralBasis { values: &spectrum.values, vectors: &spectrum.vectors, masses: &spectrum.masses };
        for first in specimen.first_samples(self.runs, context.seed) {
            let sampled = |distances: &Distances, sampling, first: VertexId| -> Result<LandmarkDistances> {
                Ok(specimen.nested(distances, sampling, first, &[self.samples])?.remove(0))
            };
            let farthest = sampled(distances, Sampling::Farthest, first)?;
            methods[1].push(judged(nmds(&farthest)?)?);
            methods[2].push(judged(spectral(&farthest, &basis, &SpectralOptions::default())?)?);
            let least = sampled(distances, Sampling::MinVariance, first)?;
            methods[3].push(judged(nmds(&least)?)?);
            let hops = sampled(&Distances::hops(), Sampling::Farthest, first)?;
            methods[4].push(judged(nmds(&hops)?)?);
        }
        Ok(methods)
    }

    /// Records the stresses of one shape for one kind of distances.
    fn record(
        &self,
        context: &Context<'_>,
        specimen: &Specimen<'_>,
        distances: &Distances,
        methods: &[Runs],
        stresses: &mut Vec<Figure3Stress>,
        measured: &mut MeasuredNumbers,
    ) {
        let key = format!("{} {}", distances.name, specimen.label());
        let ranges: Vec<SeriesPoint> = methods.iter().map(|runs| point(0.0, &values(runs))).collect();
        for (method, range) in METHODS.into_iter().zip(&ranges) {
            let paper = context.printed(&self.printed, specimen.label(), method);
            let numbers = [
                ("stress", range.median),
                ("low", range.low),
                ("high", range.high),
                ("range", range.high / range.low),
            ];
            let off = paper.map(|paper| ("off paper", (range.median / paper - 1.0).abs()));
            note(measured, &format!("{key} {method}"), numbers.into_iter().chain(off));
            measured.insert(format!("{key} {method}"), range.median / ranges[0].median);
            let below = METHODS.into_iter().zip(&ranges).map(|(other, of)| (other, of.median / range.median));
            note(measured, &format!("{key} {method} below"), below);
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

    /// A shape, and the form of each method from the run of median stress, aligned with that of MDS.
    fn pictured(
        &self,
        context: &Context<'_>,
        specimen: &Specimen<'_>,
        methods: &[Runs],
    ) -> Result<(Figure3Shape, (TriMesh, Vec<TriMesh>))> {
        let mesh = specimen.shape.surface.mesh();
        let mut first = None;
        let (mut forms, mut facts) = (Vec::new(), Vec::new());
        for (method, runs) in METHODS.into_iter().zip(methods) {
            let (embedding, stress) = &runs[median(&values(runs)).0];
            forms.push(aligned(&CanonicalForm::new(embedding, mesh)?, mesh, &mut first)?);
            let paper = context.printed(&self.printed, specimen.label(), method);
            facts.push(Figure3Form { method: method.to_owned(), stress: *stress, paper });
        }
        let facts = Figure3Shape {
            name: specimen.name().to_owned(),
            label: specimen.label().to_owned(),
            n_vertices: mesh.n_vertices(),
            forms: facts,
        };
        Ok((facts, (oriented(mesh), forms)))
    }
}

fn values(runs: &Runs) -> Vec<f64> {
    runs.iter().map(|(_, stress)| *stress).collect()
}
