//! Building a field.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use anyhow::Result;
use base::terminal::Bars;
use canonform::fields::{DistanceField, FieldBounds, FieldFacts, FieldOptions};
use canonform::mesh::RepairReport;
use serde::Serialize;

use crate::args::{Common, FieldBuildArgs, geodesic_method};
use crate::input::{named, read_surface};
use crate::output::{Answer, check_output, report};

#[derive(Serialize)]
struct BuildJson {
    output: PathBuf,
    #[serde(flatten)]
    facts: FieldFacts,
    seconds: Seconds,
    repair: RepairReport,
}

#[derive(Serialize)]
struct Seconds {
    load: f64,
    repair: f64,
    build: f64,
    write: f64,
}

/// Builds, writes and reports a field.
pub(super) fn build(args: &FieldBuildArgs, common: &Common) -> Result<ExitCode> {
    check_output(&args.output)?;
    let method = geodesic_method(&args.marching, args.method)?;
    let surface = read_surface(&args.mesh, &args.repair, common)?;
    let options = FieldOptions { method, landmarks: args.landmarks, rank: args.rank };
    let observer = Bars::with_budget(common.quiet, args.limits.budget());
    let start = Instant::now();
    let field = DistanceField::build(&surface, &options, &observer)
        .map_err(|fault| named(&args.mesh, fault.into()))?;
    let built = start.elapsed().as_secs_f64();
    field.save(&args.output)?;
    let seconds = Seconds {
        load: surface.input.load_seconds,
        repair: surface.input.repair_seconds,
        build: built,
        write: start.elapsed().as_secs_f64() - built,
    };
    let (output, repair) = (args.output.clone(), surface.input.report.clone());
    report(common, &BuildJson { output, facts: field.facts(), seconds, repair }, |json| {
        let mut answer = answer(&json.output, &json.facts);
        let Seconds { load, repair, build, write } = json.seconds;
        answer.facts.push(("seconds", format!("{:.3}", load + repair + build + write)));
        answer.text(common)
    })
}

#[derive(Serialize)]
struct InfoJson<'a> {
    field: &'a Path,
    #[serde(flatten)]
    facts: FieldFacts,
    landmarks: Vec<canonform::surface::VertexId>,
}

/// Reports how a field was built.
pub(super) fn info(path: &Path, common: &Common) -> Result<ExitCode> {
    let field = DistanceField::open(path).map_err(canonform::Error::from)?;
    let json = InfoJson { field: path, facts: field.facts(), landmarks: field.landmarks() };
    report(common, &json, |json| answer(path, &json.facts).text(common))
}

fn answer(path: &Path, facts: &FieldFacts) -> Answer {
    let bounds = match facts.bounds {
        FieldBounds::Certified => "certified: exact distances from all landmarks".to_owned(),
        FieldBounds::Measured { over, under, exact_columns } => format!(
            "measured: widened by errors of {over:.4} too long and {under:.4} too short; {exact_columns} columns are exact"
        ),
    };
    let (path, n, size) = (path.display(), facts.n_vertices, facts.bytes as f64 / 1e6);
    Answer {
        sentence: format!("{path} holds the distances between all pairs of {n} vertices in {size:.2} MB"),
        facts: vec![("bounds", bounds)],
        details: vec![
            ("method", facts.method.to_owned()),
            ("landmarks, rank", format!("{}, {}", facts.n_landmarks, facts.rank)),
            ("covering radius", format!("{:.4}", facts.covering_radius)),
        ],
    }
}
