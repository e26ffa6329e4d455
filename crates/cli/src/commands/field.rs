//! `canonform field`: fields, facts about them, and distances.

use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

use anyhow::Result;
use base::object;
use base::terminal::Bars;
use canonform::fields::{DistanceField, FieldBounds, FieldFacts, FieldOptions, PairDistance, PairKind};
use canonform::surface::VertexId;

use crate::args::{Common, FieldBuildArgs, FieldCommand, FieldQueryArgs, geodesic_method};
use crate::input::{named, read_surface};
use crate::output::{Answer, check_output, report, word};
use crate::table::{read_pairs, write_npy};

pub(crate) fn field(command: &FieldCommand, common: &Common) -> Result<ExitCode> {
    match command {
        FieldCommand::Build(args) => build(args, common),
        FieldCommand::Query(args) => query(args, common),
        FieldCommand::Info { field } => info(field, common),
    }
}

/// Builds, writes and reports a field.
fn build(args: &FieldBuildArgs, common: &Common) -> Result<ExitCode> {
    check_output(&args.output, "a field", &[])?;
    let method = geodesic_method(&args.marching, args.method)?;
    let surface = read_surface(&args.mesh, &args.repair, common)?;
    let options = FieldOptions { method, landmarks: args.landmarks, rank: args.rank };
    let observer = Bars::with_budget(common.quiet, args.limits.budget());
    let start = Instant::now();
    let field = DistanceField::build(&surface, &options, &observer)
        .map_err(|fault| named(&args.mesh, fault.into()))?;
    let build = start.elapsed().as_secs_f64();
    field.save(&args.output)?;
    let write = start.elapsed().as_secs_f64() - build;
    let (load, repair) = (surface.input.load_seconds, surface.input.repair_seconds);
    let json = object! {
        output: &args.output,
        #[serde(flatten)]
        facts: field.facts(),
        seconds: object! { load, repair, build, write },
        repair: &surface.input.report,
    };
    report(common, &json, |json| {
        let mut answer = answer(json.output, &json.facts);
        answer.facts.push(("seconds", format!("{:.3}", load + repair + build + write)));
        answer.text(common)
    })
}

/// Reports how a field was built.
fn info(path: &Path, common: &Common) -> Result<ExitCode> {
    let field = DistanceField::open(path).map_err(canonform::Error::from)?;
    let json = object! {
        field: path,
        #[serde(flatten)]
        facts: field.facts(),
        landmarks: field.landmarks(),
    };
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

/// Looks up, writes and reports distances.
fn query(args: &FieldQueryArgs, common: &Common) -> Result<ExitCode> {
    if let Some(output) = &args.output {
        check_output(output, "distances", &["csv", "npy"])?;
    }
    let start = Instant::now();
    let field = DistanceField::open(&args.field).map_err(canonform::Error::from)?;
    let load = start.elapsed().as_secs_f64();
    let wanted = args.pairs.as_deref().map(|path| read_pairs(path, |_| Ok(()))).transpose()?;
    let start = Instant::now();
    let found =
        looked_up(&field, wanted.as_deref(), args, common).map_err(|fault| named(&args.field, fault))?;
    let query = start.elapsed().as_secs_f64();
    if let Some(output) = &args.output {
        write(output, &found)?;
    }
    let count = |kind| found.iter().filter(|pair| pair.kind == kind).count();
    let facts = field.facts();
    let json = object! {
        field: &args.field,
        method: facts.method,
        bounds: facts.bounds,
        n_vertices: facts.n_vertices,
        // Answers of each kind.
        estimated: count(PairKind::Estimated),
        exact: count(PairKind::Exact),
        dropped: count(PairKind::Dropped),
        output: &args.output,
        // The answers, unless they are in the output.
        pairs: found.iter().filter(|_| args.output.is_none()).collect::<Vec<_>>(),
        seconds: object! { load, query },
    };
    report(common, &json, |json| {
        let mut lines = Vec::new();
        if !json.pairs.is_empty() {
            lines.push("       a        b     distance        lower        upper  kind".to_owned());
        }
        for pair in &json.pairs {
            let PairDistance { a, b, distance, lower, upper, kind } = pair;
            lines.push(format!("{a:>8} {b:>8} {distance:>12.6} {lower:>12.6} {upper:>12.6}  {}", word(kind)));
        }
        let dropped =
            if json.dropped > 0 { format!(", {} of dropped vertices", json.dropped) } else { String::new() };
        lines.push(format!("{} estimated, {} exact{dropped}", json.estimated, json.exact));
        lines.extend(json.output.iter().map(|output| format!("wrote {}", output.display())));
        lines.join("\n")
    })
}

fn looked_up(
    field: &DistanceField,
    pairs: Option<&[[VertexId; 2]]>,
    args: &FieldQueryArgs,
    common: &Common,
) -> Result<Vec<PairDistance>, canonform::Error> {
    let observer = Bars::with_budget(common.quiet, args.limits.budget());
    if let Some(pairs) = pairs {
        return Ok(field.pairs(pairs, args.tolerance, &observer)?);
    }
    let mut found = Vec::new();
    for source in args.source.iter().map(|source| VertexId(*source)) {
        found.extend(match args.nearest {
            Some(k) => field.nearest(source, k, &observer)?,
            None => field.row(source, args.tolerance, &observer)?,
        });
    }
    Ok(found)
}

fn write(path: &Path, found: &[PairDistance]) -> Result<()> {
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("npy")) {
        let row = |pair: &PairDistance| {
            [f64::from(pair.a.0), f64::from(pair.b.0), pair.distance, pair.lower, pair.upper]
        };
        return write_npy(path, &[found.len(), 5], found.iter().flat_map(row));
    }
    Ok(base::files::write_atomically(path, |out| {
        writeln!(out, "a,b,distance,lower,upper,kind")?;
        for pair in found {
            let PairDistance { a, b, distance, lower, upper, kind } = pair;
            writeln!(out, "{a},{b},{distance},{lower},{upper},{}", word(kind))?;
        }
        Ok(())
    })?)
}
