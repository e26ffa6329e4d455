//! One experiment on the page.

use std::fmt::Write;

use serde_json::{Value, json};

use super::html::{folded, outcome, paragraphs, table, wide};
use crate::color::{class_clay, hex};
use crate::error::ReportError;
use crate::markup::escape;
use crate::record::{Expectation, Figure, FigurePanels, Record, RunProvenance, Tile, Tiles};

/// The section of an experiment: analysis, figures, expectations, tables, and how it was made.
pub(super) fn section(name: &str, record: &Record) -> Result<String, ReportError> {
    let figures: String =
        record.figures.iter().map(|figure| drawn(name, figure)).collect::<Result<_, _>>()?;
    let tables: String = record.tables.iter().map(table).collect();
    let html = [
        paragraphs(&record.analysis),
        figures,
        expectations(name, &record.expectations),
        if tables.is_empty() { String::new() } else { format!("<h3>Numbers</h3>\n{tables}") },
        provenance(&record.provenance),
    ];
    Ok(html.concat())
}

/// A figure with a link to its file; surfaces can also be turned where scripts run.
fn drawn(name: &str, figure: &Figure) -> Result<String, ReportError> {
    let caption = escape(&figure.caption);
    let svg = figure.svg()?.replacen("<svg ", &format!("<svg role=\"img\" aria-label=\"{caption}\" "), 1);
    let file = format!("{name}-{}.svg", figure.part);
    let mut html = format!(
        "<figure>\n<div class=\"drawing\">{svg}</div>\n\
         <figcaption>{caption} <span class=\"files\"><a href=\"{file}\" download>SVG</a></span></figcaption>\n</figure>\n"
    );
    if let FigurePanels::Tiles(tiles) = &figure.panels {
        let id = format!("{name}-{}", figure.part);
        let groups = json!(groups(tiles)).to_string();
        // Escaped as JSON does, so that no text can end the element.
        let groups = groups.replace('&', "\\u0026").replace('<', "\\u003c").replace('>', "\\u003e");
        let _ = write!(
            html,
            "<div class=\"gallery\" id=\"{id}\" data-source=\"{id}-data\" hidden>\n\
             <form class=\"controls\" autocomplete=\"off\"><label>Shape <select class=\"shape\"></select></label>\n\
             <label>Colors <select class=\"color\"><option value=\"class\">class</option>\
             <option value=\"distance\">geodesic distance from a sample</option></select></label></form>\n\
             <div class=\"views\"></div>\n<p class=\"pale\">Drag to rotate all views together.</p>\n</div>\n\
             <script type=\"application/json\" id=\"{id}-data\">{groups}</script>\n"
        );
    }
    Ok(html)
}

/// The surfaces that are shown together: every shape with its form, or every row.
fn groups(tiles: &Tiles) -> Vec<Value> {
    let mut groups = Vec::new();
    for (class, row) in tiles.rows.iter().enumerate() {
        let size = if tiles.is_paired { 2 } else { row.tiles.len().max(1) };
        for group in row.tiles.chunks(size) {
            let view = |(tile, head): (&Tile, &String)| {
                let caption = tile.captions.first().map_or("", String::as_str);
                json!({"title": format!("{head}: {caption}"), "surface": tile.surface})
            };
            let caption = group.first().and_then(|tile| tile.captions.first());
            let name = if tiles.is_paired { caption.unwrap_or(&row.name) } else { &row.name };
            let views: Vec<Value> = group.iter().zip(&tiles.heads).map(view).collect();
            groups.push(json!({"name": name, "color": hex(class_clay(class)), "views": views}));
        }
    }
    groups
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
        let (class, text) = outcome(e);
        let cells = [&e.what, &e.expected, &e.measured].map(|text| format!("<td>{}</td>", escape(text)));
        format!("<tr><td class=\"{class}\">{text}</td>{}</tr>\n", cells.concat())
    };
    let goals = if list.iter().any(|e| e.goal) {
        " A goal is not expected to be reached yet; to miss it is no failure."
    } else {
        ""
    };
    let headings = ["outcome", "quantity", "expected", "measured"];
    let head = headings.map(|heading| format!("<th scope=\"col\">{heading}</th>")).concat();
    format!(
        "<h3 id=\"{}\">Expectations</h3>\n\
         <p class=\"pale\">What was expected of this run, and what was measured.{goals}</p>\n{}",
        anchor(name),
        wide(&format!("<tr>{head}</tr>"), &list.iter().map(row).collect::<String>())
    )
}

fn provenance(p: &RunProvenance) -> String {
    let commit = if p.commit.is_empty() { String::new() } else { format!(", commit {}", p.commit) };
    let facts = [
        ("program", format!("{} {}{commit}", p.program, p.version)),
        ("machine", p.machine.clone()),
        ("date", p.date.clone()),
        ("dataset", p.dataset.clone()),
        ("classes", p.classes.join(", ")),
        ("seed", p.seed.to_string()),
        ("time", format!("{:.2} s", p.seconds)),
    ];
    let facts = facts.iter().filter(|(_, fact)| !fact.trim().is_empty());
    let facts: String =
        facts.map(|(term, fact)| format!("<dt>{term}</dt><dd>{}</dd>\n", escape(fact))).collect();
    let code = |text: &str| format!("<pre><code>{}</code></pre>\n", escape(text));
    let options = serde_json::to_string_pretty(&p.options).unwrap_or_default();
    folded("How it was made", &(code(&p.command) + &format!("<dl>\n{facts}</dl>\n") + &code(&options)))
}
