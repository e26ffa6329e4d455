//! Laws of the page.

use std::fs;
use std::path::Path;

use canonform_report::Table;
use canonform_report::page::{FILE, Section, write_report};
use canonform_report::record::{Expectation, FigurePanels, Record, RunProvenance, TileRow, Tiles};

use crate::{assert_closed, assert_holds, figure, plot, tile};

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
    one.expectations.extend([expectation("<silhouette>", false, false), expectation("speed", false, true)]);
    one.save(folder.path(), "figure6").unwrap();
    let html = page_of(folder.path());
    assert_holds(
        &html,
        &["<h1>canonform: results</h1>\n<p>Seen &amp; found.</p>\n", "Not run: Figure 1, Scaling."],
    );
    let command = "experiments run all --dataset &#39;a &amp; b&#39;";
    assert_holds(&html, &["run figure1 scaling</code>", command]);
    assert_holds(&html, &["<p>Two clusters.</p>", "a &lt; b &amp; c", "<svg role=\"img\"", "david0"]);
    assert_holds(&html, &["href=\"figure6-part.svg\" download"]);
    let outcome = "Figure 6: &lt;silhouette&gt;</a> is 0.125 (expected: at least 0.9)";
    assert_holds(&html, &["class=\"failed\">1 of 3 expectations held<", outcome]);
    assert_holds(&html, &["✓ held", "✗ failed", "○ goal missed", "<h3 id=\"figure6-expectations\">"]);
    assert_holds(&html, &["<td>wave &lt;kernel&gt;</td><td class=\"number\">0.750</td>"]);
    assert_holds(
        &html,
        &["<summary>How it was made</summary>", "a processor", "0.25 s", "&quot;rank&quot;: 5"],
    );
    // Dark pages have rules for the colors of drawings.
    let [style, drawing] = ["<style>", "<svg"].map(|part| html.split_once(part).unwrap().1);
    for color in ["#222222", "#696969", "#E4E4E4", "#FFFFFF"] {
        assert!(drawing.contains(color) && style.contains(&format!("[fill=\"{color}\"]")), "{color}");
    }
    assert!(!html.contains("<script"), "without surfaces there are no scripts");
    assert_eq!(html, page_of(folder.path()), "the page is deterministic");
    assert!(folder.path().join("figure6-part.svg").exists());
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
    let island = html.split("id=\"figure1-part-data\">").nth(1).unwrap().split("</script>").next().unwrap();
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
