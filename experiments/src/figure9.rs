//! Figure 9: seconds and memory from a surface to its form, distances included.
//!
//! Measures, at the smaller number of vertices, `full MDS over NMDS`, `MDS over NMDS` (the faster decomposition) and `SMDS
//! over NMDS`; at the larger `large SMDS over NMDS` and `algebra share`, that of linear algebra in NMDS; and `growth`,
//! the exponent of the time of NMDS in the number of vertices.

use std::time::Instant;

use anyhow::{Context as _, Result};
use canonform::{EmbedMethod, FormOptions, Samples, Surface, embed};
use datasets::{ArticulatedOptions, Family, articulated_shape};
use mesh::RepairOptions;
use nmds::classical_full;
use report::results::{Figure9Measured, Figure9Record, Figure9Row, write};
use report::tables::figure9_table;
use surface::VertexId;
use terminal::PeakMemory;

use crate::collection::Shape;
use crate::run::Context;
use crate::specimen::{DIM, Distances};
use crate::sweep::Measured;

/// Vertices of the larger shape, for each of the smaller: the paper's 28,000 for 3,400.
const LARGER: f64 = 28_000.0 / 3_400.0;

/// Sources that the time of all pairs is extrapolated from.
const TIMED_SOURCES: usize = 64;

/// Runs the experiment, writes `figure9.json` and prints the table.
pub(crate) fn run(context: &Context<'_>) -> Result<()> {
    let start = Instant::now();
    let small = context.specimens.first().context("there is no shape to measure")?.shape;
    let p = small.surface.mesh().n_vertices();
    let options = ArticulatedOptions {
        seed: context.args.seed,
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
            let printed = context.config.printed.iter().find(|p| p.row == vertices && p.method == name);
            rows.push(Figure9Row {
                shape: shape.name.clone(),
                n_vertices: shape.surface.mesh().n_vertices(),
                method: method.to_owned(),
                measured: measured.as_ref().ok().copied(),
                paper_seconds: printed.map(|p| p.value),
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
                    "all pairs need {:.1} GiB, the limit is {:.0}; to measure them alone would take {seconds:.0} s",
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
    let record = Figure9Record {
        expectations: context.check(|name| measured.get(name).copied())?,
        analysis: context.config.analysis.trim().to_owned(),
        provenance: context.provenance(context.setup(), start.elapsed()),
        threads: rayon::current_num_threads(),
        rows,
    };
    write(&record, context.output("figure9.json"))?;
    context.say(&figure9_table(&record))
}

/// The fastest of a few runs.
fn timed(context: &Context<'_>, shape: &Shape, method: EmbedMethod) -> Result<Figure9Measured> {
    // What takes long is hardly disturbed.
    let runs = match method {
        EmbedMethod::Nystrom { .. } => context.config.runs,
        _ => 2,
    };
    let options =
        FormOptions { samples: Samples::Count(context.config.samples), method, ..FormOptions::default() };
    let mut best: Option<Figure9Measured> = None;
    for _ in 0..runs {
        let memory = PeakMemory::begin();
        let seconds = embed(&shape.surface, &options, &())?.report.seconds;
        let run = Figure9Measured {
            geodesics: seconds.geodesics,
            embedding: seconds.embedding,
            runs,
            peak_bytes: memory.bytes(),
        };
        best = Some(best.filter(|best| best.total() <= run.total()).unwrap_or(run));
    }
    best.context("figure 9 needs at least one run")
}

/// Classical scaling by all eigenpairs.
fn full(shape: &Shape) -> Result<Figure9Measured> {
    let memory = PeakMemory::begin();
    let start = Instant::now();
    let all = Distances::default().method.prepare(&shape.surface.intrinsic)?.distance_matrix()?;
    let geodesics = start.elapsed().as_secs_f64();
    classical_full(&all, DIM)?;
    let embedding = start.elapsed().as_secs_f64() - geodesics;
    Ok(Figure9Measured { geodesics, embedding, runs: 1, peak_bytes: memory.bytes() })
}

/// How long all pairs would take, from some of the sources.
fn all_pairs_seconds(shape: &Shape) -> Result<f64> {
    let p = shape.surface.mesh().n_vertices();
    let solver = Distances::default().method.prepare(&shape.surface.intrinsic)?;
    let sources: Vec<VertexId> =
        (0..TIMED_SOURCES).map(|i| VertexId::from(i * (p / TIMED_SOURCES).max(1) % p)).collect();
    let start = Instant::now();
    solver.distance_columns(&sources);
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
    .map(|(name, value)| (name.to_owned(), value))
    .into()
}
