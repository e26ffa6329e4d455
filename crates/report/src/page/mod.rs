//! One page for all results of a folder: figures, numbers, expectations, and what made them.
//!
//! The page stands alone: style, scripts, data and pictures are inside, and its content-security policy lets it fetch
//! nothing. Figures are plots and surfaces to turn where scripts run, and pictures elsewhere and on paper; the files of
//! the pictures are linked beside it.

mod chart;
mod explorer;
mod html;
mod reproduced;
mod retrieval;
mod scripts;

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use crate::figure4::Content;
use crate::results::{Expectation, Figure1Record, Figure4Record, Provenance, Scale, ShapesRecord, read};
use crate::{ReportError, figure1, figure4, tables};
use files::{FileError, write_bytes};
use html::{Cell, escape, paragraphs, table};
use view::numbers::signed;

/// Name of the page inside the folder of results.
pub const FILE: &str = "report.html";

/// Writes `report.html` into a folder of results and returns its path.
///
/// Shows the records of all experiments (`figure1.json`, ...) with the PNG files beside them. A record or a picture that is missing is
/// named on the page together with what makes it, so a page can be written after any run.
///
/// # Errors
/// [`ReportError::File`] and [`ReportError::Parse`] when a record is there but cannot be read,
/// [`ReportError::File`] when the page cannot be written.
pub fn write_report(out_dir: impl AsRef<Path>) -> Result<PathBuf, ReportError> {
    let folder = out_dir.as_ref();
    let shapes = explorer::shapes(folder)?;
    let mut sections = vec![
        figure1_section(folder, shapes.as_ref())?,
        reproduced::figure3_section(folder)?,
        figure4_section(folder, shapes.as_ref())?,
    ];
    for experiment in reproduced::CURVES {
        sections.push(reproduced::curves_section(folder, experiment)?);
    }
    sections.push(reproduced::figure9_section(folder)?);
    sections.push(retrieval::retrieval_section(folder)?);
    sections.push(reproduced::curves_section(folder, reproduced::SCALING)?);
    let path = folder.join(FILE);
    write_bytes(&path, page(&sections).as_bytes())?;
    Ok(path)
}

/// One experiment on the page.
struct Section {
    /// Name of the experiment, also the anchor.
    name: &'static str,
    title: &'static str,
    /// Everything under the heading.
    body: String,
    expectations: Vec<Expectation>,
}

impl Section {
    /// What stands in the place of an experiment that was not run.
    fn missing(name: &'static str, title: &'static str) -> Self {
        let body = format!(
            "<div class=\"missing\"><p>Not run yet: <code>{name}.json</code> is not in this folder. \
             <code>cargo run --release -p experiments -- run {name}</code> makes it.</p></div>\n"
        );
        Self { name, title, body, expectations: Vec::new() }
    }
}

fn page(sections: &[Section]) -> String {
    let mut html = String::from("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n");
    html.push_str("<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n");
    let _ = writeln!(
        html,
        "{}<title>canonform: results</title>\n<style>\n{}</style>\n</head>",
        scripts::head(),
        include_str!("style.css")
    );
    html.push_str("<body>\n<header>\n<h1>canonform: results</h1>\n");
    let all: Vec<&Expectation> = sections.iter().flat_map(|s| &s.expectations).collect();
    let held = all.iter().filter(|e| e.held).count();
    let verdict = match all.len() - held {
        0 => format!("<span class=\"held\">✓ all {held} expectations held</span>"),
        failed => format!("<span class=\"failed\">✗ {failed} of {} expectations failed</span>", all.len()),
    };
    if !all.is_empty() {
        let _ = writeln!(html, "<p>{verdict}</p>");
    }
    html.push_str("<nav aria-label=\"Experiments\"><ul>");
    for Section { name, title, .. } in sections {
        let _ = write!(html, "<li><a href=\"#{name}\">{title}</a></li>");
    }
    html.push_str("</ul></nav>\n</header>\n<main>\n");
    for Section { name, title, body, .. } in sections {
        let _ = write!(html, "<section id=\"{name}\">\n<h2>{title}</h2>\n{body}</section>\n");
    }
    html.push_str("</main>\n");
    html.push_str(&scripts::tail());
    html.push_str("</body>\n</html>\n");
    html
}

fn figure1_section(folder: &Path, shapes: Option<&ShapesRecord>) -> Result<Section, ReportError> {
    let (name, title) = ("figure1", "Figure 1. Shapes and their canonical forms");
    let path = folder.join("figure1.json");
    if !path.exists() {
        return Ok(Section::missing(name, title));
    }
    let record: Figure1Record = read(path)?;
    let mut body = paragraphs(&record.analysis);
    body.push_str(&picture(
        folder,
        name,
        figure1::PART,
        "Pairs of a shape (left) and its canonical form (right), up to three of each class. The forms \
         of a class are all seen from one side; under each stands its stress in squared mesh units. Colours go by class and agree with those of Figure 4.",
    )?);
    body.push_str(&explorer::gallery(&record, shapes));
    body.push_str(&expectations(&record.expectations));
    let rows: Vec<Vec<Cell>> = record
        .shapes
        .iter()
        .map(|s| {
            let repair = if s.repair.is_empty() { "nothing".to_string() } else { s.repair.join("; ") };
            let numbers = [s.n_vertices.to_string(), s.n_faces.to_string(), figure1::stress_digits(s.stress)];
            let mut row = vec![Cell::Text(s.name.clone()), Cell::Text(s.label.clone())];
            row.extend(numbers.map(Cell::Number));
            row.push(Cell::Text(repair));
            row
        })
        .collect();
    let shapes = table(
        "Shapes as embedded, the stress of their forms, and what was repaired in the input.",
        &["shape", "class", "vertices", "faces", "stress", "repaired"],
        &rows,
    );
    let _ = write!(body, "<h3>Numbers</h3>\n{}", folded(&format!("{} shapes", rows.len()), &shapes));
    body.push_str(&provenance(&record.provenance));
    Ok(Section { name, title, body, expectations: record.expectations })
}

