//! `canonform compare`.

use std::process::ExitCode;

use anyhow::Result;
use base::object;
use canonform::collection::content_hash;
use canonform::compare::{ComparedMesh, FaceAgreement, MeshComparison, Residual, compare_meshes};
use canonform::descriptors::ShapeMetric;
use canonform::mesh::io::{Content, writable};
use canonform::relations::in_four_digits;
use canonform::rigid::Handedness;

use crate::args::{Common, CompareArgs, PairArgs};
use crate::input::{file_name, is_stream, read_pair};
use crate::output::{Fact, check_output, facts, report, write_colored};

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
        check_output(path, "a colored mesh", &writable(Content::Field).collect::<Vec<_>>())?;
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
    let not_alike = args.exit_code.is_some_and(|kinds| !kind.is_one_surface() && !kinds.contains(&kind));
    let (residual, form) = (found.overlay.residual()[0], &found.comparison);
    let max_vertex = a.surface().input_vertex(residual.max_point.into()).0;
    let relation = &found.relation;
    let (shape, [_, class]) = (ShapeMetric::SAME_SHAPE.at, ShapeMetric::SAME_CLASS.gap());
    let size = match &*factor(relation.evidence.scale, 4) {
        "1.0000" => "the same".to_owned(),
        times => format!("{times} times that of {name_a}"),
    };
    let limits = format!("probably one shape below {shape:.2}, not alike above {class:.2}");
    let last = match args.threshold {
        Some(limit) => {
            let held = match (form.normalized_distance > limit, failed == Some(true)) {
                (true, _) => "exceeded",
                (false, true) => "not exceeded, but the shapes are different",
                (false, false) => "not exceeded",
            };
            let apart = form.normalized_distance;
            ("threshold", format!("{limit} {held}: the forms are {apart:.6} apart at equal size"))
        }
        None => (
            "form",
            format!("differs most at vertex {max_vertex} of {name_a}, by {:.4} mesh units", residual.max),
        ),
    };
    let rows = [
        ("certainty", format!("{:.0} %", 100.0 * relation.confidence)),
        ("distance", format!("{:.2}, whatever pose and size: {limits}", distance.combined)),
        ("size", size),
        last,
    ];
    let mut text = format!("{}.\n{}", base::one_line(&relation.to_string()), facts(&rows));
    if common.details {
        text += &format!("\n\n{}", facts(&detailed(&found, max_vertex)));
    }
    let json = object! {
        a: &args.pair.a,
        b: &args.pair.b,
        #[serde(flatten)]
        found: &found,
        // Distances from the vertices of the first shape to the second shape, in units of the first mesh.
        residual: object! {
            #[serde(flatten)]
            residual,
            // The input vertex with the largest distance.
            max_vertex,
            output: &args.residual_mesh,
        },
        threshold: args.threshold,
        // Whether the threshold is exceeded or the shapes are different; none without a threshold.
        failed,
    };
    let code = report(common, &json, |_| text)?;
    Ok(if failed == Some(true) || not_alike { ExitCode::from(1) } else { code })
}

/// A factor with so many decimals; a small one by its digits.
fn factor(x: f64, decimals: usize) -> String {
    if x < 1e-3 { in_four_digits(x) } else { format!("{x:.decimals$}") }
}

/// Everything else that was measured.
fn detailed(found: &MeshComparison, vertex: u32) -> Vec<Fact> {
    let (c, relation) = (&found.comparison, &found.relation);
    let Residual { median, max, .. } = found.overlay.residual()[0];
    let handedness = match relation.evidence.handedness {
        Handedness::Same => "no",
        Handedness::Mirrored => "yes",
        Handedness::Either => "either: the shape is its own mirror image",
        Handedness::Unknown => "unknown: a mesh encloses no volume, or the forms do not fit",
    };
    let triangulation = match found.triangulation {
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
        ("scale, second over first", factor(c.scale, 6)),
        ("mirror image", handedness.to_owned()),
        ("triangulation", triangulation.to_owned()),
        ("residual", format!("median {median:.6}, maximum {max:.6} (at vertex {vertex}), mesh units")),
        ("form reflected", if c.reflected { "yes" } else { "no" }.to_owned()),
    ];
    for (name, row) in ["rotation", "", ""].into_iter().zip(c.rotation) {
        rows.push((name, row.map(|x| format!("{x:>10.6}")).join(" ")));
    }
    rows.push(("translation", c.translation.map(|x| format!("{x:>10.4}")).join(" ")));
    rows
}
