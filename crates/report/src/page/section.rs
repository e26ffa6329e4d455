//! One experiment on the page.

use std::path::Path;

use super::chart::{chart, picture};
use super::explorer::{explorer, gallery};
use super::html::{escape, folded, paragraphs, table};
use crate::figure::Figure;
use crate::results::{
    CurvesRecord, Expectation, Figure1Record, Figure3Record, Figure4Record, Figure9Record, Provenance,
    RetrievalRecord, ShapesRecord, read,
};
use crate::{Cell, Record, ReportError, Table};

/// An experiment whose record the page shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Section {
    /// Name of the experiment, of its record `NAME.json`, and of the anchor on the page.
    pub name: &'static str,
    /// The heading.
    pub title: &'static str,
    /// What the record holds.
    pub kind: Kind,
}

/// The kinds of records, each with its own way to be shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A [`CurvesRecord`].
    Curves,
    /// A [`Figure1Record`].
    Figure1,
    /// A [`Figure3Record`].
    Figure3,
    /// A [`Figure4Record`].
    Figure4,
    /// A [`Figure9Record`].
    Figure9,
    /// A [`RetrievalRecord`].
    Retrieval,
}

/// The section of an experiment as HTML, or a note that it has not run, and whether its expectations held.
pub(super) fn shown(
    folder: &Path,
    section: &Section,
    shapes: Option<&ShapesRecord>,
) -> Result<(String, Vec<bool>), ReportError> {
    let name = section.name;
    let charts = |figures: &[Figure]| -> Result<String, ReportError> {
        figures.iter().map(|figure| chart(folder, name, figure)).collect()
    };
    match section.kind {
        Kind::Curves => record(folder, section, |_: &CurvesRecord, figures| charts(figures)),
        Kind::Figure1 => record(folder, section, |record: &Figure1Record, figures| {
            Ok(charts(figures)? + &gallery(record, shapes))
        }),
        Kind::Figure3 => record(folder, section, |_: &Figure3Record, figures| charts(figures)),
        Kind::Figure4 => record(folder, section, |record: &Figure4Record, figures| {
            let still: Result<String, ReportError> =
                figures.iter().map(|figure| picture(folder, name, figure)).collect();
            explorer(record, shapes, &still?)
        }),
        Kind::Figure9 => record(folder, section, |_: &Figure9Record, figures| charts(figures)),
        Kind::Retrieval => record(folder, section, |_: &RetrievalRecord, figures| charts(figures)),
    }
}

/// A section around what `body` makes of the record and its figures.
fn record<R: Record>(
    folder: &Path,
    Section { name, title, .. }: &Section,
    body: impl FnOnce(&R, &[Figure]) -> Result<String, ReportError>,
) -> Result<(String, Vec<bool>), ReportError> {
    let path = folder.join(format!("{name}.json"));
    let (content, held) = if path.exists() {
        let record: R = read(path)?;
        record.validate()?;
        let (origin, outcomes, analysis) = record.about();
        let html = [
            paragraphs(analysis),
            body(&record, &record.figures())?,
            expectations(outcomes),
            "<h3>Numbers</h3>\n".to_owned(),
            record.tables().iter().map(table).collect(),
            provenance(origin),
        ];
        (html.concat(), outcomes.iter().map(|outcome| outcome.held).collect())
    } else {
        let note = format!(
            "<div class=\"missing\"><p>Not run yet: there is no <code>{name}.json</code> in this folder. To create it, \
             run <code>cargo run --release -p experiments -- run {name}</code>.</p></div>\n"
        );
        (note, vec![])
    };
    Ok((format!("<section id=\"{name}\">\n<h2>{title}</h2>\n{content}</section>\n"), held))
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
