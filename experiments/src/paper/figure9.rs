//! Figure 9: time and memory from a surface to its canonical form, distances included.
//!
//! Measures ratios of times at the smaller number of vertices, `full MDS over NMDS`, `MDS over NMDS` (with the faster
//! decomposition) and `SMDS over NMDS`; at the larger one, `large SMDS over NMDS` and `algebra share`, the share of linear
//! algebra in the time of NMDS; and `small|large METHOD seconds`, the time of each method.

use std::collections::BTreeMap;

use anyhow::{Context as _, Result};
use base::terminal::with_peak_bytes;
use canonform::Surface;
use canonform::embed::{EmbedMethod, FormOptions, embed};
use datasets::{ArticulatedOptions, Family, articulated_shape};
use geodesics::Method;
use mesh::RepairOptions;
use nmds::classical_full;
use report::numbers::{bytes, seconds};
use report::record::{Axis, AxisScale, Figure, Mark, PlotPoint, SeriesKind};
use report::{Cell, Record, Table};

use crate::collection::LabeledSurface;
use crate::context::Context;
use crate::specimen::{DIM, low_rank};
use crate::sweep::{Panels, note, numbers, plots, timed};

/// The ratio of the numbers of vertices of both shapes: 28,000 and 3,400 in the paper.
const LARGER: f64 = 28_000.0 / 3_400.0;

const TIMES: &str = "From the repaired mesh to coordinates";

/// Time and memory of one method.
#[derive(Debug, Clone, Copy)]
struct Spent {
    /// Wall-clock seconds for distances, and for linear algebra.
    seconds: [f64; 2],
    /// Peak memory, in addition to that in use before.
    peak_bytes: usize,
}

impl Spent {
    fn total(&self) -> f64 {
        self.seconds.iter().sum()
    }
}

