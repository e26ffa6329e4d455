//! `canonform search`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Result, anyhow};
use base::{object, one_line};
use canonform::collection::{content_hash, is_dataset};
use canonform::library::mesh_path;
use canonform::mesh::io::without_extension;
use canonform::relations::Relation;
use canonform::search::{
    Answer, ComponentResult, Hit, OrderedBy, Prediction, SearchOptions, SearchRank, ShapeSearch, Unknown,
};

use crate::args::{Common, SearchArgs};
use crate::input::{file_name, is_stream, is_there, named, read_file, shapes_of};
use crate::output::{count, exit_code, print, print_json, row_of, table_of};

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

    fn search(&self, index: &ShapeSearch, options: &SearchOptions, common: &Common) -> Result<Answer> {
        match self {
            Self::Indexed(id) => Ok(index.search(&index.query_of(id, options, &())?, options, &())?),
            Self::Mesh(path) => {
                let mesh = read_file(path, common)?.mesh;
                let search = || {
                    let content = if is_stream(path) { None } else { Some(content_hash(path)?) };
                    let query = index.query(&mesh, (&file_name(path), content), options, &())?;
                    index.search(&query, options, &())
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
            queries.extend(shapes_of(given)?.into_iter().map(|shape| Query::Mesh(shape.path)));
            continue;
        }
        let id = index.id_of(given).filter(|_| !is_stream(given));
        queries.push(id.map_or_else(|| Query::Mesh(given.clone()), |id| Query::Indexed(id.to_owned())));
    }
    queries.extend(args.id.iter().cloned().map(Query::Indexed));
    Ok(queries)
}

/// Searches an index; queries that cannot be read are listed and do not stop the others. Exits with code 1 if nothing is
/// found for some.
pub(crate) fn search(args: &SearchArgs, common: &Common) -> Result<ExitCode> {
    let index = ShapeSearch::open(&args.index)?;
    let (k, explain, rank_by) = (args.k, args.explain, args.rank);
    let options = SearchOptions { k, explain, rank_by, ..SearchOptions::default() };
    let queries = queries(args, &index)?;
    let (mut answers, mut failed) = (Vec::new(), Vec::new());
    for query in &queries {
        match query.search(&index, &options, common) {
            Ok(mut answer) => {
                answer.place(|path| mesh_path(&args.index, path).to_string_lossy().into_owned());
                if !common.json {
                    print(&text(query.name(), &answer, args.explain))?;
                }
                answers.push(object! {
                    query: query.name(),
                    #[serde(flatten)]
                    answer,
                });
            }
            Err(fault) => {
                let fault = match query {
                    Query::Mesh(path) if !is_there(path) => fault.context(neither(path, &index)),
                    Query::Indexed(id) => match meant(Path::new(id), &index) {
                        Some(meant) => anyhow!("the index has no shape `{id}`; did you mean {meant}?"),
                        None => fault,
                    },
                    Query::Mesh(_) => fault,
                };
                if queries.len() == 1 {
                    return Err(fault);
                }
                let error = crate::remedy::message(&fault);
                base::terminal::error(&error);
                failed.push(object! { query: query.name(), error });
            }
        }
    }
    let nothing = answers.iter().any(|answered| answered.answer.n_shapes == 0);
    let code = if failed.is_empty() && nothing { ExitCode::from(1) } else { exit_code(failed.is_empty()) };
    if common.json {
        print_json(&object! { queries: answers, failed })?;
    }
    Ok(code)
}

/// Most shapes that an error suggests.
const MOST_SUGGESTED: usize = 3;

/// The error that a name is that of nothing.
fn neither(given: &Path, index: &ShapeSearch) -> String {
    let advice = match meant(given, index) {
        Some(meant) => format!("did you mean {meant}?"),
        None => "`canonform index list` names its shapes".to_owned(),
    };
    format!("{} is neither a file nor a shape of the index; {advice}", given.display())
}

/// Shapes that somebody may have meant by a name that is none: those of this name in a folder, or without one.
fn meant(given: &Path, index: &ShapeSearch) -> Option<String> {
    let wanted = without_extension(given).to_string_lossy().to_lowercase();
    let file_of = |name: &str| name.rsplit('/').next().unwrap_or_default().to_owned();
    let is_meant = |id: &String| file_of(&id.to_lowercase()) == file_of(&wanted);
    let ids = index.index().entries().unwrap_or_default().into_iter().map(|entry| entry.id);
    let ids: Vec<String> = ids.filter(is_meant).collect();
    let is_known = ids.iter().any(|id| Path::new(id) == given);
    let named: Vec<String> = ids.iter().take(MOST_SUGGESTED).map(|id| format!("`{id}`")).collect();
    (!is_known && !named.is_empty()).then(|| named.join(" or "))
}

/// The shapes found and the class; with `details`, how each shape is related and what the search did.
fn text(query: String, report: &Answer, details: bool) -> String {
    let mut text = format!("{}\n{}\n", one_line(&query), table(report, details));
    text += match report.rank_by {
        SearchRank::Plain if is_by_surfaces(report) => {
            "  ordered by surface gap first: the query has noise, so its surface was aligned with those of the nearest shapes\n"
        }
        SearchRank::Plain => "",
        SearchRank::Graph => {
            "  ordered by rank distance: signatures and neighbors in common; `plain` is the rank by signatures\n"
        }
        SearchRank::Forms => "  ordered by form distance: how different the canonical forms alone look\n",
        SearchRank::Part => {
            "  ordered by part distance: how well the query fits as a part; `share` is its share of the shape\n"
        }
    };
    if report.unread > 0 {
        text +=
            &format!("  {} not read: their shapes are ordered by distance\n", count(report.unread, "file"));
    }
    if details {
        for result in &report.results {
            let path = one_line(&result.path);
            text += &format!("  {}. {} ({path})\n", result.rank, explained(&result.relation));
        }
    }
    text.extend(report.components.iter().map(component));
    text.extend(report.wholes.iter().map(|whole| format!("  {}\n", explained(&whole.relation))));
    text += &class(&report.predicted);
    if details {
        let Answer { measured, n_shapes, aligned, seconds, .. } = report;
        let seconds = seconds.describe + seconds.search;
        text += &format!("  {measured} of {n_shapes} shapes measured, {aligned} aligned, {seconds:.3} s");
    }
    text.truncate(text.trim_end().len());
    text
}

/// The class, if the index has classes, and what the user should know of the query.
fn class(predicted: &Prediction) -> String {
    match (predicted.unknown, &predicted.warning) {
        (Some(Unknown::Unlabelled), None) => String::new(),
        (Some(Unknown::Unlabelled), Some(warning)) => format!("  {}\n", one_line(warning)),
        _ => format!("  class: {}\n", one_line(&predicted.explanation)),
    }
}

fn is_by_surfaces(report: &Answer) -> bool {
    matches!(report.results.first(), Some(Hit { order: Some(OrderedBy::Surface { .. }), .. }))
}

fn table(report: &Answer, details: bool) -> comfy_table::Table {
    let has_classes = report.results.iter().any(|result| !result.label.is_empty());
    let class: &[&str] = if has_classes { &["class"] } else { &[] };
    let order: &[&str] = match report.rank_by {
        SearchRank::Plain if is_by_surfaces(report) => &["surface gap"],
        SearchRank::Plain => &[],
        SearchRank::Graph => &["rank distance", "plain"],
        SearchRank::Part => &["part distance", "share"],
        SearchRank::Forms => &["form distance"],
    };
    // Without its mesh, a part is only known to differ from wholes.
    let is_related = details || report.rank_by != SearchRank::Part;
    let relation: &[&str] = if is_related { &["distance", "relation"] } else { &[] };
    let mut table = table_of([&["", "shape"], class, order, relation].concat());
    for result in &report.results {
        let mut row = vec![result.rank.to_string(), result.id.clone()];
        row.extend(has_classes.then(|| result.label.clone()));
        match result.order {
            None if is_by_surfaces(report) => row.push("-".to_owned()),
            None => {}
            Some(OrderedBy::Surface { surface_gap }) => row.push(format!("{surface_gap:.4}")),
            Some(OrderedBy::Graph { rank_distance, plain_rank }) => {
                let plain = plain_rank.map_or_else(|| "-".to_owned(), |rank| rank.to_string());
                row.extend([format!("{rank_distance:.4}"), plain]);
            }
            Some(OrderedBy::Part { part_distance, part_share }) => {
                row.extend([format!("{part_distance:.4}"), format!("{:.0} %", 100.0 * part_share)]);
            }
            Some(OrderedBy::Forms { form_distance }) => row.push(format!("{form_distance:.4}")),
        }
        if is_related {
            row.extend([format!("{:.4}", result.distance), result.relation.in_brief()]);
        }
        table.add_row(row_of(row));
    }
    table
}

/// A relation in a sentence, how certain it is, and why.
fn explained(relation: &Relation) -> String {
    let text = format!("{relation}, {:.0} % certain: {}", 100.0 * relation.confidence, relation.reason());
    one_line(&text).into_owned()
}

/// What a component of the query is, as a line.
fn component(found: &ComponentResult) -> String {
    let copies = count(found.copies, "component");
    let nearest = found.nearest.as_ref();
    let words = nearest.map_or_else(|| "nothing found".to_owned(), |found| explained(&found.relation));
    format!("  {copies} of {} vertices: {words}\n", found.n_vertices)
}
