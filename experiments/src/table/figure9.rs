//! Figure 9: time and memory from a surface to its canonical form, distances included.
//!
//! Measures ratios of times at the smaller number of vertices, `full MDS over NMDS`, `MDS over NMDS` (with the faster
//! decomposition) and `SMDS over NMDS`; at the larger one, `large SMDS over NMDS` and `algebra share`, the share of linear
//! algebra in the time of NMDS; `small|large METHOD seconds|bytes`, the time and memory of each method; and `growth`, the exponent of the time of NMDS in the number of vertices.

use std::time::Instant;

use anyhow::{Context as _, Result};
use canonform::{EmbedMethod, FormOptions, Samples, Surface, embed};
use datasets::{ArticulatedOptions, Family, articulated_shape};
use mesh::RepairOptions;
use nmds::classical_full;
use report::results::{Figure9Measured, Figure9Results, Figure9Row};
use surface::VertexId;
use terminal::with_peak_bytes;

use crate::collection::Shape;
use crate::context::Context;
use crate::specimen::{DIM, Distances};
use crate::sweep::Measured;

/// The ratio of the numbers of vertices of both shapes: 28,000 and 3,400 in the paper.
const LARGER: f64 = 28_000.0 / 3_400.0;

/// The number of sources from which the time of all pairs is extrapolated.
const TIMED_SOURCES: usize = 64;

pub(crate) fn run(context: &Context<'_>) -> Result<()> {
    let small = context.specimens.first().context("there is no shape to measure")?.shape;
    let p = small.surface.mesh().n_vertices();
    let options = ArticulatedOptions {
        seed: context.seed,
        n_vertices: (p as f64 * LARGER / 1000.0).round() as usize * 1000,
    };
    let made = articulated_shape(Family::David, 0, &options)?;
    let large = Shape {
        name: format!("built-in {}", made.name),
        label: made.label,
        surface: Surface::new(&made.mesh, &RepairOptions::default())?,
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
                paper_seconds: context.config.printed(vertices, name),
                note: measured.err().unwrap_or_default(),
            });
        };
        add("NMDS", Ok(timed(context, shape, EmbedMethod::low_rank(context.config.rank))?));
        add("SMDS", Ok(timed(context, shape, EmbedMethod::spectral())?));
        let limit = canonform::DISTANCES_LIMIT;
        let needed = shape.surface.mesh().n_vertices().pow(2) * size_of::<f64>();
        if needed > limit {
            let gib = |bytes: usize| bytes as f64 / f64::from(1 << 30);
            let seconds = all_pairs_seconds(shape)?;
            add(
                "MDS",
                Err(format!(
                    "all pairs need {:.1} GiB, above the limit of {:.0}; measuring them would take {seconds:.0} s",
                    gib(needed),
                    gib(limit)
                )),
            );
        } else {
            add("MDS, three eigenpairs", Ok(timed(context, shape, EmbedMethod::Classical)?));
            add("MDS, all eigenpairs", Ok(full(shape)?));
        }
    }
    let measured = ratios(&rows);
    let results = Figure9Results { threads: rayon::current_num_threads(), rows };
    context.publish(results, context.provenance(context.setup(context.specimens)), &measured)
}

/// The fastest of several runs.
fn timed(context: &Context<'_>, shape: &Shape, method: EmbedMethod) -> Result<Figure9Measured> {
    // Long runs are hardly disturbed by others.
    let runs = match method {
        EmbedMethod::Nystrom { .. } => context.config.runs,
        _ => 2,
    };
    let options =
        FormOptions { samples: Samples::Count(context.config.samples), method, ..FormOptions::default() };
    let mut best: Option<Figure9Measured> = None;
    for _ in 0..runs {
        let (embedded, peak_bytes) = with_peak_bytes(|| embed(&shape.surface, &options, &()));
        let seconds = embedded?.report.seconds;
        let run =
            Figure9Measured { geodesics: seconds.geodesics, embedding: seconds.embedding, runs, peak_bytes };
        best = Some(best.filter(|best| best.total() <= run.total()).unwrap_or(run));
    }
    best.context("figure 9 needs at least one run")
}

/// Classical scaling with all eigenpairs.
fn full(shape: &Shape) -> Result<Figure9Measured> {
    let run = || -> Result<[f64; 2]> {
        let start = Instant::now();
        let all = Distances::default().method.prepare(&shape.surface.intrinsic)?.distance_matrix()?;
        let geodesics = start.elapsed().as_secs_f64();
        classical_full(&all, DIM)?;
        Ok([geodesics, start.elapsed().as_secs_f64() - geodesics])
    };
    let (seconds, peak_bytes) = with_peak_bytes(run);
    let [geodesics, embedding] = seconds?;
    Ok(Figure9Measured { geodesics, embedding, runs: 1, peak_bytes })
}

/// The seconds that all pairs would take, extrapolated from some of the sources.
fn all_pairs_seconds(shape: &Shape) -> Result<f64> {
    let p = shape.surface.mesh().n_vertices();
    let solver = Distances::default().method.prepare(&shape.surface.intrinsic)?;
    let sources: Vec<VertexId> =
        (0..TIMED_SOURCES).map(|i| VertexId::from(i * (p / TIMED_SOURCES).max(1) % p)).collect();
    let start = Instant::now();
    solver.distance_columns(&sources)?;
    Ok(start.elapsed().as_secs_f64() * p as f64 / TIMED_SOURCES as f64)
}

fn ratios(rows: &[Figure9Row]) -> Measured {
    let small = rows.first().map_or(0, |row| row.n_vertices);
    let of = |is_small: bool, method: &str| {
        let row = rows.iter().find(|r| (r.n_vertices == small) == is_small && r.method == method);
        row.and_then(|r| r.measured)
    };
    let total = |is_small, method| of(is_small, method).map_or(f64::NAN, |m: Figure9Measured| m.total());
    let large = rows.last().map_or(0, |row| row.n_vertices);
    let factor = large as f64 / small.max(1) as f64;
    let share = of(false, "NMDS").map_or(f64::NAN, |m| m.embedding / m.total());
    [
        ("full MDS over NMDS", total(true, "MDS, all eigenpairs") / total(true, "NMDS")),
        ("MDS over NMDS", total(true, "MDS, three eigenpairs") / total(true, "NMDS")),
        ("SMDS over NMDS", total(true, "SMDS") / total(true, "NMDS")),
        ("large SMDS over NMDS", total(false, "SMDS") / total(false, "NMDS")),
        ("algebra share", share),
        ("growth", (total(false, "NMDS") / total(true, "NMDS")).ln() / factor.ln()),
    ]
    .into_iter()
    .map(|(name, value)| (name.to_owned(), value))
    .chain(rows.iter().flat_map(|row| {
        let size = if row.n_vertices == small { "small" } else { "large" };
        let values = row.measured.map(|m| [("seconds", m.total()), ("bytes", m.peak_bytes as f64)]);
        values
            .into_iter()
            .flatten()
            .map(move |(what, value)| (format!("{size} {} {what}", row.method), value))
    }))
    .collect()
}
