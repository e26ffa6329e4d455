//! One experiment on the page.

use std::path::Path;

use serde_json::Value;

use super::chart::{chart, picture};
use super::explorer::{self};
use super::html::{escape, folded, paragraphs, table};
use crate::error::ReportError;
use crate::figure::Figure;
use crate::record::Results;
use crate::results::{
    Expectation, Figure1Results, Figure4Results, Record, RunProvenance, ShapesRecord,
    provenance as provenance_of, read,
};
use crate::table::{Cell, Table};

/// An experiment on the page.
#[derive(Debug, Clone, Copy)]
pub struct Section {
    /// Name of the experiment, of its record `NAME.json`, and of the anchor on the page.
    pub name: &'static str,
    /// The heading. Its first sentence, such as `Figure 1.`, is the link to it.
    pub title: &'static str,
    /// Makes its content, if it has run: [`charts`], [`gallery`] or [`explorer()`].
    pub show: fn(&ResultsFolder<'_>, &str) -> Result<Option<SectionContent>, ReportError>,
}

impl Section {
    /// The text of links to the section.
    #[must_use]
    pub fn short(&self) -> &'static str {
        self.title.split_once(". ").map_or(self.title, |(short, _)| short)
    }
}

/// A folder of results.
#[derive(Debug)]
pub struct ResultsFolder<'a> {
    pub(super) path: &'a Path,
    /// The surfaces of Figure 4.
    pub(super) shapes: Option<ShapesRecord>,
    /// The options with which the experiments in the folder were run, each after a space.
    pub(super) arguments: String,
}

impl<'a> ResultsFolder<'a> {
    /// A folder with records of experiments of these names.
    pub(super) fn new(path: &'a Path, names: impl Iterator<Item = &'a str>) -> Result<Self, ReportError> {
        let records = names.map(|name| path.join(format!("{name}.json"))).filter(|record| record.exists());
        let sources: Vec<RunProvenance> = records.map(provenance_of).collect::<Result<_, _>>()?;
        // Records of several runs: the last one decides.
        let last = sources.into_iter().max_by(|a, b| a.date.cmp(&b.date));
        let arguments = last.map_or_else(String::new, |made| made.arguments);
        Ok(Self { path, shapes: explorer::shapes(path)?, arguments })
    }

    /// The last line of the page: which experiments have not run, and the command that runs them on the shapes of the
    /// others, into this folder; empty if all have.
    pub(super) fn closing(&self, open: &[&Section]) -> String {
        if open.is_empty() {
            return String::new();
        }
        let titles: Vec<String> = open.iter().map(|section| escape(section.short())).collect();
        let names: Vec<&str> = open.iter().map(|section| section.name).collect();
        let command =
            format!("cargo run --release -p experiments -- run {}{}", names.join(" "), self.arguments);
        format!(
            "<footer><p class=\"pale\">Not run: {}. To run them: <code>{}</code></p></footer>\n",
            titles.join(", "),
            escape(&command)
        )
    }
}

/// A section.
#[derive(Debug, Default)]
pub struct SectionContent {
    pub(super) html: String,
    pub(super) expectations: Vec<Expectation>,
}

/// All figures of an experiment as charts; nothing if it has not run.
///
/// # Errors
/// Those of [`write_report`](super::write_report).
pub fn charts<T: Results>(
    folder: &ResultsFolder<'_>,
    name: &str,
) -> Result<Option<SectionContent>, ReportError> {
    content(folder, name, |_: &Record<T>, figures| {
        figures.iter().map(|figure| chart(folder.path, name, figure)).collect()
    })
}

/// [`charts`] of Figure 1, and its shapes in 3D.
///
/// # Errors
/// Those of [`write_report`](super::write_report).
pub fn gallery(folder: &ResultsFolder<'_>, name: &str) -> Result<Option<SectionContent>, ReportError> {
    content(folder, name, |record: &Record<Figure1Results>, figures| {
        let charts = figures.iter().map(|figure| chart(folder.path, name, figure));
        Ok(charts.collect::<Result<String, _>>()?
            + &explorer::gallery(&record.results, folder.shapes.as_ref()))
    })
}

