//! Looking up distances.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use anyhow::Result;
use base::terminal::Bars;
use canonform::fields::{DistanceField, FieldBounds, PairDistance, PairKind};
use canonform::surface::VertexId;
use serde::Serialize;

use crate::args::{Common, FieldQueryArgs};
use crate::input::named;
use crate::output::{check_format, check_output, report, write_npy};
use crate::pairs;

#[derive(Serialize)]
struct QueryJson {
    field: PathBuf,
    method: &'static str,
    bounds: FieldBounds,
    n_vertices: usize,
    /// Answers of each kind.
    estimated: usize,
    exact: usize,
    dropped: usize,
    output: Option<PathBuf>,
    /// The answers, unless they are in the output.
    pairs: Vec<PairDistance>,
    seconds: Seconds,
}

#[derive(Serialize)]
struct Seconds {
    load: f64,
    query: f64,
}

/// Looks up, writes and reports distances.
pub(super) fn query(args: &FieldQueryArgs, common: &Common) -> Result<ExitCode> {
    if let Some(output) = &args.output {
        check_format(output, "distances", &["csv", "npy"])?;
        check_output(output)?;
    }
    let start = Instant::now();
    let field = DistanceField::open(&args.field).map_err(canonform::Error::from)?;
    let load = start.elapsed().as_secs_f64();
    let wanted = args.pairs.as_deref().map(pairs::read).transpose()?;
    let start = Instant::now();
    let found =
        answers(&field, wanted.as_deref(), args, common).map_err(|fault| named(&args.field, fault))?;
    let query = start.elapsed().as_secs_f64();
    if let Some(output) = &args.output {
        write(output, &found)?;
    }
    let count = |kind| found.iter().filter(|pair| pair.kind == kind).count();
    let facts = field.facts();
    let json = QueryJson {
        field: args.field.clone(),
        method: facts.method,
        bounds: facts.bounds,
        n_vertices: facts.n_vertices,
        estimated: count(PairKind::Estimated),
        exact: count(PairKind::Exact),
        dropped: count(PairKind::Dropped),
        output: args.output.clone(),
        pairs: if args.output.is_some() { Vec::new() } else { found },
        seconds: Seconds { load, query },
    };
    report(common, &json, table)
}

fn answers(
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

fn kind(pair: &PairDistance) -> &'static str {
    match pair.kind {
        PairKind::Estimated => "estimated",
        PairKind::Exact => "exact",
        PairKind::Dropped => "dropped",
    }
}

fn write(path: &Path, found: &[PairDistance]) -> Result<()> {
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("npy")) {
        let row = |pair: &PairDistance| {
            [f64::from(pair.a.0), f64::from(pair.b.0), pair.distance, pair.lower, pair.upper]
        };
        let rows: Vec<[f64; 5]> = found.iter().map(row).collect();
        return write_npy(path, 5, rows.iter().map(|row| &row[..]));
    }
    Ok(base::files::write_atomically(path, |out| {
        writeln!(out, "a,b,distance,lower,upper,kind")?;
        for pair in found {
            let PairDistance { a, b, distance, lower, upper, .. } = pair;
            writeln!(out, "{a},{b},{distance},{lower},{upper},{}", kind(pair))?;
        }
        Ok(())
    })?)
}

fn table(json: &QueryJson) -> String {
    let QueryJson { estimated, exact, dropped, pairs, .. } = json;
    let mut lines = Vec::new();
    if !pairs.is_empty() {
        lines.push(format!("{:>8} {:>8} {:>12} {:>12} {:>12}  kind", "a", "b", "distance", "lower", "upper"));
    }
    for pair in pairs {
        let PairDistance { a, b, distance, lower, upper, .. } = pair;
        lines.push(format!("{a:>8} {b:>8} {distance:>12.6} {lower:>12.6} {upper:>12.6}  {}", kind(pair)));
    }
    let dropped = if *dropped > 0 { format!(", {dropped} of dropped vertices") } else { String::new() };
    lines.push(format!("{estimated} estimated, {exact} exact{dropped}"));
    lines.extend(json.output.iter().map(|output| format!("wrote {}", output.display())));
    lines.join("\n")
}
