//! `canonform compare`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Result, bail};
use canonform::descriptors::{
    CanonicalForm, Handedness, PreparedShape, ShapeMetric, ShapePair, Verdict, VerdictKind,
};
use canonform::{
    Comparison, DescribeOptions, FormOptions, MatchEvidence, MeshGeometry, Residual, ShapeDescription,
    Surface, SurfaceComparison, Triangulation, compare_surfaces, content_hash, describe_within, embed,
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
    /// What kind of match the meshes are.
    evidence: MatchEvidence,
    #[serde(flatten)]
    comparison: Comparison,
    triangulation: Triangulation,
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

/// One of the two meshes.
struct Side {
    surface: Surface,
    /// The mesh in space, with the hash of its file.
    geometry: Option<MeshGeometry>,
    /// The form of all vertices.
    form: CanonicalForm,
    /// The shape with this form.
    shape: PreparedShape,
    /// The shape made with the options that the metric is calibrated for, if those differ.
    usual: Option<PreparedShape>,
}

fn side(path: &Path, args: &CompareArgs, options: &FormOptions, common: &Common) -> Result<Side> {
    let (mesh, surface) = read_both(path, &args.embedding.form.repair, common)?;
    print_repair(&file_name(path), &surface.repaired.report, &args.embedding.form.repair);
    let content = if is_stream(path) { None } else { Some(content_hash(path)?) };
    let geometry = MeshGeometry::new(&mesh, content);
    drop(mesh);
    let usual = FormOptions { repair: options.repair, ..FormOptions::default() };
    let usual = DescribeOptions { form: usual, ..DescribeOptions::default() };
    let measure = || {
        let budget = args.limits.budget();
        let refined = surface.for_description_within(&budget)?;
        let embedded = embed(&refined, options, &Bars::with_budget(common.quiet, budget.clone()))?;
        let form = embedded.form(&refined)?.leading(surface.mesh().vertex_areas())?;
        if embedded.options == usual.form {
            return Ok((form, ShapeDescription::new(&refined, &embedded, &usual)?.prepare()?, None));
        }
        let description = describe_within(&surface, &usual, &budget)?;
        let (fused, area) = (description.fused.clone(), Some(description.area));
        let shape = PreparedShape::new(fused, &form.reduced(usual.points), area)?;
        Ok((form, shape, Some(description.prepare()?)))
    };
    let (form, shape, usual) = measure().map_err(|fault| named(path, fault))?;
    Ok(Side { surface, geometry, form, shape, usual })
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
    let metric = ShapeMetric { distance: args.distance };
    let [a, b] = [side(&args.a, args, &options, common)?, side(&args.b, args, &options, common)?];
    let pair = ShapePair::new(metric, [&a.shape, &b.shape]);
    // The verdict must not depend on the options.
    let distance = match (&a.usual, &b.usual) {
        (Some(a), Some(b)) => ShapePair::new(metric, [a, b]).distance(),
        _ => pair.distance(),
    };
    let SurfaceComparison { comparison, triangulation, overlay } =
        compare_surfaces(&pair, distance, [(&a.surface, &a.form), (&b.surface, &b.form)])?;
    if let Some(path) = &args.residual_mesh {
        write_colored(path, a.surface.mesh(), "residual", &overlay.residuals[0])?;
    }
    let evidence = match (&a.geometry, &b.geometry) {
        (Some(a), Some(b)) => MatchEvidence::new([a, b], comparison.verdict),
        _ => MatchEvidence::of_shapes([None, None], comparison.verdict),
    };
    let [name_a, name_b] = names(args);
    let [residual, _] = overlay.residual();
    let max_vertex = a.surface.input_vertex(residual.max_point.into()).0;
    let residual = ResidualJson { residual, max_vertex, output: args.residual_mesh.clone() };
    let failed = args.threshold.map(|limit| {
        comparison.normalized_distance > limit || comparison.verdict.kind == VerdictKind::Different
    });
    let not_alike = args.exit_code.is_some_and(|least| !is_at_least(&comparison.verdict, least));
    let json = CompareJson {
        a: args.a.clone(),
        b: args.b.clone(),
        evidence: evidence.named(&name_a, &name_b),
        comparison,
        triangulation,
        residual,
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
    let c = &json.comparison;
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
    let triangulation = match json.triangulation {
        Triangulation::Same => "the same faces",
        Triangulation::Other => "different faces",
    };
    let (Residual { median, max, .. }, vertex) = (json.residual.residual, json.residual.max_vertex);
    let residual = format!("median {median:.6}, maximum {max:.6} (at vertex {vertex}), mesh units");
    let mut rows = vec![
        ("match", json.evidence.to_string()),
        ("confidence", format!("{:.2}", json.evidence.confidence)),
        ("because", json.evidence.reason()),
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