/// Figure 4 for exploration, with its static figures in place of charts.
///
/// # Errors
/// Those of [`write_report`](super::write_report).
pub fn explorer(folder: &ResultsFolder<'_>, name: &str) -> Result<Option<SectionContent>, ReportError> {
    content(folder, name, |record: &Record<Figure4Results>, figures| {
        let still = figures.iter().map(|figure| picture(folder.path, name, figure));
        explorer::explorer(record, folder.shapes.as_ref(), &still.collect::<Result<String, _>>()?)
    })
}

/// What `body` makes of the record and its figures, between the analysis and the numbers.
fn content<T: Results>(
    folder: &ResultsFolder<'_>,
    name: &str,
    body: impl FnOnce(&Record<T>, &[Figure]) -> Result<String, ReportError>,
) -> Result<Option<SectionContent>, ReportError> {
    let path = folder.path.join(format!("{name}.json"));
    if !path.exists() {
        return Ok(None);
    }
    let record: Record<T> = read(path)?;
    record.results.validate()?;
    let html = [
        paragraphs(&record.analysis),
        body(&record, &record.results.figures())?,
        expectations(name, &record.expectations),
        "<h3>Numbers</h3>\n".to_owned(),
        record.results.tables().iter().map(table).collect(),
        provenance(&record.provenance),
    ];
    Ok(Some(SectionContent { html: html.concat(), expectations: record.expectations }))
}

/// The anchor of the expectations of an experiment.
pub(super) fn anchor(name: &str) -> String {
    format!("{name}-expectations")
}

fn expectations(name: &str, list: &[Expectation]) -> String {
    if list.is_empty() {
        return String::new();
    }
    let row = |e: &Expectation| {
        vec![
            Cell::Verdict(e.outcome()),
            Cell::text(&e.what),
            Cell::text(&e.expected),
            Cell::text(&e.measured),
        ]
    };
    let headings = ["outcome", "quantity", "expected", "measured"];
    let rows = list.iter().map(row).collect();
    let goals = if list.iter().any(|e| e.goal) {
        " A goal is not expected to be reached yet; to miss it is no failure."
    } else {
        ""
    };
    let caption = format!("What was expected of this run, and what was measured.{goals}");
    let expected = Table::new(caption, headings, rows);
    format!("<h3 id=\"{}\">Expectations</h3>\n{}", anchor(name), table(&expected))
}

fn provenance(p: &RunProvenance) -> String {
    let seconds: Vec<String> = p.seconds.iter().map(|(stage, s)| format!("{stage} {s:.2} s")).collect();
    let commit = if p.commit.is_empty() { String::new() } else { format!(", commit {}", p.commit) };
    let facts = [
        ("program", format!("{} {}{commit}", p.program, p.version)),
        ("machine", p.machine.clone()),
        ("date", p.date.clone()),
        ("dataset", p.dataset.clone()),
        ("classes", p.classes.join(", ")),
        ("seed", p.seed.to_string()),
        ("time", seconds.join(", ")),
    ];
    let facts = facts.iter().filter(|(_, fact)| !fact.trim().is_empty());
    let facts: String =
        facts.map(|(term, fact)| format!("<dt>{term}</dt><dd>{}</dd>\n", escape(fact))).collect();
    let code = |text: &str| format!("<pre><code>{}</code></pre>\n", escape(text));
    let made = code(&p.command) + &format!("<dl>\n{facts}</dl>\n") + &code(&as_toml(&p.options));
    folded("How it was made", &made)
}

/// Options as TOML; options that have no value are left out.
fn as_toml(options: &Value) -> String {
    fn known(value: &Value) -> Value {
        match value {
            Value::Object(fields) => {
                let fields = fields.iter().filter(|(_, value)| !value.is_null());
                Value::Object(fields.map(|(name, value)| (name.clone(), known(value))).collect())
            }
            Value::Array(items) => {
                Value::Array(items.iter().filter(|value| !value.is_null()).map(known).collect())
            }
            value => value.clone(),
        }
    }
    toml::to_string(&known(options)).unwrap_or_else(|_| format!("{options:#}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_written_as_toml() {
        let options =
            serde_json::json!({"rank": 5, "none": null, "embedding": {"samples": 10, "kinds": ["a", null]}});
        assert_eq!(as_toml(&options), "rank = 5\n\n[embedding]\nkinds = [\"a\"]\nsamples = 10\n");
    }
}
