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
    let page = page(&(paragraphs(lead) + &headline(&made)), &made, &main, &closing(&made, &open));
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

/// The last line of the page: which experiments have not run, and the command that runs them on the shapes of the others,
/// into this folder; empty if all have.
fn closing(made: &[ShownSection<'_>], open: &[&Section]) -> String {
    if open.is_empty() {
        return String::new();
    }
    let titles: Vec<String> = open.iter().map(|section| escape(section.short())).collect();
    let names: Vec<&str> = open.iter().map(|section| section.name.as_str()).collect();
    // Records of several runs: the last one decides.
    let last = made.iter().map(|(_, record)| &record.provenance).max_by_key(|made| &made.date);
    let arguments = last.map_or("", |made| &made.arguments);
    format!(
        "<footer><p class=\"pale\">Not run: {}. To run them: <code>{}</code></p></footer>\n",
        titles.join(", "),
        escape(&format!("cargo run --release -p experiments -- run {}{arguments}", names.join(" ")))
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

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::record::{RunProvenance, TileRow, Tiles};
    use crate::table::Table;
    use crate::tests::{assert_closed, assert_holds, figure, plot, tile};

    fn sections() -> Vec<Section> {
        [("figure1", "Figure 1. Shapes"), ("figure6", "Figure 6. Errors"), ("scaling", "Scaling. Time")]
            .map(|(name, title)| Section { name: name.to_owned(), title: title.to_owned() })
            .to_vec()
    }

    fn expectation(what: &str, held: bool, goal: bool) -> Expectation {
        let (expected, measured) = ("at least 0.9".to_owned(), "0.125".to_owned());
        Expectation { what: what.to_owned(), expected, measured, held, goal }
    }

    fn record(panels: FigurePanels) -> Record {
        let mut options = serde_json::Map::new();
        options.insert("rank".to_owned(), 5.into());
        Record {
            provenance: RunProvenance {
                program: "experiments".to_owned(),
                command: "experiments run all --dataset 'a & b'".to_owned(),
                arguments: " --dataset 'a & b' --output results".to_owned(),
                machine: "a processor".to_owned(),
                options,
                seconds: 0.25,
                ..RunProvenance::default()
            },
            lead: "Seen & found.".to_owned(),
            analysis: "Two clusters.\n\na < b & c".to_owned(),
            expectations: vec![expectation("first tier", true, false)],
            tables: vec![Table::new(
                "Scores.",
                ["method", "NN"],
                vec![vec!["wave <kernel>".into(), 0.75.into()]],
            )],
            figures: vec![figure(panels)],
            ..Record::default()
        }
    }

    fn page_of(folder: &Path) -> String {
        let path = write_report(folder, &["figure6", "figure1"], &sections()).unwrap();
        assert_eq!(path, folder.join(FILE));
        let html = fs::read_to_string(path).unwrap();
        // Scripts hold markup of their own.
        assert_closed(html.split("<script>").next().unwrap());
        assert!(!html.contains("<script src") && html.contains("default-src 'none'"));
        html
    }

    #[test]
    fn a_page_without_records_names_the_experiments_and_the_command_that_runs_them() {
        let folder = tempfile::tempdir().unwrap();
        let html = page_of(folder.path());
        assert_holds(&html, &["Not run: Figure 1, Figure 6, Scaling.", "run figure1 figure6 scaling</code>"]);
        assert!(!html.contains("<section") && !html.contains("expectations") && !html.contains("<script"));
    }

    #[test]
    fn a_section_has_figures_expectations_numbers_and_how_it_was_made() {
        let folder = tempfile::tempdir().unwrap();
        let mut one = record(FigurePanels::Plots(vec![plot("david0")]));
        one.expectations
            .extend([expectation("<silhouette>", false, false), expectation("speed", false, true)]);
        one.save(folder.path(), "figure6").unwrap();
        let html = page_of(folder.path());
        assert_holds(
            &html,
            &["<h1>canonform: results</h1>\n<p>Seen &amp; found.</p>\n", "Not run: Figure 1, Scaling."],
        );
        assert_holds(&html, &["run figure1 scaling --dataset &#39;a &amp; b&#39; --output results</code>"]);
        assert_holds(&html, &["<p>Two clusters.</p>", "a &lt; b &amp; c", "<svg role=\"img\"", "david0"]);
        assert_holds(&html, &["href=\"figure6-part.png\" download", "href=\"figure6-part.svg\""]);
        let outcome = "Figure 6: &lt;silhouette&gt;</a> is 0.125 (expected: at least 0.9)";
        assert_holds(&html, &["class=\"failed\">1 of 3 expectations held<", outcome]);
        assert_holds(&html, &["✓ held", "✗ failed", "○ goal missed", "<h3 id=\"figure6-expectations\">"]);
        assert_holds(&html, &["<td>wave &lt;kernel&gt;</td><td class=\"number\">0.750</td>"]);
        assert_holds(
            &html,
            &["<summary>How it was made</summary>", "a processor", "0.25 s", "&quot;rank&quot;: 5"],
        );
        assert!(!html.contains("<script"), "without surfaces there are no scripts");
        assert_eq!(html, page_of(folder.path()), "the page is deterministic");
        for end in ["png", "svg"] {
            assert!(folder.path().join(format!("figure6-part.{end}")).exists());
        }
    }

    #[test]
    fn surfaces_can_be_turned_and_names_never_become_markup() {
        let folder = tempfile::tempdir().unwrap();
        let evil = "</script><img src=x>";
        let row = TileRow { name: evil.to_owned(), tiles: vec![tile(evil, false), tile("stress 2", true)] };
        let heads = ["shape", "form"].map(str::to_owned).to_vec();
        let one = record(FigurePanels::Tiles(Tiles { is_paired: true, heads, rows: vec![row] }));
        one.save(folder.path(), "figure1").unwrap();
        let html = page_of(folder.path());
        assert_eq!(html.matches("* plotly.js v").count(), 1, "plotly is there once");
        assert!(!html.contains("<img src=x"));
        let island =
            html.split("id=\"figure1-part-data\">").nth(1).unwrap().split("</script>").next().unwrap();
        let groups: serde_json::Value = serde_json::from_str(island).unwrap();
        assert_eq!(
            (&groups[0]["name"], &groups[0]["views"][1]["title"]),
            (&evil.into(), &"form: stress 2".into())
        );
    }

    #[test]
    fn broken_records_are_errors_that_name_the_file() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("figure1.json"), "{\"names\": 3").unwrap();
        let error = write_report(folder.path(), &[], &sections()).unwrap_err();
        assert!(error.to_string().contains("figure1.json"), "{error}");
        assert!(!folder.path().join(FILE).exists());
        let mut broken = plot("cat0");
        broken.series[0].points[0].high = f64::NAN;
        let error = record(FigurePanels::Plots(vec![broken])).save(folder.path(), "x").unwrap_err();
        assert!(error.to_string().contains("x.json"), "{error}");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
