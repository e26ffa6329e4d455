//! `canonform methods`.

use std::process::ExitCode;

use anyhow::Result;
use base::terminal::{Bars, with_peak_bytes};
use base::{Exceeded, object};
use canonform::embed::{
    EmbedMethod, Embedded, FormOptions, SecondsReport, SharedStress, StressOptions, StressReport, embed,
};
use canonform::geodesics::{Method, Sampling};
use canonform::nmds::{Regularization, RpiAlpha};
use canonform::settings::MethodSettings;
use canonform::{Error, Observer, Surface};
use serde::Serialize;

use super::embed::estimated;
use crate::args::{Common, MethodsArgs};
use crate::input::{named, read_surface};
use crate::output::{report, table_of};

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

/// Embeds a mesh by every method and tabulates the results.
pub(crate) fn methods(args: &MethodsArgs, common: &Common) -> Result<ExitCode> {
    let stress = StressOptions { choice: args.stress, against: None, seed: common.seed };
    let surface = read_surface(&args.mesh, &args.form.repair, common)?;
    let options = args.form.options(&MethodSettings::default(), common)?;
    let bars = Bars::with_budget(common.quiet, args.limits.budget());
    let methods = compared(&surface, &options, &stress, &bars).map_err(|fault| named(&args.mesh, fault))?;
    let stress = |m: &MethodJson| Some(m.facts.as_ref()?.stress.as_ref()?.value);
    let stresses = methods.iter().enumerate().filter_map(|(i, m)| Some((i, stress(m)?)));
    let best = stresses.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, _)| i);
    let json = object! {
        n_vertices: surface.n_input_vertices(),
        n_embedded: surface.mesh().n_vertices(),
        dim: options.dim,
        // The method that measured the distances, unless an entry says otherwise; the stress of all entries is measured
        // against it.
        geodesic: options.geodesic.name(),
        methods,
        // The entry of least stress.
        best,
        repair: &surface.input.report,
    };
    report(common, &json, |json| {
        let kind = json.methods.iter().find_map(|m| m.facts.as_ref()?.stress.as_ref());
        let kind = kind.map_or_else(String::new, |s| format!(", {:?}", s.kind).to_lowercase());
        table(&json.methods, json.best, common)
            + &format!(
                "\n* least stress. {} vertices, {} dimensions; the normalized stress is the relative error of the {} \
                 distances{kind}; seconds from the repaired mesh to the embedding",
                json.n_embedded, json.dim, json.geodesic
            )
    })
}

/// Embeds a surface by every method. One that cannot embed it reports its error and does not stop the others; if all fail, the
/// error of the first is returned. The stress does not count as time of a method.
fn compared(
    surface: &Surface,
    options: &FormOptions,
    stress: &StressOptions,
    observer: &dyn Observer,
) -> Result<Vec<MethodJson>, Error> {
    let shared = SharedStress::new(surface, options.geodesic, stress, observer)?;
    let (mut methods, mut first_error) = (Vec::new(), None);
    for (name, changed) in variants(options) {
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
    match first_error.filter(|_| methods.iter().all(|m| m.facts.is_none())) {
        Some(fault) => Err(fault),
        None => Ok(methods),
    }
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

/// The columns of a method, of which `--details` adds the last three.
const COLUMNS: [&str; 6] = ["normalized stress  ", "seconds", "memory", "samples", "stress", "negative mass"];

/// The values of a method as text. The least stress is marked with a star.
fn cells(facts: &MethodFacts, is_best: bool) -> [String; 6] {
    let normalized = facts.stress.as_ref().map(|s| estimated(s.normalized, s.normalized_interval, 4));
    [
        normalized.unwrap_or_else(|| "no unit".to_owned()) + if is_best { " *" } else { "  " },
        report::numbers::seconds(facts.seconds),
        report::numbers::bytes(facts.peak_bytes),
        facts.n_samples.to_string(),
        facts.stress.as_ref().map_or_else(String::new, |s| format!("{:.4}", s.value)),
        format!("{:.4}", facts.negative_mass),
    ]
}

/// One row per method, and the errors of those that failed.
fn table(methods: &[MethodJson], best: Option<usize>, common: &Common) -> String {
    let columns = &COLUMNS[..if common.details { COLUMNS.len() } else { 3 }];
    let mut table = table_of(["method", "options"].iter().chain(columns));
    let mut failures = String::new();
    for (i, MethodJson { method, options, facts, error }) in methods.iter().enumerate() {
        let values = facts.as_ref().map_or_else(
            || vec!["failed  ".to_owned()],
            |facts| cells(facts, best == Some(i))[..columns.len()].to_vec(),
        );
        let mut row = [vec![(*method).to_owned(), (*options).to_owned()], values].concat();
        row.resize(2 + columns.len(), String::new());
        table.add_row(row);
        failures.extend(error.as_ref().map(|error| format!("\n{method} {options} failed: {error}")));
    }
    for column in table.column_iter_mut().skip(2) {
        column.set_cell_alignment(comfy_table::CellAlignment::Right);
    }
    table.trim_fmt() + &failures
}
