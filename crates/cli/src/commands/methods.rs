//! `canonform methods`.

use std::process::ExitCode;
use std::time::Instant;

use super::embed::normalized_text;
use anyhow::Result;
use base::terminal::{Bars, with_peak_bytes};
use base::{Budget, Exceeded};
use canonform::embed::{
    DISTANCES_LIMIT, EmbedMethod, Embedded, FormOptions, Samples, SecondsReport, SharedStress, StressOptions,
    StressReport, embed,
};
use canonform::geodesics::{Method, Sampling};
use canonform::mesh::RepairReport;
use canonform::nmds::{Regularization, RpiAlpha};
use canonform::settings::MethodSettings;
use canonform::surface::VertexId;
use canonform::{Error, Observer, Surface};

use serde::Serialize;

use crate::args::{Common, MethodsArgs};
use crate::input::{named, read_surface};
use crate::output::{report, table_of};

/// Embeds a mesh by every method and tabulates the results.
pub(crate) fn methods(args: &MethodsArgs, common: &Common) -> Result<ExitCode> {
    let stress = StressOptions { choice: args.stress, against: None, seed: common.seed };
    let surface = read_surface(&args.mesh, &args.form.repair, common)?;
    let options = args.form.options(&MethodSettings::default(), common)?;
    let bars = Bars::with_budget(common.quiet, args.limits.budget());
    let methods = compared(&surface, &options, &stress, &bars).map_err(|fault| named(&args.mesh, fault))?;
    report(common, &methods, |methods| table(methods, common))
}

/// The results of every method on one surface.
#[derive(Serialize)]
struct MethodsJson {
    n_vertices: usize,
    n_embedded: usize,
    dim: usize,
    /// The method that measured the distances, unless an entry says otherwise; the stress of all entries is measured against
    /// it.
    geodesic: &'static str,
    methods: Vec<MethodJson>,
    /// The entry of least stress.
    best: Option<usize>,
    repair: RepairReport,
}

#[derive(Serialize)]
struct MethodJson {
    method: &'static str,
    /// The options that select a variant.
    options: &'static str,
    #[serde(flatten)]
    facts: Option<MethodFacts>,
    error: Option<String>,
}

#[derive(Serialize)]
struct MethodFacts {
    /// Unless the coordinates have no unit.
    stress: Option<StressReport>,
    negative_mass: f64,
    n_samples: usize,
    geodesics_seconds: f64,
    embedding_seconds: f64,
    seconds: f64,
    peak_bytes: usize,
}

/// Embeds a surface by every method. One that cannot embed it reports its error and does not stop the others; if all fail, the
/// error of the first is returned. The stress does not count as time of a method.
fn compared(
    surface: &Surface,
    options: &FormOptions,
    stress: &StressOptions,
    observer: &dyn Observer,
) -> Result<MethodsJson, Error> {
    let variants = variants(options);
    announce(surface, options, &variants, &observer.budget())?;
    let shared = SharedStress::new(surface, options.geodesic, stress, observer)?;
    let (mut methods, mut first_error) = (Vec::new(), None);
    for (name, changed) in variants {
        let (embedded, peak_bytes) = with_peak_bytes(|| embed(surface, &changed, observer));
        let (facts, error) = match embedded {
            Ok(Embedded { embedding, report, .. }) => {
                let stress =
                    changed.method.has_unit().then(|| shared.measure(&embedding.coords)).transpose()?;
                let SecondsReport { geodesics, embedding, .. } = report.seconds;
                let facts = MethodFacts {
                    stress,
                    negative_mass: report.negative_mass,
                    n_samples: report.n_samples,
                    geodesics_seconds: geodesics,
                    embedding_seconds: embedding,
                    seconds: geodesics + embedding,
                    peak_bytes,
                };
                (Some(facts), None)
            }
            Err(fault @ Error::Exceeded(Exceeded::Cancelled)) => return Err(fault),
            Err(fault) => {
                let text = fault.to_string();
                first_error.get_or_insert(fault);
                (None, Some(text))
            }
        };
        methods.push(MethodJson { method: changed.method.name(), options: name, facts, error });
    }
    if let Some(fault) = first_error.filter(|_| methods.iter().all(|m| m.facts.is_none())) {
        return Err(fault);
    }
    let stress = |m: &MethodJson| m.facts.as_ref().and_then(|f| f.stress.as_ref()).map(|s| s.value);
    let stresses = methods.iter().enumerate().filter_map(|(i, m)| stress(m).map(|s| (i, s)));
    let best = stresses.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, _)| i);
    Ok(MethodsJson {
        n_vertices: surface.n_input_vertices(),
        n_embedded: surface.mesh().n_vertices(),
        dim: options.dim,
        geodesic: options.geodesic.name(),
        methods,
        best,
        repair: surface.input.report.clone(),
    })
}

/// Most samples that `auto` takes.
const MOST_AUTO: usize = 640;

/// Seconds of distances beyond which they are announced.
const WORTH_ANNOUNCING: f64 = 10.0;