fn figure4_section(folder: &Path, shapes: Option<&ShapesRecord>) -> Result<Section, ReportError> {
    let (name, title) = ("figure4", "Figure 4. Classification of shapes by their canonical forms");
    let path = folder.join("figure4.json");
    if !path.exists() {
        return Ok(Section::missing(name, title));
    }
    let record: Figure4Record = read(path)?;
    let mut body = paragraphs(&record.analysis);
    let mut still = String::new();
    for (part, scale, content) in figure4::PARTS {
        if record.panels_at(scale).next().is_some() {
            still += &picture(folder, name, part, &figure4_caption(scale, content, record.names.len()))?;
        }
    }
    body.push_str(&explorer::explorer(&record, shapes, &still)?);
    body.push_str(&expectations(&record.expectations));
    let rows: Vec<Vec<Cell>> = record
        .panels
        .iter()
        .map(|panel| {
            let mut row = vec![Cell::Text(panel.method.clone()), Cell::Text(panel.scale.name().to_string())];
            row.extend(tables::values(&panel.scores).map(|v| Cell::Number(signed(v, 3))));
            let map = [panel.map_silhouette, panel.map_stress, panel.negative_mass];
            row.extend(map.map(|v| Cell::Number(signed(v, 3))));
            row
        })
        .collect();
    let headings =
        [&["method", "scale"], tables::HEADINGS.as_slice(), &["map silh.", "map stress", "neg. mass"]]
            .concat();
    let caption = "NN nearest neighbour, FT and ST first and second tier, E E-measure, DCG discounted cumulative gain, \
                   mAP mean average precision, k-NN leave-one-out accuracy: 1 is best. Negative mass: share of the \
                   spectrum that no Euclidean space can hold.";
    let _ = write!(body, "<h3>Numbers</h3>\n{}", table(caption, &headings, &rows));
    body.push_str(&provenance(&record.provenance));
    Ok(Section { name, title, body, expectations: record.expectations })
}

fn figure4_caption(scale: Scale, content: Content, n: usize) -> String {
    let size = match scale {
        Scale::Raw => "forms at their original size (mesh units; kernel PCA has units of its own)",
        Scale::Normalized => "forms scaled to one size",
    };
    match content {
        Content::Maps => format!(
            "{n} shapes as points of the plane: multidimensional scaling of the distances between their forms, {size}. \
             Both axes of a map have one scale, so near points are similar forms. Under each map its scores."
        ),
        Content::Matrices => {
            format!("The {n} × {n} distances between forms, {size}, grouped by class; dark is near.")
        }
    }
}

/// A PNG file as part of the page, linked to its SVG.
fn picture(folder: &Path, name: &str, part: &str, caption: &str) -> Result<String, ReportError> {
    let (png, svg) = (format!("{name}{part}.png"), format!("{name}{part}.svg"));
    let path = folder.join(&png);
    if !path.exists() {
        return Ok(format!(
            "<div class=\"missing\"><p>The picture <code>{png}</code> is missing: run {name} again.</p></div>\n"
        ));
    }
    let bytes = fs::read(&path).map_err(|source| FileError::read(&path, source))?;
    // The header of a PNG: width and height as big-endian words. They keep the page from jumping while it loads.
    let word =
        |at: usize| bytes.get(at..at + 4).and_then(|w| w.try_into().ok()).map_or(0, u32::from_be_bytes);
    let (width, height) = (word(16), word(20));
    Ok(format!(
        "<figure>\n<a href=\"{svg}\"><img src=\"data:image/png;base64,{}\" width=\"{width}\" height=\"{height}\" \
         alt=\"{alt}\"></a>\n<figcaption>{alt} <a href=\"{png}\">PNG</a> <a href=\"{svg}\">SVG</a></figcaption>\n</figure>\n",
        STANDARD.encode(&bytes),
        alt = escape(caption),
    ))
}

fn expectations(list: &[Expectation]) -> String {
    if list.is_empty() {
        return String::new();
    }
    let rows: Vec<Vec<Cell>> = list
        .iter()
        .map(|e| {
            let texts = [&e.what, &e.expected, &e.measured].map(|text| Cell::Text(text.clone()));
            [Cell::Verdict(e.held)].into_iter().chain(texts).collect()
        })
        .collect();
    let headings = ["outcome", "what", "expected", "measured"];
    format!(
        "<h3>Expectations</h3>\n{}",
        table("What was expected of this run, and what came out.", &headings, &rows)
    )
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
    let mut html =
        format!("<h3>How it was made</h3>\n<pre><code>{}</code></pre>\n<dl>\n", escape(&p.command));
    for (term, fact) in facts.iter().filter(|(_, fact)| !fact.trim().is_empty()) {
        let _ = writeln!(html, "<dt>{term}</dt><dd>{}</dd>", escape(fact));
    }
    html.push_str("</dl>\n");
    let options = format!("<pre><code>{}</code></pre>\n", escape(&format!("{:#}", p.options)));
    html.push_str(&folded("All options", &options));
    html
}

/// Content that opens on a click.
fn folded(summary: &str, content: &str) -> String {
    format!("<details>\n<summary>{}</summary>\n{content}</details>\n", escape(summary))
}

#[cfg(test)]
mod tests;