pub(crate) fn figure9(context: &Context<'_>) -> Result<Record> {
    let small = context.specimens.first().context("there is no shape to measure")?.shape;
    let p = small.surface.mesh().n_vertices();
    let n_vertices = (p as f64 * LARGER / 1000.0).round() as usize * 1000;
    let made = articulated_shape(Family::David, 0, &ArticulatedOptions { seed: context.seed, n_vertices })?;
    let large = LabeledSurface {
        name: format!("built-in {}", made.name),
        label: made.label,
        surface: Surface::new(&made.mesh, &RepairOptions::default(), &())?,
    };
    context.observer.begin("figure 9", 7);
    let mut spent = BTreeMap::new();
    let (mut rows, mut marks, mut panels) = (Vec::new(), Vec::new(), Panels::default());
    let axes = [Axis { scale: AxisScale::Category, ..Axis::linear("") }, Axis::log("time", "seconds")];
    for (place, (shape, size, printed)) in
        [(small, "small", "3400"), (&large, "large", "28000")].into_iter().enumerate()
    {
        let n = shape.surface.mesh().n_vertices();
        marks.push(Mark { x: place as f64, name: format!("{}, {n} vertices", shape.name) });
        let at = |seconds: f64, note: String| PlotPoint::new(place as f64, seconds, note);
        let mut add = |method: &'static str, measured: Result<Spent, String>| {
            context.observer.step();
            let name = method.split(',').next().unwrap_or(method);
            let paper = context.printed(printed, name);
            let found = measured.as_ref().ok();
            let [geodesics, algebra] = found.map_or([f64::NAN; 2], |found| found.seconds);
            let total = geodesics + algebra;
            let mut row: Vec<Cell> = vec![shape.name.as_str().into(), n.into(), method.into()];
            row.extend([geodesics, algebra, total].map(Cell::from));
            row.extend([found.map(|found| bytes(found.peak_bytes)).into(), paper.into()]);
            if let Some(found) = found {
                let [geodesics, algebra] = found.seconds.map(seconds);
                let said =
                    format!("{geodesics} s distances, {algebra} s algebra, {}", bytes(found.peak_bytes));
                panels.add(TIMES, axes.clone(), (method, SeriesKind::Filled), at(total, said));
                spent.insert((size, method), *found);
            }
            row.push(measured.err().into());
            if let Some(paper) = paper {
                panels.add(TIMES, axes.clone(), (method, SeriesKind::Hollow), at(paper, String::new()));
            }
            rows.push(row);
        };
        let fastest = |method| fastest(context, shape, method);
        add("NMDS", Ok(fastest(EmbedMethod::low_rank(context.options.rank))?));
        add("SMDS", Ok(fastest(EmbedMethod::spectral())?));
        let (needed, limit) = (n.pow(2) * size_of::<f64>(), canonform::embed::DISTANCES_LIMIT);
        if needed > limit {
            let [needed, limit] = [needed, limit].map(|bytes| bytes as f64 / f64::from(1 << 30));
            add("MDS", Err(format!("all pairs need {needed:.1} GiB, above the limit of {limit:.0}")));
        } else {
            add("MDS, three eigenpairs", Ok(fastest(EmbedMethod::Classical)?));
            add("MDS, all eigenpairs", Ok(full(shape)?));
        }
    }
    panels.0.iter_mut().for_each(|plot| plot.marks.clone_from(&marks));
    let caption = "Filled: this program. Hollow: the paper, on a laptop of 2015.".to_owned();
    let figure = Figure { caption, ..plots("times", panels.0) };
    let headings = "shape vertices method distances algebra total memory paper remark".split(' ');
    let total = |size, method| spent.get(&(size, method)).map_or(f64::NAN, Spent::total);
    let ratio = |size, method| total(size, method) / total(size, "NMDS");
    let algebra = spent.get(&("large", "NMDS")).map_or(f64::NAN, |found| found.seconds[1]);
    let mut measured = numbers([
        ("full MDS over NMDS", ratio("small", "MDS, all eigenpairs")),
        ("MDS over NMDS", ratio("small", "MDS, three eigenpairs")),
        ("SMDS over NMDS", ratio("small", "SMDS")),
        ("large SMDS over NMDS", ratio("large", "SMDS")),
        ("algebra share", algebra / total("large", "NMDS")),
    ]);
    for ((size, method), found) in &spent {
        note(&mut measured, &format!("{size} {method}"), [("seconds", found.total())]);
    }
    let tables = vec![Table::new("", headings, rows)];
    Ok(Record { figures: vec![figure], tables, ..context.record(&[], measured) })
}

/// The fastest of several runs.
fn fastest(context: &Context<'_>, shape: &LabeledSurface, method: EmbedMethod) -> Result<Spent> {
    // Long runs are hardly disturbed by others.
    let runs = if matches!(method, EmbedMethod::Nystrom { .. }) { context.options.runs } else { 2 };
    let options = FormOptions { method, ..low_rank(context.options.samples, context.options.rank, 0) };
    let mut best: Option<Spent> = None;
    for _ in 0..runs {
        let (embedded, peak_bytes) = with_peak_bytes(|| embed(&shape.surface, &options, &()));
        let seconds = embedded?.report.seconds;
        let run = Spent { seconds: [seconds.geodesics, seconds.embedding], peak_bytes };
        best = Some(best.filter(|best| best.total() <= run.total()).unwrap_or(run));
    }
    best.context("figure 9 needs at least one run")
}

/// Classical scaling with all eigenpairs.
fn full(shape: &LabeledSurface) -> Result<Spent> {
    let method = Method::default();
    let run = || -> Result<[f64; 2]> {
        let (all, geodesics) = timed(|| method.prepare(shape.surface.intrinsic(), &())?.distance_matrix())?;
        let (_, embedding) = timed(|| classical_full(&all, DIM))?;
        Ok([geodesics, embedding])
    };
    let (seconds, peak_bytes) = with_peak_bytes(run);
    Ok(Spent { seconds: seconds?, peak_bytes })
}
