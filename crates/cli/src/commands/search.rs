//! `canonform search`.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Result;
use canonform::index::SearchMode;
use canonform::{Explain, SearchOptions, SearchReport, ShapeSearch};
use serde::Serialize;

use crate::args::{Common, SearchArgs};
use crate::input::named;
use crate::output::{exit_code, print, print_json};

#[derive(Serialize)]
struct Answer {
    query: PathBuf,
    #[serde(flatten)]
    report: SearchReport,
}

/// One answer as an object, several as a list in an object.
#[derive(Serialize)]
#[serde(untagged)]
enum Json {
    One(Box<Answer>),
    Several { queries: Vec<Answer>, failed: Vec<Failure> },
}

#[derive(Serialize)]
struct Failure {
    query: PathBuf,
    error: String,
}

/// Searches an index for meshes; unreadable ones are listed and do not stop the others. Exits with code 1 if nothing is
/// found for some.
pub(crate) fn search(args: &SearchArgs, common: &Common) -> Result<ExitCode> {
    let index = ShapeSearch::open(&args.index)?;
    let options = SearchOptions {
        k: args.k,
        mode: if args.exact { SearchMode::Exact } else { SearchMode::Auto },
        explain: if args.explain { Explain::Kind } else { Explain::No },
    };
    let (mut answers, mut failed) = (Vec::new(), Vec::new());
    for query in &args.queries {
        let report = mesh::io::read(query)
            .map_err(Into::into)
            .and_then(|mesh| index.search(&mesh, &options))
            .map_err(|fault| named(query, fault));
        match report {
            Ok(report) => {
                if !common.json {
                    print(&table(query.display().to_string(), &report))?;
                }
                answers.push(Answer { query: query.to_path_buf(), report });
            }
            Err(fault) if args.queries.len() == 1 => return Err(fault),
            Err(fault) => {
                let error = crate::remedy::message(&fault);
                eprintln!("error: {error}");
                failed.push(Failure { query: query.to_path_buf(), error });
            }
        }
    }
    let nothing = answers.iter().any(|answer| answer.report.results.is_empty());
    let code = if failed.is_empty() && nothing { ExitCode::from(1) } else { exit_code(failed.is_empty()) };
    if common.json {
        let json = match args.queries.len() {
            1 => answers.pop().map(|answer| Json::One(Box::new(answer))),
            _ => Some(Json::Several { queries: answers, failed }),
        };
        print_json(&json)?;
    }
    Ok(code)
}

fn table(query: String, report: &SearchReport) -> String {
    let mut table = comfy_table::Table::new();
    table.load_style(comfy_table::presets::NOTHING);
    let explained = report.results.iter().any(|result| result.comparison.is_some());
    let mut head = vec!["", "shape", "class", "distance", "path"];
    if explained {
        head.push("match");
    }
    table.set_header(head);
    for result in &report.results {
        let mut row = vec![
            result.rank.to_string(),
            result.id.clone(),
            result.label.clone(),
            format!("{:.4}", result.distance),
            result.path.clone(),
        ];
        if explained {
            row.push(format!("{} ({:.2})", result.verdict, result.verdict.confidence));
        }
        table.add_row(row);
    }
    let exactness = if report.recall < 1.0 {
        format!(", {:.1} % of the nearest found", 100.0 * report.recall)
    } else {
        String::new()
    };
    format!(
        "{query}\n{table}\n  class: {}\n  {} of {} shapes measured{exactness}, {} aligned, {:.3} s",
        report.predicted.explanation,
        report.measured,
        report.n_shapes,
        report.aligned,
        report.seconds.describe + report.seconds.search
    )
}
