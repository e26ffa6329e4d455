//! Sections of the figures that set several methods side by side.

use std::fmt::Write;
use std::path::Path;

use serde_json::json;

use super::chart::{Plot, chart};
use super::html::{Cell, paragraphs, table};
use super::{Section, expectations, folded, picture, provenance};
use crate::classes::Classes;
use crate::figure1::stress_digits;
use crate::results::{CurvesPanel, CurvesRecord, Figure3Record, Figure9Record, read};
use crate::tables::{bytes_digits, seconds_digits, significant};
use crate::{ReportError, curves, figure3};

/// The experiments whose records are curves, with their titles.
pub(super) const CURVES: [(&str, &str); 5] = [
    ("figure5a", "Figure 5a. Reconstruction error against the rank"),
    ("figure5b", "Figure 5b. Reconstruction error against alpha"),
    ("figure6", "Figure 6. Reconstruction error against the number of samples"),
    ("figure7", "Figure 7. Stress above the optimum against the number of samples"),
    ("figure8", "Figure 8. Time against the number of samples"),
];

/// What the paper has no figure of, in curves as well.
pub(super) const SCALING: (&str, &str) = ("scaling", "Scaling. Time and memory up to a million vertices");

/// Forms by several methods.
pub(super) fn figure3_section(folder: &Path) -> Result<Section, ReportError> {
    let (name, title) = ("figure3", "Figure 3. Canonical forms by several methods");
    let path = folder.join("figure3.json");
    if !path.exists() {
        return Ok(Section::missing(name, title));
    }
    let record: Figure3Record = read(path)?;
    let mut body = paragraphs(&record.analysis);
    body.push_str(&picture(
        folder,
        name,
        figure3::PART,
        "Shapes (left) and their forms by each method. Each form fills its tile and is turned to match the first of its \
         row. Under it stands its stress in squared mesh units, of the run of median stress, and the paper's number.",
    )?);
    let caption = "Medians and ranges of the stress over runs that differ in the first sample, for three ways to measure distances, and the \
                   paper's numbers.";
    let shapes = Classes::of(record.stresses.iter().map(|s| s.shape.as_str()));
    let plot = |i| Plot::new("stress", i, format!("Stress of the methods on {}", shapes.name(i)));
    let plots: Vec<Plot> = (0..shapes.len()).map(plot).collect();
    body.push_str(&chart(name, &plots, caption, &json!({"stresses": record.stresses}), ""));
    body.push_str(&expectations(&record.expectations));
    let rows: Vec<Vec<Cell>> = record
        .stresses
        .iter()
        .map(|s| {
            let mut row = Vec::from([&s.shape, &s.distances, &s.method].map(|t| Cell::Text(t.clone())));
            row.extend([s.median, s.low, s.high].map(|v| Cell::Number(stress_digits(v))));
            row.push(Cell::Number(s.runs.to_string()));
            row.push(Cell::Number(s.paper.map_or_else(|| "–".to_string(), |v| v.to_string())));
            row
        })
        .collect();
    let headings = ["shape", "distances", "method", "median", "least", "greatest", "runs", "paper"];
    let caption = "Stress in squared mesh units over runs that differ in the first sample.";
    let _ = write!(body, "<h3>Numbers</h3>\n{}", table(caption, &headings, &rows));
    body.push_str(&provenance(&record.provenance));
    Ok(Section { name, title, body, expectations: record.expectations })
}

/// A figure of curves.
pub(super) fn curves_section(
    folder: &Path,
    (name, title): (&'static str, &'static str),
) -> Result<Section, ReportError> {
    let path = folder.join(format!("{name}.json"));
    if !path.exists() {
        return Ok(Section::missing(name, title));
    }
    let record: CurvesRecord = read(path)?;
    let mut body = paragraphs(&record.analysis);
    let still = picture(folder, name, curves::PART, &record.caption)?;
    let label = |title: &str| format!("{}: {title}", record.caption);
    let plot = |(i, panel): (usize, &CurvesPanel)| Plot::new("curves", i, label(&panel.title));
    let plots: Vec<Plot> = record.panels.iter().enumerate().map(plot).collect();
    body.push_str(&chart(name, &plots, &record.caption, &json!({"panels": record.panels}), &still));
    body.push_str(&expectations(&record.expectations));
    body.push_str("<h3>Numbers</h3>\n");
    for panel in &record.panels {
        let rows: Vec<Vec<Cell>> = panel
            .series
            .iter()
            .flat_map(|series| series.points.iter().map(move |point| (series, point)))
            .map(|(series, p)| {
                let mut row = vec![Cell::Text(series.name.clone())];
                row.extend([p.x, p.median, p.low, p.high].map(|v| Cell::Number(significant(v))));
                row.push(Cell::Number(p.runs.to_string()));
                row
            })
            .collect();
        let headings = ["method", panel.x.name.as_str(), "median", "least", "greatest", "runs"];
        let unit = if panel.y.unit.is_empty() { String::new() } else { format!(", in {}", panel.y.unit) };
        let numbers = table(&format!("{}{unit}.", panel.y.name), &headings, &rows);
        body.push_str(&folded(&panel.title, &numbers));
    }
    body.push_str(&provenance(&record.provenance));
    Ok(Section { name, title, body, expectations: record.expectations })
}

/// The table of times.
pub(super) fn figure9_section(folder: &Path) -> Result<Section, ReportError> {
    let (name, title) = ("figure9", "Figure 9. Times and memory of whole embeddings");
    let path = folder.join("figure9.json");
    if !path.exists() {
        return Ok(Section::missing(name, title));
    }
    let record: Figure9Record = read(path)?;
    let mut body = paragraphs(&record.analysis);
    let plots = [Plot::new("times", 0, "Seconds of every method on every shape")];
    body.push_str(&chart(
        name,
        &plots,
        "Filled: here; hollow: the paper, on a laptop of 2015.",
        &json!({"rows": record.rows}),
        "",
    ));
    let rows: Vec<Vec<Cell>> = record
        .rows
        .iter()
        .map(|row| {
            let number = |value: Option<String>| Cell::Number(value.unwrap_or_else(|| "–".to_string()));
            let m = row.measured;
            vec![
                Cell::Text(row.shape.clone()),
                Cell::Number(row.n_vertices.to_string()),
                Cell::Text(row.method.clone()),
                number(m.map(|m| seconds_digits(m.geodesics))),
                number(m.map(|m| seconds_digits(m.embedding))),
                number(m.map(|m| seconds_digits(m.total()))),
                number(m.map(|m| bytes_digits(m.peak_bytes))),
                number(m.map(|m| m.runs.to_string())),
                number(row.paper_seconds.map(|s| s.to_string())),
                Cell::Text(row.note.clone()),
            ]
        })
        .collect();
    let headings =
        ["shape", "vertices", "method", "distances", "algebra", "total", "memory", "runs", "paper", "remark"];
    let caption = format!(
        "Wall-clock seconds of the fastest run, {} worker threads; memory in use at once beyond the surface. \
         The paper's seconds are of a 2015 laptop.",
        record.threads
    );
    body.push_str(&table(&caption, &headings, &rows));
    body.push_str(&expectations(&record.expectations));
    body.push_str(&provenance(&record.provenance));
    Ok(Section { name, title, body, expectations: record.expectations })
}
