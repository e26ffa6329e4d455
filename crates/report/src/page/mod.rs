//! One page with all results of a folder: figures, numbers, expectations and provenance.
//!
//! The page is one file: it contains its style, scripts, data and images, and its content-security policy forbids it to
//! fetch anything. Figures are interactive where scripts run, and images elsewhere and in print.

mod chart;
mod explorer;
mod html;
mod scripts;
mod section;

use std::fmt::Write;
use std::path::{Path, PathBuf};

use crate::error::ReportError;
use crate::results::{Expectation, ExpectationOutcome};
use base::files::write_bytes;
pub use html::escape;
use html::{marked, paragraphs};
pub use section::{ResultsFolder, Section, SectionContent, charts, explorer, gallery};

/// Name of the page in the folder of results.
pub const FILE: &str = "report.html";

/// Writes `report.html` into a folder of results and returns its path.
///
/// The page begins with `lead`, paragraphs of plain text, and shows the records of the experiments with the PNG files
/// beside them. Its last line names the experiments without a record and the command that runs them, so a page can be
/// written after any run.
///
/// # Errors
/// [`ReportError::File`] and [`ReportError::Parse`] if a record exists but cannot be read, the errors of
/// [`Results::validate`](crate::Results::validate), [`ReportError::File`] if the page cannot be written.
pub fn write_report(
    folder: impl AsRef<Path>,
    lead: &str,
    sections: &[Section],
) -> Result<PathBuf, ReportError> {
    let path = folder.as_ref().join(FILE);
    let folder = ResultsFolder::new(folder.as_ref(), sections.iter().map(|section| section.name))?;
    let (mut made, mut open) = (Vec::new(), Vec::new());
    for section in sections {
        match (section.show)(&folder, section.name)? {
            Some(content) => made.push((section, content)),
            None => open.push(section),
        }
    }
    let header = paragraphs(lead) + &headline(&made);
    write_bytes(&path, page(&header, &made, &folder.closing(&open)).as_bytes())?;
    Ok(path)
}

/// An experiment that has run, and what the page shows of it.
type ShownSection<'a> = (&'a Section, SectionContent);

/// How many expectations held, and a link to each that did not.
fn headline(sections: &[ShownSection<'_>]) -> String {
    let all: Vec<(&Section, &Expectation)> = sections
        .iter()
        .flat_map(|(section, content)| content.expectations.iter().map(move |e| (*section, e)))
        .collect();
    if all.is_empty() {
        return String::new();
    }
    let count = |outcome| all.iter().filter(|(_, e)| e.outcome() == outcome).count();
    let [held, missed, failed] =
        [ExpectationOutcome::Held, ExpectationOutcome::Missed, ExpectationOutcome::Failed].map(count);
    let worst = match (failed, missed) {
        (0, 0) => ExpectationOutcome::Held,
        (0, _) => ExpectationOutcome::Missed,
        _ => ExpectationOutcome::Failed,
    };
    let counted = |n: usize, what: &str, word: &str| match n {
        0 => String::new(),
        1 => format!(", 1 {what} {word}"),
        n => format!(", {n} {what}s {word}"),
    };
    let (class, sign) = marked(worst);
    let mut html = format!(
        "<p><span class=\"{class}\">{sign} {held} of {} expectations held{}{}</span></p>\n",
        all.len(),
        counted(failed, "expectation", "failed"),
        counted(missed, "goal", "missed")
    );
    if worst != ExpectationOutcome::Held {
        html.push_str("<ul class=\"outcomes\">\n");
        for (section, e) in all.iter().filter(|(_, e)| e.outcome() != ExpectationOutcome::Held) {
            let (class, sign) = marked(e.outcome());
            let _ = writeln!(
                html,
                "<li><span class=\"{class}\">{sign}</span> <a href=\"#{}\">{}: {}</a> is {} ({}{})</li>",
                section::anchor(section.name),
                section.short(),
                escape(&e.what),
                escape(&e.measured),
                if e.goal { "goal: " } else { "expected: " },
                escape(&e.expected)
            );
        }
        html.push_str("</ul>\n");
    }
    html
}

fn page(header: &str, sections: &[ShownSection<'_>], closing: &str) -> String {
    let link = |(section, _): &ShownSection<'_>| {
        format!("<li><a href=\"#{}\">{}</a></li>", section.name, section.short())
    };
    let section = |(Section { name, title, .. }, SectionContent { html, .. }): &ShownSection<'_>| {
        format!("<section id=\"{name}\">\n<h2>{title}</h2>\n{html}</section>\n")
    };
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         {head}<title>canonform: results</title>\n<style>\n{style}</style>\n</head>\n\
         <body>\n<header>\n<h1>canonform: results</h1>\n{header}</header>\n\
         <nav aria-label=\"Experiments\"><ul>{links}</ul></nav>\n<main>\n{main}</main>\n{closing}{tail}</body>\n</html>\n",
        head = scripts::head(),
        style = include_str!("style.css"),
        links = sections.iter().map(link).collect::<String>(),
        main = sections.iter().map(section).collect::<String>(),
        tail = scripts::tail(),
    )
}

#[cfg(test)]
mod tests;
