//! One experiment on the page.

use std::path::Path;

use super::chart::{chart, picture};
use super::explorer::{self};
use super::html::{escape, folded, paragraphs, table};
use crate::error::ReportError;
use crate::figure::Figure;
use crate::record::Results;
use crate::results::{Expectation, Figure1Results, Figure4Results, Provenance, Record, ShapesRecord, read};
use crate::table::{Cell, Table};

/// An experiment on the page.
#[derive(Debug, Clone, Copy)]
pub struct Section {
    /// Name of the experiment, of its record `NAME.json`, and of the anchor on the page.
    pub name: &'static str,
    /// The heading.
    pub title: &'static str,
    /// Makes its content: [`charts`], [`gallery`] or [`explorer()`].
    pub show: fn(&Path, &str, Option<&ShapesRecord>) -> Result<Content, ReportError>,
}

/// A section as HTML, and whether each expectation held.
pub type Content = (String, Vec<bool>);

/// All figures of an experiment as charts, or a note that it has not run.
///
/// # Errors
/// Those of [`write_report`](super::write_report).
pub fn charts<T: Results>(
    folder: &Path,
    name: &str,
    _: Option<&ShapesRecord>,
) -> Result<Content, ReportError> {
    content(folder, name, |_: &Record<T>, figures| {
        figures.iter().map(|figure| chart(folder, name, figure)).collect()
    })
}

/// [`charts`] of Figure 1, and its shapes in 3D.
///
/// # Errors
/// Those of [`write_report`](super::write_report).
pub fn gallery(folder: &Path, name: &str, shapes: Option<&ShapesRecord>) -> Result<Content, ReportError> {
    content(folder, name, |record: &Record<Figure1Results>, figures| {
        let charts = figures.iter().map(|figure| chart(folder, name, figure));
        Ok(charts.collect::<Result<String, _>>()? + &explorer::gallery(&record.results, shapes))
    })
}

/// Figure 4 for exploration, with its static figures in place of charts.
///
/// # Errors
/// Those of [`write_report`](super::write_report).
pub fn explorer(folder: &Path, name: &str, shapes: Option<&ShapesRecord>) -> Result<Content, ReportError> {
    content(folder, name, |record: &Record<Figure4Results>, figures| {
        let still = figures.iter().map(|figure| picture(folder, name, figure));
        explorer::explorer(record, shapes, &still.collect::<Result<String, _>>()?)
    })
}

/// What `body` makes of the record and its figures, between the analysis and the numbers.
fn content<T: Results>(
    folder: &Path,
    name: &str,
    body: impl FnOnce(&Record<T>, &[Figure]) -> Result<String, ReportError>,
) -> Result<Content, ReportError> {
    let path = folder.join(format!("{name}.json"));
    if !path.exists() {
        let note = format!(
            "<div class=\"missing\"><p>Not run yet: there is no <code>{name}.json</code> in this folder. To create it, \
             run <code>cargo run --release -p experiments -- run {name}</code>.</p></div>\n"
        );
        return Ok((note, vec![]));
    }
    let record: Record<T> = read(path)?;
    record.results.validate()?;
    let html = [
        paragraphs(&record.analysis),
        body(&record, &record.results.figures())?,
        expectations(&record.expectations),
        "<h3>Numbers</h3>\n".to_owned(),
        record.results.tables().iter().map(table).collect(),
        provenance(&record.provenance),
    ];
    Ok((html.concat(), record.expectations.iter().map(|outcome| outcome.held).collect()))
}

fn expectations(list: &[Expectation]) -> String {
    if list.is_empty() {
        return String::new();
    }
    let row = |e: &Expectation| {
        vec![Cell::Verdict(e.held), Cell::text(&e.what), Cell::text(&e.expected), Cell::text(&e.measured)]
    };
    let headings = ["outcome", "quantity", "expected", "measured"];
    let rows = list.iter().map(row).collect();
    let expected = Table::new("What was expected of this run, and what was measured.", headings, rows);
    format!("<h3>Expectations</h3>\n{}", table(&expected))
}

fn provenance(p: &Provenance) -> String {
    let seconds: Vec<String> = p.seconds.iter().map(|(stage, s)| format!("{stage} {s:.2} s")).collect();
    let facts = [
        ("program", format!("{} {}", p.program, p.version)),
        ("dataset", p.dataset.clone()),
        ("classes", p.classes.join(", ")),
        ("seed", p.seed.to_string()),
        ("time", seconds.join(", ")),
    ];
    let facts = facts.iter().filter(|(_, fact)| !fact.trim().is_empty());
    let facts: String =
        facts.map(|(term, fact)| format!("<dt>{term}</dt><dd>{}</dd>\n", escape(fact))).collect();
    let options = format!("<pre><code>{}</code></pre>\n", escape(&format!("{:#}", p.options)));
    format!(
        "<h3>How it was made</h3>\n<pre><code>{}</code></pre>\n<dl>\n{facts}</dl>\n{}",
        escape(&p.command),
        folded("All options", &options)
    )
}
