//! One page with all results of a folder: figures, numbers, expectations and provenance.
//!
//! The page is one file: it contains its style, scripts, data and drawings, and its content-security policy forbids it to
//! fetch anything. All of it is drawn from the records, so no other file of the folder can run in it or change it.

mod html;
mod section;

use std::fmt::Write;
use std::path::{Path, PathBuf};

use base::files::write_bytes;

use self::html::{outcome, paragraphs};
use crate::error::ReportError;
use crate::figure::dark_rules;
pub use crate::markup::escape;
use crate::record::{Expectation, FigurePanels, Record};
use crate::viewer::{plotly_js, script_hash, viewer_js};

/// Name of the page in the folder of results.
pub const FILE: &str = "report.html";

/// An experiment on the page.
#[derive(Debug, Clone)]
pub struct Section {
    /// Name of the experiment, of its record `NAME.json`, and of the anchor on the page.
    pub name: String,
    /// The heading. Its first sentence, such as `Figure 1.`, is the link to it.
    pub title: String,
}

impl Section {
    /// The text of links to the section.
    fn short(&self) -> &str {
        self.title.split_once(". ").map_or(&self.title, |(short, _)| short)
    }
}

/// An experiment that has run.
type ShownSection<'a> = (&'a Section, Record);

/// Writes `report.html` into a folder of results and returns its path.
///
/// The page begins with the lead of the first of the records named in `leads`, and shows all records. Its last line names
/// the experiments without a record and the command that runs them, so a page can be written after any run.
///
/// # Errors
/// Those of [`Record::read`] for a record that exists, and [`ReportError::Draw`]; [`ReportError::File`] if the page cannot
/// be written.
pub fn write_report(
    folder: impl AsRef<Path>,
    leads: &[&str],
    sections: &[Section],
) -> Result<PathBuf, ReportError> {
    let folder = folder.as_ref();
    let (mut made, mut open): (Vec<ShownSection<'_>>, Vec<&Section>) = Default::default();
    for section in sections {
        let path = folder.join(format!("{}.json", section.name));
        match path.exists() {
            true => made.push((section, Record::read(path)?)),
            false => open.push(section),
        }
    }
    let lead =
        |name: &&str| made.iter().find(|(section, record)| section.name == **name && !record.lead.is_empty());
    let lead = leads.iter().find_map(lead).map_or("", |(_, record)| &record.lead);
    let mut main = String::new();
    for (Section { name, title }, record) in &made {
        let _ = write!(
            main,
            "<section id=\"{name}\">\n<h2>{}</h2>\n{}</section>\n",
            escape(title),
            section::section(name, record)?
        );
    }
    let path = folder.join(FILE);
    let page = page(&(paragraphs(lead) + &headline(&made)), &made, &main, &closing(&open));
    write_bytes(&path, page.as_bytes())?;
    Ok(path)
}

/// How many expectations held, and a link to each that did not.
fn headline(sections: &[ShownSection<'_>]) -> String {
    let all: Vec<(&Section, &Expectation)> = sections
        .iter()
        .flat_map(|(section, record)| record.expectations.iter().map(move |e| (*section, e)))
        .collect();
    if all.is_empty() {
        return String::new();
    }
    let held = all.iter().filter(|(_, e)| e.held).count();
    // Those that failed come before goals that were missed.
    let mut others: Vec<_> = all.iter().filter(|(_, e)| !e.held).collect();
    others.sort_by_key(|(_, e)| e.goal);
    let worst = others.first().map_or("held", |(_, e)| outcome(e).0);
    let mut html =
        format!("<p><span class=\"{worst}\">{held} of {} expectations held</span></p>\n", all.len());
    let mut items = String::new();
    for (section, e) in others {
        let (class, text) = outcome(e);
        let _ = writeln!(
            items,
            "<li><span class=\"{class}\">{text}</span>: <a href=\"#{}\">{}: {}</a> is {} (expected: {})</li>",
            section::anchor(&section.name),
            escape(section.short()),
            escape(&e.what),
            escape(&e.measured),
            escape(&e.expected)
        );
    }
    if !items.is_empty() {
        html += &format!("<ul class=\"outcomes\">\n{items}</ul>\n");
    }
    html
}

/// The last line of the page: which experiments have not run, and the command that runs them; empty if all have.
fn closing(open: &[&Section]) -> String {
    if open.is_empty() {
        return String::new();
    }
    let titles: Vec<String> = open.iter().map(|section| escape(section.short())).collect();
    let names: Vec<&str> = open.iter().map(|section| section.name.as_str()).collect();
    format!(
        "<footer><p class=\"pale\">Not run: {}. To run them, with the options of the others: \
         <code>cargo run --release -p experiments -- run {}</code></p></footer>\n",
        titles.join(", "),
        escape(&names.join(" "))
    )
}

/// The whole page. Its policy allows its own scripts by their hashes, so that nothing else on the page can run, and
/// forbids all requests. plotly inserts style rules and makes images of its scenes.
fn page(header: &str, sections: &[ShownSection<'_>], main: &str, closing: &str) -> String {
    let link = |(section, _): &ShownSection<'_>| {
        format!("<li><a href=\"#{}\">{}</a></li>", section.name, escape(section.short()))
    };
    let has_surfaces = |(_, record): &ShownSection<'_>| {
        record.figures.iter().any(|figure| matches!(figure.panels, FigurePanels::Tiles(_)))
    };
    let scripts = match sections.iter().any(has_surfaces) {
        true => vec![plotly_js(), viewer_js(), include_str!("gallery.js")],
        false => vec![],
    };
    let hash = |script: &&str| format!(" {}", script_hash(script));
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta http-equiv=\"content-security-policy\" content=\"default-src 'none'; script-src{hashes}; \
         style-src 'unsafe-inline'; img-src data: blob:; base-uri 'none'; form-action 'none'\">\n\
         <title>canonform: results</title>\n<style>\n{style}\
         @media screen and (prefers-color-scheme: dark) {{{dark}}}\n</style>\n</head>\n\
         <body>\n<header>\n<h1>canonform: results</h1>\n{header}</header>\n\
         <nav aria-label=\"Experiments\"><ul>{links}</ul></nav>\n<main>\n{main}</main>\n{closing}{tail}</body>\n</html>\n",
        hashes = scripts.iter().map(hash).collect::<String>(),
        style = include_str!("style.css"),
        dark = dark_rules(),
        links = sections.iter().map(link).collect::<String>(),
        tail = scripts.iter().map(|script| format!("<script>{script}</script>\n")).collect::<String>(),
    )
}
