//! `canonform compare`.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Result;
use canonform::collection::content_hash;
use canonform::compare::{ComparedMesh, FaceAgreement, MeshComparison, Residual, compare_meshes};
use canonform::descriptors::ShapeMetric;
use canonform::mesh::io::{Content, writable};
use canonform::relations::RelationKind;
use canonform::rigid::Handedness;
use serde::Serialize;

use crate::args::{Common, CompareArgs, PairArgs};
use crate::input::{file_name, is_stream, read_pair};
use crate::output::{check_format, check_output, facts, report, write_colored};

#[derive(Serialize)]
struct CompareJson {
    a: PathBuf,
    b: PathBuf,
    #[serde(flatten)]
    found: MeshComparison,
    residual: ResidualJson,
    threshold: Option<f64>,
    /// Whether the threshold is exceeded or the shapes are different; none without a threshold.
    failed: Option<bool>,
}

/// Distances from the vertices of the first shape to the second shape, in units of the first mesh.
#[derive(Serialize)]
struct ResidualJson {
    #[serde(flatten)]
    residual: Residual,
    /// Input vertex with the largest distance.
    max_vertex: u32,
    output: Option<PathBuf>,
}

/// What the two meshes are called: by their files, or by their paths if the files have one name.
fn names(PairArgs { a: path_a, b: path_b }: &PairArgs) -> [String; 2] {
    let [a, b] = [path_a, path_b].map(|path| file_name(path));
    match a == b {
        true => [path_a, path_b].map(|path| path.display().to_string()),
        false => [a, b],
    }
}

/// Embeds, aligns and compares two meshes.
pub(crate) fn compare(args: &CompareArgs, common: &Common) -> Result<ExitCode> {
    let options = args.form.options(&args.method, common)?;
    options.validate()?;
    if let Some(path) = &args.residual_mesh {
        check_format(path, "a coloured mesh", &writable(Content::Field).collect::<Vec<_>>())?;
        check_output(path)?;
    }
    let [a, b] =
        read_pair(&args.pair, &args.form.repair, &args.limits, common, |path, mesh, surface, bars| {
            let content = if is_stream(path) { None } else { Some(content_hash(path)?) };
            ComparedMesh::new(&mesh, content, surface, &options, bars)
        })?;
    let mut found = compare_meshes([a.compared(), b.compared()])?;
    if let Some(path) = &args.residual_mesh {
        write_colored(path, a.surface().mesh(), "residual", &found.overlay.residuals[0])?;
    }
    let [name_a, name_b] = names(&args.pair);
    found.relation = found.relation.named(&name_a, &name_b);
    let distance = found.comparison.shape_distance;
    let failed =
        args.threshold.map(|limit| found.comparison.normalized_distance > limit || distance.is_different());
    let kind = found.relation.kind;
    let is_alike = |kinds: &[RelationKind]| kind.is_one_surface() || kinds.contains(&kind);
    let not_alike = args.exit_code.is_some_and(|kinds| !is_alike(kinds));
    let json = CompareJson {
        a: args.pair.a.clone(),
        b: args.pair.b.clone(),
        residual: ResidualJson {
            residual: found.residual[0],
            max_vertex: a.surface().input_vertex(found.residual[0].max_point.into()).0,
            output: args.residual_mesh.clone(),
        },
        found,
        threshold: args.threshold,
        failed,
    };
    let code = report(common, &json, |json| text(json, &name_a, args.details))?;
    Ok(if failed == Some(true) || not_alike { ExitCode::from(1) } else { code })
}

/// The answer in one sentence, and what it rests on in a few lines.
fn text(json: &CompareJson, name_a: &str, details: bool) -> String {
    let relation = &json.found.relation;
    let (shape, [_, class]) = (ShapeMetric::SAME_SHAPE.at, ShapeMetric::SAME_CLASS.gap());
    let distance = json.found.comparison.shape_distance.combined;
    let limits = format!("probably one shape below {shape:.2}, not alike above {class:.2}");
    let times = format!("{:.4}", relation.evidence.scale);
    let size =
        if times == "1.0000" { "the same".to_owned() } else { format!("{times} times that of {name_a}") };
    let mut rows = vec![
        ("certainty", format!("{:.0} %", 100.0 * relation.confidence)),
        ("distance", format!("{distance:.2}, whatever pose and size: {limits}")),
        ("size", size),
    ];
    let (Residual { median, max, .. }, vertex) = (json.residual.residual, json.residual.max_vertex);
    match json.threshold {
        Some(limit) => rows.push(("threshold", threshold(json, limit))),
        None => {
            rows.push((
                "form",
                format!("differs most at vertex {vertex} of {name_a}, by {max:.4} mesh units"),
            ));
        }
    }
    let mut text = format!("{}.\n{}", base::one_line(&relation.to_string()), facts(&rows));
    if details {
        let residual = format!("median {median:.6}, maximum {max:.6} (at vertex {vertex}), mesh units");
        text = format!("{text}\n\n{}", facts(&detailed(json, residual)));
    }
    text
}

fn threshold(json: &CompareJson, limit: f64) -> String {
    let distance = json.found.comparison.normalized_distance;
    let held = match (distance > limit, json.failed == Some(true)) {
        (true, _) => "exceeded",
        (false, true) => "not exceeded, but the shapes are different",
        (false, false) => "not exceeded",
    };
    format!("{limit} {held}: the forms are {distance:.6} apart at equal size")
}

/// Everything else that was measured.
fn detailed(json: &CompareJson, residual: String) -> Vec<(&'static str, String)> {
    let (c, relation) = (&json.found.comparison, &json.found.relation);
    let handedness = match relation.evidence.handedness {
        Handedness::Same => "no",
        Handedness::Mirrored => "yes",
        Handedness::Either => "either: the shape is its own mirror image",
        Handedness::Unknown => "unknown: a mesh encloses no volume, or the forms do not fit",
    };
    let triangulation = match json.found.triangulation {
        Some(FaceAgreement::Same) => "the same faces",
        _ => "different faces",
    };
    let mut rows = vec![
        ("because", relation.reason()),
        (
            "distance of the forms",
            format!("{:.6} mesh units, {:.6} at equal size", c.distance, c.normalized_distance),
        ),
        ("by signatures alone", format!("{:.6}", c.shape_distance.fused)),
        ("scale, second over first", format!("{:.6}", c.scale)),
        ("mirror image", handedness.to_owned()),
        ("triangulation", triangulation.to_owned()),
        ("residual", residual),
        ("form reflected", if c.reflected { "yes" } else { "no" }.to_owned()),
    ];
    for (name, row) in ["rotation", "", ""].into_iter().zip(c.rotation) {
        rows.push((name, row.map(|x| format!("{x:>10.6}")).join(" ")));
    }
    rows.push(("translation", c.translation.map(|x| format!("{x:>10.4}")).join(" ")));
    rows
}
