//! `canonform compare`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Result, bail};
use canonform::descriptors::{Handedness, ShapeMetric, Verdict, VerdictKind};
use canonform::{
    ComparedMesh, FormOptions, MeshComparison, Residual, Triangulation, compare_meshes, content_hash,
};
use mesh::io::{Content, writable};
use serde::Serialize;

use crate::args::{Common, CompareArgs};
use crate::input::{file_name, is_stream, named, print_repair, read_both};
use crate::output::{check_folder, check_format, facts, report, write_colored};
use terminal::Bars;

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

fn side(path: &Path, args: &CompareArgs, options: &FormOptions, common: &Common) -> Result<ComparedMesh> {
    let (mesh, surface) = read_both(path, &args.embedding.form.repair, common)?;
    print_repair(&file_name(path), &surface.repaired.report, &args.embedding.form.repair);
    let content = if is_stream(path) { None } else { Some(content_hash(path)?) };
    let bars = Bars::with_budget(common.quiet, args.limits.budget());
    ComparedMesh::new(&mesh, content, surface, options, &bars).map_err(|fault| named(path, fault))
}

/// What the two meshes are called: by their files, or by their paths if the files have one name.
fn names(args: &CompareArgs) -> [String; 2] {
    let [a, b] = [&args.a, &args.b].map(|path| file_name(path));
    match a == b {
        true => [&args.a, &args.b].map(|path| path.display().to_string()),
        false => [a, b],
    }
}

/// Embeds, aligns and compares two meshes.
pub(crate) fn compare(args: &CompareArgs, common: &Common) -> Result<ExitCode> {
    let options = args.embedding.options(common)?;
    options.validate()?;
    if is_stream(&args.a) && is_stream(&args.b) {
        bail!("standard input can be read only once; give `-` for one mesh");
    }
    if let Some(path) = &args.residual_mesh {
        check_format(path, "a coloured mesh", &writable(Content::Field).collect::<Vec<_>>())?;
        check_folder(path)?;
    }
    let [a, b] = [side(&args.a, args, &options, common)?, side(&args.b, args, &options, common)?];
    let mut found = compare_meshes(ShapeMetric { distance: args.distance }, [&a, &b])?;
    if let Some(path) = &args.residual_mesh {
        write_colored(path, a.surface().mesh(), "residual", &found.overlay.residuals[0])?;
    }
    let [name_a, name_b] = names(args);
    found.evidence = found.evidence.named(&name_a, &name_b);
    let verdict = found.comparison.verdict;
    let failed = args
        .threshold
        .map(|limit| found.comparison.normalized_distance > limit || verdict.kind == VerdictKind::Different);
    let not_alike = args.exit_code.is_some_and(|least| !is_at_least(&verdict, least));
    let json = CompareJson {
        a: args.a.clone(),
        b: args.b.clone(),
        residual: ResidualJson {
            residual: found.residual,
            max_vertex: found.max_vertex.0,
            output: args.residual_mesh.clone(),
        },
        found,
        threshold: args.threshold,
        failed,
    };
    let code = report(common, &json, table)?;
    Ok(if failed == Some(true) || not_alike { ExitCode::from(1) } else { code })
}

/// Whether a verdict is firm and at least this alike. Below the gap between one class and different ones, the shapes are
/// of one class, whether they are one shape or not.
fn is_at_least(verdict: &Verdict, least: VerdictKind) -> bool {
    match least {
        VerdictKind::SameClass => verdict.is_same_class(),
        least => verdict.kind == least,
    }
}

fn table(json: &CompareJson) -> String {
    let (c, evidence) = (&json.found.comparison, &json.found.evidence);
    let limit = match c.same_below {
        0.0 => "the signatures alone are too far apart for one class".to_owned(),
        limit => format!("with these signatures, different from {limit:.6} on"),
    };
    let handedness = match c.handedness {
        Handedness::Same => "no",
        Handedness::Mirrored => "yes",
        Handedness::Either => "either: the shape is its own mirror image",
        Handedness::Unknown => "unknown: a mesh encloses no volume, or the forms do not match",
    };
    let triangulation = match json.found.triangulation {
        Triangulation::Same => "the same faces",
        Triangulation::Other => "different faces",
    };
    let (Residual { median, max, .. }, vertex) = (json.residual.residual, json.residual.max_vertex);
    let residual = format!("median {median:.6}, maximum {max:.6} (at vertex {vertex}), mesh units");
    let mut rows = vec![
        ("match", evidence.to_string()),
        ("confidence", format!("{:.2}", evidence.confidence)),
        ("because", evidence.reason()),
        ("shape", c.verdict.to_string()),
        ("by distance", c.verdict.reason()),
        ("distance of the forms", format!("{:.6} mesh units", c.distance)),
        ("at equal size", format!("{:.6} ({limit})", c.normalized_distance)),
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
    if let Some(limit) = json.threshold {
        let held = match (c.normalized_distance > limit, json.failed == Some(true)) {
            (true, _) => "exceeded",
            (false, true) => "not exceeded, but the shapes are different",
            (false, false) => "not exceeded",
        };
        rows.push(("threshold", format!("{limit} {held}")));
    }
    facts(&rows)
}
