//! One page with all results of a folder: figures, numbers, expectations and provenance.
//!
//! The page is one file: it contains its style, scripts, data and images, and its content-security policy forbids it to
//! fetch anything. Figures are interactive where scripts run, and images elsewhere and in print.

mod chart;
mod explorer;
mod html;
mod scripts;
mod section;

use std::path::{Path, PathBuf};

use crate::error::ReportError;
use files::write_bytes;
pub use section::{Content, Section, charts, explorer, gallery};

/// Name of the page in the folder of results.
pub const FILE: &str = "report.html";

/// Writes `report.html` into a folder of results and returns its path.
///
/// The page shows the records of the experiments with the PNG files beside them. It names every missing record or
/// image and the command that creates it, so a page can be written after any run.
///
/// # Errors
/// [`ReportError::File`] and [`ReportError::Parse`] if a record exists but cannot be read, the errors of
/// [`Results::validate`](crate::Results::validate), [`ReportError::File`] if the page cannot be written.
pub fn write_report(folder: impl AsRef<Path>, sections: &[Section]) -> Result<PathBuf, ReportError> {
    let folder = folder.as_ref();
    let shapes = explorer::shapes(folder)?;
    let content = |section: &Section| (section.show)(folder, section.name, shapes.as_ref());
    let contents: Vec<Content> = sections.iter().map(content).collect::<Result<_, _>>()?;
    let path = folder.join(FILE);
    write_bytes(&path, page(sections, &contents).as_bytes())?;
    Ok(path)
}

fn page(sections: &[Section], contents: &[Content]) -> String {
    let outcomes: Vec<bool> = contents.iter().flat_map(|(_, held)| held).copied().collect();
    let verdict = match (outcomes.len(), outcomes.iter().filter(|held| !**held).count()) {
        (0, _) => String::new(),
        (all, 0) => format!("<p><span class=\"held\">✓ all {all} expectations held</span></p>\n"),
        (all, failed) => {
            format!("<p><span class=\"failed\">✗ {failed} of {all} expectations failed</span></p>\n")
        }
    };
    let link = |Section { name, title, .. }: &Section| format!("<li><a href=\"#{name}\">{title}</a></li>");
    let section = |(Section { name, title, .. }, (html, _)): (&Section, &Content)| {
        format!("<section id=\"{name}\">\n<h2>{title}</h2>\n{html}</section>\n")
    };
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         {head}<title>canonform: results</title>\n<style>\n{style}</style>\n</head>\n\
         <body>\n<header>\n<h1>canonform: results</h1>\n{verdict}\
         <nav aria-label=\"Experiments\"><ul>{links}</ul></nav>\n</header>\n<main>\n{main}</main>\n{tail}</body>\n</html>\n",
        head = scripts::head(),
        style = include_str!("style.css"),
        links = sections.iter().map(link).collect::<String>(),
        main = sections.iter().zip(contents).map(section).collect::<String>(),
        tail = scripts::tail(),
    )
}

#[cfg(test)]
mod tests;
