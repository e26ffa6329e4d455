//! `canonform search`.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Result;
use canonform::index::SearchMode;
use canonform::{
    Budget, ComponentResult, Explain, SearchOptions, SearchRank, SearchReport, ShapeSearch, content_hash,
    is_dataset, list_shapes, mesh_path,
};
use serde::Serialize;

use crate::args::{Common, SearchArgs};
use crate::input::{file_name, is_stream, is_there, named, read_mesh};
use crate::output::{exit_code, print, print_json};

#[derive(Serialize)]
struct Answer {
    query: String,
    #[serde(flatten)]
    report: SearchReport,
}

/// All answers; the only one also by its own keys.
#[derive(Serialize)]
struct Json<'a> {
    #[serde(flatten)]
    only: Option<&'a Answer>,
    queries: &'a [Answer],
    failed: &'a [Failure],
}

#[derive(Serialize)]
struct Failure {
    query: String,
    error: String,
}

/// What to search with.
enum Query {
    Mesh(PathBuf),
    /// A shape of the index.
    Indexed(String),
}

impl Query {
    fn name(&self) -> String {
        match self {
            Self::Mesh(path) => path.display().to_string(),
            Self::Indexed(id) => id.clone(),
        }
    }

    fn search(&self, index: &ShapeSearch, options: &SearchOptions, common: &Common) -> Result<SearchReport> {
        match self {
            Self::Indexed(id) => Ok(index.search_shape(id, options)?),
            Self::Mesh(path) => {
                let mesh = read_mesh(path, common)?;
                let search = || {
                    let content = match options.explain {
                        _ if is_stream(path) => None,
                        Explain::No => None,
                        Explain::Kind => Some(content_hash(path)?),
                    };
                    let (name, budget) = (file_name(path), Budget::unlimited());
                    index.search_named_within(&mesh, &name, content, options, &budget)
                };
                search().map_err(|fault| named(path, fault))
            }
        }
    }
}

/// The queries of a command: folders stand for their meshes, and names without a file for shapes of the index.
fn queries(args: &SearchArgs, index: &ShapeSearch) -> Result<Vec<Query>> {
    let mut queries = Vec::new();
    for given in &args.queries {
        if is_dataset(given) {
            queries.extend(list_shapes(given, None)?.into_iter().map(|shape| Query::Mesh(shape.path)));
            continue;
        }
        let id = given.to_str().filter(|id| !is_there(given) && index.index().contains(id).unwrap_or(false));
        queries.push(id.map_or_else(|| Query::Mesh(given.clone()), |id| Query::Indexed(id.to_owned())));
    }
    queries.extend(args.id.iter().cloned().map(Query::Indexed));
    Ok(queries)
}

/// Searches an index; queries that cannot be read are listed and do not stop the others. Exits with code 1 if nothing is
/// found for some.
pub(crate) fn search(args: &SearchArgs, common: &Common) -> Result<ExitCode> {
    let index = ShapeSearch::open(&args.index)?;
    let options = SearchOptions {
        k: args.k,
        mode: if args.exact { SearchMode::Exact } else { SearchMode::Auto },
        explain: if args.explain { Explain::Kind } else { Explain::No },
        rank_by: args.rank,
    };
    let queries = queries(args, &index)?;
    let (mut answers, mut failed) = (Vec::new(), Vec::new());
    for query in &queries {
        match query.search(&index, &options, common) {
            Ok(mut report) => {
                for result in &mut report.results {
                    result.path = mesh_path(&args.index, &result.path).to_string_lossy().into_owned();
                }
                let components = report.components.iter_mut().filter_map(|part| part.nearest.as_mut());
                for result in components.chain(&mut report.wholes) {
                    result.path = mesh_path(&args.index, &result.path).to_string_lossy().into_owned();
                }
                if !common.json {
                    print(&table(query.name(), &report))?;
                }
                answers.push(Answer { query: query.name(), report });
            }
            Err(fault) => {
                let missing = matches!(query, Query::Mesh(path) if !is_there(path));
                let fault = match missing {
                    true => fault.context(format!(
                        "{} is neither a file nor a shape of the index; `canonform index list` names its shapes",
                        query.name()
                    )),
                    false => fault,
                };
                if queries.len() == 1 {
                    return Err(fault);
                }
                let error = crate::remedy::message(&fault);
                terminal::error(&error);
                failed.push(Failure { query: query.name(), error });
            }
        }
    }
    let nothing = answers.iter().any(|answer| answer.report.n_shapes == 0);
    let code = if failed.is_empty() && nothing { ExitCode::from(1) } else { exit_code(failed.is_empty()) };
    if common.json {
        let only = answers.first().filter(|_| queries.len() == 1);
        print_json(&Json { only, queries: &answers, failed: &failed })?;
    }
    Ok(code)
}

fn table(query: String, report: &SearchReport) -> String {
    let mut table = comfy_table::Table::new();
    table.load_style(comfy_table::presets::NOTHING);
    let explained = report.results.iter().any(|result| result.evidence.is_some());
    let mut head = vec!["", "shape", "class", "distance", "path"];
    match report.rank_by {
        SearchRank::Plain => {}
        SearchRank::Graph => drop(head.splice(3..3, ["rank distance", "plain"])),
        SearchRank::Part => drop(head.splice(3..3, ["part distance", "share"])),
    }
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
        if let Some(found) = result.on_graph {
            let plain = found.plain_rank.map_or_else(|| "-".to_owned(), |rank| rank.to_string());
            row.splice(3..3, [format!("{:.4}", found.rank_distance), plain]);
        }
        if let Some(found) = result.as_part {
            let share = format!("{:.0} %", 100.0 * found.part_share);
            row.splice(3..3, [format!("{:.4}", found.part_distance), share]);
        }
        if let Some(evidence) = &result.evidence {
            row.push(format!("{evidence} ({:.2}); {}", evidence.confidence, result.verdict));
        }
        table.add_row(row);
    }
    let exactness = if report.recall < 1.0 {
        format!(", {:.1} % of the nearest found", 100.0 * report.recall)
    } else {
        String::new()
    };
    let order = match report.rank_by {
        SearchRank::Plain => "",
        SearchRank::Graph => {
            "\n  ordered by rank distance: signatures and neighbours in common; `plain` is the rank by signatures"
        }
        SearchRank::Part => {
            "\n  ordered by part distance: how well the query fits as a part; `share` is its share of the shape"
        }
    };
    let mut components: String = report.components.iter().map(component).collect();
    for evidence in report.wholes.iter().filter_map(|whole| whole.evidence.as_ref()) {
        components += &format!("  {evidence} ({:.2})\n", evidence.confidence);
    }
    format!(
        "{query}\n{table}{order}\n{components}  class: {}\n  {} of {} shapes measured{exactness}, {} aligned, {:.3} s",
        report.predicted.explanation,
        report.measured,
        report.n_shapes,
        report.aligned,
        report.seconds.describe + report.seconds.search
    )
}

/// What a component of the query is, as a line.
fn component(found: &ComponentResult) -> String {
    let copies =
        if found.copies == 1 { "1 component".to_owned() } else { format!("{} components", found.copies) };
    let evidence = found.nearest.as_ref().and_then(|nearest| nearest.evidence.as_ref());
    let words = evidence.map_or_else(|| "nothing found".to_owned(), |e| format!("{e} ({:.2})", e.confidence));
    format!("  {copies} of {} vertices: {words}\n", found.n_vertices)
}
