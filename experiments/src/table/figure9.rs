//! Figure 9: time and memory from a surface to its canonical form, distances included.
//!
//! Measures ratios of times at the smaller number of vertices, `full MDS over NMDS`, `MDS over NMDS` (with the faster
//! decomposition) and `SMDS over NMDS`; at the larger one, `large SMDS over NMDS` and `algebra share`, the share of linear
//! algebra in the time of NMDS; `small|large METHOD seconds|bytes`, the time and memory of each method; and `growth`, the exponent of the time of NMDS in the number of vertices.

use anyhow::{Context as _, Result};
use base::terminal::with_peak_bytes;
use canonform::Surface;
use canonform::embed::{EmbedMethod, FormOptions, embed};
use datasets::{ArticulatedOptions, Family, articulated_shape};
use mesh::RepairOptions;
use nmds::classical_full;
use report::results::{Figure9Measured, Figure9Results, Figure9Row};
use serde::Deserialize;
use surface::VertexId;

use crate::collection::LabeledSurface;
use crate::config::Printed;
use crate::context::Context;
use crate::experiment::Experiment;
use crate::specimen::{DIM, Distances, low_rank};
use crate::sweep::{MeasuredNumbers, note, numbers, timed};

/// The ratio of the numbers of vertices of both shapes: 28,000 and 3,400 in the paper.
const LARGER: f64 = 28_000.0 / 3_400.0;

/// The number of sources from which the time of all pairs is extrapolated.
const TIMED_SOURCES: usize = 64;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Figure9Options {
    samples: usize,
    rank: usize,
    runs: usize,
    /// Seconds by number of vertices.
    printed: Printed,
}

impl Experiment for Figure9Options {
    fn run(&self, context: &Context<'_>) -> Result<()> {
        let small = context.specimens.first().context("there is no shape to measure")?.shape;
        let p = small.surface.mesh().n_vertices();
        let options = ArticulatedOptions {
            seed: context.seed,
            n_vertices: (p as f64 * LARGER / 1000.0).round() as usize * 1000,
        };
        let made = articulated_shape(Family::David, 0, &options)?;
        let large = LabeledSurface {
            name: format!("built-in {}", made.name),
            label: made.label,
            surface: Surface::new(&made.mesh, &RepairOptions::default(), &())?,
        };
        context.observer.begin("figure 9", 7);
        let mut rows = Vec::new();
        for (shape, vertices) in [(small, "3400"), (&large, "28000")] {
            let mut add = |method: &str, measured: Result<Figure9Measured, String>| {
                context.observer.step();
                let name = method.split(',').next().unwrap_or(method);
                rows.push(Figure9Row {
                    shape: shape.name.clone(),
                    n_vertices: shape.surface.mesh().n_vertices(),
                    method: method.to_owned(),
                    measured: measured.as_ref().ok().copied(),
                    paper_seconds: context.printed(&self.printed, vertices, name),
                    note: measured.err().unwrap_or_default(),
                });
            };
            add("NMDS", Ok(self.timed(shape, EmbedMethod::low_rank(self.rank))?));
            add("SMDS", Ok(self.timed(shape, EmbedMethod::spectral())?));
            let gib = |bytes: usize| bytes as f64 / f64::from(1 << 30);
            let needed = shape.surface.mesh().n_vertices().pow(2) * size_of::<f64>();
            if needed > canonform::embed::DISTANCES_LIMIT {
                let (needed, limit) = (gib(needed), gib(canonform::embed::DISTANCES_LIMIT));
                let seconds = all_pairs_seconds(shape)?;
                let reason = format!(
                    "all pairs need {needed:.1} GiB, above the limit of {limit:.0}; measuring them would take {seconds:.0} s"
                );
                add("MDS", Err(reason));
            } else {
                add("MDS, three eigenpairs", Ok(self.timed(shape, EmbedMethod::Classical)?));
                add("MDS, all eigenpairs", Ok(full(shape)?));
            }
        }
        let measured = ratios(&rows);
        let results = Figure9Results { threads: rayon::current_num_threads(), rows };
        context.publish(results, context.of_specimens(), &measured)
    }
}

