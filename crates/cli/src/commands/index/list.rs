//! `canonform index list`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Result;
use canonform::index::{Entry, Index};
use canonform::library::mesh_path;
use serde::Serialize;

use crate::args::{Common, ListArgs};
use crate::output::{report, row_of, shown, table_of};

#[derive(Serialize)]
struct Json {
    index: PathBuf,
    /// Shapes in the index, listed or not.
    n_shapes: usize,
    shapes: Vec<Listed>,
}

#[derive(Serialize)]
struct Listed {
    id: String,
    /// Empty if it has none.
    label: String,
    path: String,
    vertices: u64,
    faces: u64,
}

pub(super) fn list(args: &ListArgs, common: &Common) -> Result<ExitCode> {
    let index = Index::open(&args.index)?;
    let lists_all = args.label.is_empty() && !args.unlabelled;
    let is_listed =
        |label: &String| lists_all || args.label.contains(label) || args.unlabelled && label.is_empty();
    let entries = index.entries()?.into_iter().filter(|entry| is_listed(&entry.label));
    let shapes = entries.map(|entry| listed(&args.index, entry)).collect();
    let json = Json { index: args.index.clone(), n_shapes: index.len(), shapes };
    let code = report(common, &json, table)?;
    Ok(if json.shapes.is_empty() { ExitCode::from(1) } else { code })
}

fn listed(index: &Path, entry: Entry) -> Listed {
    let path = mesh_path(index, &entry.path).to_string_lossy().into_owned();
    let (vertices, faces) = (entry.facts.vertices, entry.facts.faces);
    Listed { id: entry.id, label: entry.label, path, vertices, faces }
}

fn table(json: &Json) -> String {
    let mut table = table_of(["shape", "class", "vertices", "path"]);
    for shape in &json.shapes {
        let class = if shape.label.is_empty() { "-" } else { &shape.label };
        let vertices = shape.vertices.to_string();
        table.add_row(row_of([&shape.id, class, &vertices, &shape.path]));
    }
    let counts = format!("{} of {} shapes in {}", json.shapes.len(), json.n_shapes, shown(&json.index));
    format!("{table}\n  {counts}")
}
