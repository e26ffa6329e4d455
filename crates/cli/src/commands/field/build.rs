//! Building a field.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use anyhow::Result;
use canonform::{DistanceField, FieldBounds, FieldFacts, FieldOptions};
use mesh::RepairReport;
use serde::Serialize;
use terminal::Bars;

use crate::args::{Common, FieldBuildArgs};
use crate::input::{named, read_surface};
use crate::output::{check_folder, facts, report};

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
    check_folder(&args.output)?;
    let surface = read_surface(&args.mesh, &args.repair, common)?;
    let method = args.marching.of(args.method);
    let options = FieldOptions { method, landmarks: args.landmarks, rank: args.rank };
    let observer = Bars::with_budget(common.quiet, args.limits.budget());
    let start = Instant::now();
    let field =
        DistanceField::build(&surface, &options, &observer).map_err(|fault| named(&args.mesh, fault))?;
    let built = start.elapsed().as_secs_f64();
    field.save(&args.output)?;
    let seconds = Seconds {
        load: surface.load_seconds,
        repair: surface.repair_seconds,
        build: built,
        write: start.elapsed().as_secs_f64() - built,
    };
    let (output, repair) = (args.output.clone(), surface.repaired.report.clone());
    report(common, &BuildJson { output, facts: field.facts(), seconds, repair }, |json| {
        let mut lines = lines_of(&json.facts);
        let Seconds { load, repair, build, write } = json.seconds;
        let total = load + repair + build + write;
        lines.push(("seconds", format!("{total:.3} (build {build:.3})")));
        lines.push(("wrote", json.output.display().to_string()));
        self::facts(&lines)
    })
}

#[derive(Serialize)]
struct InfoJson<'a> {
    field: &'a Path,
    #[serde(flatten)]
    facts: FieldFacts,
    landmarks: Vec<surface::VertexId>,
}

/// Reports how a field was built.
pub(super) fn info(path: &Path, common: &Common) -> Result<ExitCode> {
    let field = DistanceField::open(path)?;
    let json = InfoJson { field: path, facts: field.facts(), landmarks: field.landmarks() };
    report(common, &json, |json| self::facts(&lines_of(&json.facts)))
}

fn lines_of(facts: &FieldFacts) -> Vec<(&'static str, String)> {
    let bounds = match facts.bounds {
        FieldBounds::Certified => "certified: exact distances from all landmarks".to_owned(),
        FieldBounds::Measured { over, under, exact_columns } => format!(
            "measured: widened by errors of {over:.4} too long and {under:.4} too short; {exact_columns} columns are exact"
        ),
    };
    vec![
        ("method", facts.method.to_owned()),
        ("vertices", facts.n_vertices.to_string()),
        ("landmarks, rank", format!("{}, {}", facts.n_landmarks, facts.rank)),
        ("covering radius", format!("{:.4}", facts.covering_radius)),
        ("bounds", bounds),
        ("size", format!("{:.2} MB", facts.bytes as f64 / 1e6)),
    ]
}