impl Figure9Options {
    /// The fastest of several runs.
    fn timed(&self, shape: &LabeledSurface, method: EmbedMethod) -> Result<Figure9Measured> {
        // Long runs are hardly disturbed by others.
        let runs = match method {
            EmbedMethod::Nystrom { .. } => self.runs,
            _ => 2,
        };
        let options = FormOptions { method, ..low_rank(self.samples, self.rank, 0) };
        let mut best: Option<Figure9Measured> = None;
        for _ in 0..runs {
            let (embedded, peak_bytes) = with_peak_bytes(|| embed(&shape.surface, &options, &()));
            let seconds = embedded?.report.seconds;
            let run = Figure9Measured {
                geodesics: seconds.geodesics,
                embedding: seconds.embedding,
                runs,
                peak_bytes,
            };
            best = Some(best.filter(|best| best.total() <= run.total()).unwrap_or(run));
        }
        best.context("figure 9 needs at least one run")
    }
}

/// Classical scaling with all eigenpairs.
fn full(shape: &LabeledSurface) -> Result<Figure9Measured> {
    let method = Distances::default().method;
    let run = || -> Result<[f64; 2]> {
        let (all, geodesics) = timed(|| method.prepare(shape.surface.intrinsic(), &())?.distance_matrix())?;
        let (_, embedding) = timed(|| classical_full(&all, DIM))?;
        Ok([geodesics, embedding])
    };
    let (seconds, peak_bytes) = with_peak_bytes(run);
    let [geodesics, embedding] = seconds?;
    Ok(Figure9Measured { geodesics, embedding, runs: 1, peak_bytes })
}

/// The seconds that all pairs would take, extrapolated from some of the sources.
fn all_pairs_seconds(shape: &LabeledSurface) -> Result<f64> {
    let p = shape.surface.mesh().n_vertices();
    let solver = Distances::default().method.prepare(shape.surface.intrinsic(), &())?;
    let sources: Vec<VertexId> =
        (0..TIMED_SOURCES).map(|i| VertexId::from(i * (p / TIMED_SOURCES).max(1) % p)).collect();
    let (_, seconds) = timed(|| solver.distance_columns(&sources))?;
    Ok(seconds * p as f64 / TIMED_SOURCES as f64)
}

fn ratios(rows: &[Figure9Row]) -> MeasuredNumbers {
    let sizes = [rows.first(), rows.last()].map(|row| row.map_or(0, |row| row.n_vertices));
    let of = |is_small: bool, method: &str| {
        let row = rows.iter().find(|r| (r.n_vertices == sizes[0]) == is_small && r.method == method);
        row.and_then(|row| row.measured)
    };
    let total = |is_small, method| of(is_small, method).map_or(f64::NAN, |m: Figure9Measured| m.total());
    let ratio = |is_small, method| total(is_small, method) / total(is_small, "NMDS");
    let factor = sizes[1] as f64 / sizes[0].max(1) as f64;
    let mut measured = numbers([
        ("full MDS over NMDS", ratio(true, "MDS, all eigenpairs")),
        ("MDS over NMDS", ratio(true, "MDS, three eigenpairs")),
        ("SMDS over NMDS", ratio(true, "SMDS")),
        ("large SMDS over NMDS", ratio(false, "SMDS")),
        ("algebra share", of(false, "NMDS").map_or(f64::NAN, |m| m.embedding / m.total())),
        ("growth", (total(false, "NMDS") / total(true, "NMDS")).ln() / factor.ln()),
    ]);
    for (row, found) in rows.iter().filter_map(|row| Some((row, row.measured?))) {
        let size = if row.n_vertices == sizes[0] { "small" } else { "large" };
        let spent = [("seconds", found.total()), ("bytes", found.peak_bytes as f64)];
        note(&mut measured, &format!("{size} {}", row.method), spent);
    }
    measured
}