/// Times one run of the solver and announces how long all of them will take.
fn announce(
    surface: &Surface,
    options: &FormOptions,
    variants: &[(&'static str, FormOptions)],
    budget: &Budget,
) -> Result<(), Error> {
    let p = surface.mesh().n_vertices();
    let solver = options.geodesic.prepare(surface.intrinsic(), budget)?;
    let start = Instant::now();
    solver.distances(VertexId(0))?;
    let one = start.elapsed().as_secs_f64();
    let samples = match options.samples {
        Samples::Count(n) => n.min(p),
        Samples::Auto => p.min(MOST_AUTO),
    };
    let fits = p.saturating_mul(p).saturating_mul(size_of::<f64>()) <= DISTANCES_LIMIT;
    let runs = |options: &FormOptions| match options.method.is_sampled() {
        true => samples,
        false if fits => p,
        false => 0,
    };
    let runs: usize = variants.iter().map(|(_, options)| runs(options)).sum();
    let seconds = runs as f64 * one / rayon::current_num_threads() as f64;
    if seconds > WORTH_ANNOUNCING {
        base::terminal::note(&format!(
            "about {} s for distances ({runs} runs of {} s), besides the embeddings; -n with fewer samples takes less",
            report::numbers::seconds(seconds),
            report::numbers::seconds(one)
        ));
    }
    Ok(())
}

/// Every method, and the variants of the first one by the options that select them.
fn variants(shared: &FormOptions) -> Vec<(&'static str, FormOptions)> {
    let of = |method| FormOptions { method, ..shared.clone() };
    let nmds = |regularization| of(EmbedMethod::Nystrom { regularization });
    let sampled = |sampling| FormOptions { sampling, ..shared.clone() };
    let mut all = vec![
        ("", shared.clone()),
        ("--regularization rpi", nmds(Regularization::Rpi { alpha: RpiAlpha::default() })),
        ("--regularization rpi --alpha paper", nmds(Regularization::Rpi { alpha: RpiAlpha::Paper })),
        ("--regularization none", nmds(Regularization::None)),
        ("--regularization cur", nmds(Regularization::Cur { rank: None })),
        ("--sampling random", sampled(Sampling::Random)),
        ("--sampling min-variance", sampled(Sampling::MinVariance)),
        ("--geodesic bfs", FormOptions { geodesic: Method::BreadthFirst, ..shared.clone() }),
    ];
    let others = EmbedMethod::all().into_iter().filter(|method| *method != EmbedMethod::default());
    all.extend(others.map(|method| ("", of(method))));
    all
}

/// A column: its name, the value of a method as text, and as a number if the lowest one is marked.
struct Column {
    name: &'static str,
    text: fn(&MethodFacts) -> String,
    marked: Option<fn(&MethodFacts) -> Option<f64>>,
    is_detail: bool,
}

const COLUMNS: [Column; 6] = [
    Column {
        name: "normalised stress  ",
        text: |f| f.stress.as_ref().map_or_else(|| "no unit".to_owned(), normalized_text),
        marked: Some(|f| f.stress.as_ref().map(|s| s.normalized)),
        is_detail: false,
    },
    Column {
        name: "seconds  ",
        text: |f| report::numbers::seconds(f.seconds),
        marked: Some(|f| Some(f.seconds)),
        is_detail: false,
    },
    Column {
        name: "memory  ",
        text: |f| report::numbers::bytes(f.peak_bytes),
        marked: Some(|f| Some(f.peak_bytes as f64)),
        is_detail: false,
    },
    Column { name: "samples", text: |f| f.n_samples.to_string(), marked: None, is_detail: true },
    Column {
        name: "stress  ",
        text: |f| f.stress.as_ref().map_or_else(String::new, |s| format!("{:.4}", s.value)),
        marked: Some(|f| f.stress.as_ref().map(|s| s.value)),
        is_detail: true,
    },
    Column {
        name: "negative mass",
        text: |f| format!("{:.4}", f.negative_mass),
        marked: None,
        is_detail: true,
    },
];

/// One row per method, with a star at the lowest value of a column.
fn table(report: &MethodsJson, common: &Common) -> String {
    let columns: Vec<&Column> = COLUMNS.iter().filter(|c| common.details || !c.is_detail).collect();
    let facts = || report.methods.iter().filter_map(|m| m.facts.as_ref());
    let least =
        |column: &&Column| column.marked.map(|value| facts().filter_map(value).fold(f64::INFINITY, f64::min));
    let best: Vec<Option<f64>> = columns.iter().map(least).collect();

    let header = ["method", "options"].into_iter().chain(columns.iter().map(|column| column.name));
    let mut table = table_of(header);
    for method in &report.methods {
        let cell = |(column, best): (&&Column, &Option<f64>)| match (&method.facts, column.marked) {
            (None, _) => String::new(),
            (Some(facts), None) => (column.text)(facts),
            (Some(facts), Some(value)) => {
                let star = if value(facts).is_some() && value(facts) == *best { " *" } else { "  " };
                (column.text)(facts) + star
            }
        };
        let mut row = vec![method.method.to_owned(), method.options.to_owned()];
        row.extend(columns.iter().zip(&best).map(cell));
        if method.facts.is_none() {
            row[2] = "failed  ".to_owned();
        }
        table.add_row(row);
    }
    for column in table.column_iter_mut().skip(2) {
        column.set_cell_alignment(comfy_table::CellAlignment::Right);
    }
    let mut text = table.trim_fmt();
    for method in &report.methods {
        if let Some(error) = &method.error {
            text += &format!("\n{} {} failed: {error}", method.method, method.options);
        }
    }
    let kind = facts().find_map(|facts| facts.stress.as_ref());
    let kind = kind.map_or_else(String::new, |s| format!(", {:?}", s.kind).to_lowercase());
    text + &format!(
        "\n* lowest of its column. {} vertices, {} dimensions; the normalised stress is the relative error of the {} \
         distances{kind}; seconds from the repaired mesh to the embedding",
        report.n_embedded, report.dim, report.geodesic
    )
}
