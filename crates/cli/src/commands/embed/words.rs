//! What is said of forms.

use std::path::PathBuf;

use canonform::embed::EmbedReport;
use canonform::mesh::InputPoint;
use canonform::nmds::SampleStop;
use serde::Serialize;

use crate::output::{Answer, shown, word};

/// A form that was written.
#[derive(Serialize)]
pub(super) struct EmbedJson {
    #[serde(flatten)]
    pub(super) report: EmbedReport,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) points: Vec<PointJson>,
    /// Whether the output is the mesh bent into its form.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub(super) features: bool,
    pub(super) output: PathBuf,
}

/// A point of the surface in the form.
#[derive(Serialize)]
pub(super) struct PointJson {
    pub(super) at: InputPoint,
    pub(super) coordinates: Vec<f64>,
}

/// Warns about dimensions without a positive eigenvalue.
pub(super) fn warn(name: &str, report: &EmbedReport) {
    if report.empty_dimensions > 0 {
        base::terminal::note(&format!(
            "{name}: {} of {} dimensions have no positive eigenvalue and are zero; take more samples with -n",
            report.empty_dimensions, report.dim
        ));
    }
}

/// A number, with its interval if it is estimated.
pub(crate) fn estimated(value: f64, [low, high]: [f64; 2], digits: usize) -> String {
    match low == high {
        true => format!("{value:.digits$}"),
        false => format!("{value:.digits$} (95 %: {low:.digits$} to {high:.digits$})"),
    }
}

/// The stress, and the normalized stress.
pub(super) fn stresses(report: &EmbedReport) -> [String; 2] {
    match &report.stress {
        None => ["-"; 2].map(str::to_owned),
        Some(s) => [estimated(s.value, s.interval, 6), estimated(s.normalized, s.normalized_interval, 4)],
    }
}

/// The number of samples and the rank, and how they were found.
fn samples_text(report: &EmbedReport) -> String {
    let numbers = format!("{}, {}", report.n_samples, report.rank);
    let Some(search) = &report.auto else { return numbers };
    let why = match search.stop {
        SampleStop::Settled => format!("{} are within 1 %", search.sufficient),
        SampleStop::AllPoints => "all vertices".to_owned(),
        SampleStop::Limit => "the most that are taken".to_owned(),
    };
    format!("{numbers} ({why}; chosen on {} rows)", search.rows)
}

/// The method and its options.
fn method_text(report: &EmbedReport) -> String {
    let regularization = report.regularization.map_or(String::new(), |name| format!(" ({name})"));
    let sampling = report.sampling.map_or(String::new(), |name| format!(", {name} samples"));
    let descent = report
        .descent
        .as_ref()
        .map_or(String::new(), |descent| format!(", {} steps ({})", descent.iterations, word(descent.stop)));
    format!("{}{regularization} on {} distances{sampling}{descent}", report.method, report.geodesic)
}

pub(super) fn answer(json: &EmbedJson) -> Answer {
    let r = &json.report;
    let (output, n_vertices) = (shown(&json.output), r.n_vertices);
    let off = r.stress.as_ref().filter(|_| !json.features).map_or_else(String::new, |stress| {
        let [low, high] = stress.normalized_interval.map(|end| 100.0 * end);
        let interval = if low < high { format!(" ({low:.1} to {high:.1} %)") } else { String::new() };
        let off = 100.0 * stress.normalized;
        format!("; its distances differ from those along the surface by {off:.1} %{interval}")
    });
    let [stress, normalized] = stresses(r);
    let eigenvalues: Vec<String> = r.eigenvalues.iter().take(r.dim).map(|v| format!("{v:.5e}")).collect();
    let places = json.points.iter().map(|point| {
        let coordinates: Vec<String> = point.coordinates.iter().map(|x| format!("{x:.6}")).collect();
        ("point", format!("{} at {}", point.at, coordinates.join(" ")))
    });
    let facts = [
        ("method", method_text(r)),
        ("normalized stress", normalized),
        ("seconds", format!("{:.3}", r.seconds.total)),
    ];
    Answer {
        sentence: match json.features {
            true => format!("{output} holds the mesh of {n_vertices} vertices, bent into its canonical form"),
            false => format!("{output} holds the canonical form of {n_vertices} vertices{off}"),
        },
        facts: facts.into_iter().chain(places).collect(),
        details: vec![
            ("vertices, faces", format!("{}, {}", r.n_vertices, r.n_faces)),
            ("samples, rank", samples_text(r)),
            ("eigenvalues", eigenvalues.join(" ")),
            ("negative mass", format!("{:.4}", r.negative_mass)),
            ("stress", stress),
            ("seconds for distances", format!("{:.3}", r.seconds.geodesics)),
            ("seconds for embedding", format!("{:.3}", r.seconds.embedding)),
            ("seconds for stress", format!("{:.3}", r.seconds.stress)),
        ],
    }
}
