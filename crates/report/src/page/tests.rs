use std::collections::BTreeMap;
use std::fs;

use super::*;
use crate::record::{Results, save};
use crate::results::{
    CurvesResults, Figure3Results, Figure4Results, Figure9Results, Record, RetrievalResults, SHAPES_FILE,
    ShapesRecord, write,
};
use crate::tests::fixtures::{
    assert_balanced, assert_holds, curves_record, figure1_record, figure3_record, figure4_record,
    figure9_record, retrieval_record, shapes_record, without_scripts,
};

/// The experiments that have curves.
const CURVES: [&str; 6] = ["figure5a", "figure5b", "figure6", "figure7", "figure8", "scaling"];

fn sections() -> Vec<Section> {
    let mut sections = vec![
        Section { name: "figure1", title: "Shapes", show: gallery },
        Section { name: "figure3", title: "Forms", show: charts::<Figure3Results> },
        Section { name: "figure4", title: "Classes", show: explorer },
        Section { name: "figure9", title: "Times", show: charts::<Figure9Results> },
        Section { name: "retrieval", title: "Scores", show: charts::<RetrievalResults> },
    ];
    sections.extend(CURVES.map(|name| Section { name, title: name, show: charts::<CurvesResults> }));
    sections
}

fn page_of(folder: &Path) -> String {
    let path = write_report(folder, "Seen & found.", &sections()).unwrap();
    assert_eq!(path, folder.join(FILE));
    let html = fs::read_to_string(path).unwrap();
    assert_balanced(&html);
    html
}

#[test]
fn one_line_names_the_experiments_that_did_not_run_and_the_command_that_runs_them() {
    let folder = tempfile::tempdir().unwrap();
    let html = page_of(folder.path());
    let all = "run figure1 figure3 figure4 figure9 retrieval figure5a figure5b figure6 figure7 figure8 scaling</code>";
    assert_holds(&html, &["Not run: Shapes, Forms, Classes, Times, Scores, figure5a,", all]);
    let plain = without_scripts(&html);
    assert!(!plain.contains("expectations") && !plain.contains("<section") && !plain.contains("<li>"));
    // With the options of a record that is there.
    write(&figure4_record(&CLASSES), folder.path().join("figure4.json")).unwrap();
    let html = page_of(folder.path());
    let command = "figure8 scaling --dataset &#39;a &amp; b&#39; --output results</code>";
    assert_holds(&html, &[command, "<li><a href=\"#figure4\">Classes</a></li>"]);
    assert_eq!(html.matches("<section id=").count(), 1);
    assert_eq!(html.matches("Not run").count(), 1);
    // Nothing if all have run.
    let folder = full_folder(&figure4_record(&CLASSES), None);
    assert!(!page_of(folder.path()).contains("Not run"));
}

#[test]
fn the_page_begins_with_what_is_seen_and_folds_how_it_was_made() {
    let folder = full_folder(&figure4_record(&CLASSES), None);
    let html = page_of(folder.path());
    assert_holds(&html, &["<h1>canonform: results</h1>\n<p>Seen &amp; found.</p>\n"]);
    let made = "<details>\n<summary>How it was made</summary>\n<pre><code>experiments run all";
    assert_eq!(html.matches(made).count(), sections().len());
    let folded = html.split(made).skip(1).filter_map(|part| part.split("</details>").next());
    folded.for_each(|folded| assert_holds(folded, &["a processor", "embedding 0.25 s", "rank = 5"]));
}

#[test]
fn a_section_has_figures_numbers_options_and_expectations() {
    let folder = tempfile::tempdir().unwrap();
    let record = figure4_record(&[("cat", 3), ("dog", 2)]);
    save(&record, folder.path(), "figure4").unwrap();
    let html = page_of(folder.path());
    assert_eq!(without_scripts(&html).matches("data:image/svg+xml;base64,").count(), 4);
    for part in record.results.figures().iter().map(|figure| figure.part) {
        for kind in ["png", "svg", "pdf"] {
            let file = format!("figure4{part}.{kind}");
            assert!(html.contains(&format!("href=\"{file}\" download")), "{file}");
            assert!(folder.path().join(&file).exists(), "{file}");
        }
    }
    let outcome = "Classes: NMDS, raw: silhouette</a> is -0.125 (expected: at least 0.9)";
    assert_holds(&html, &["1 of 2 expectations held, 1 expectation failed", outcome]);
    assert_holds(&html, &["<a href=\"#figure4-expectations\">", "<h3 id=\"figure4-expectations\">"]);
    assert_holds(&html, &["✓ held", "✗ failed", "0.910", "\u{2212}0.125", "0.875", "Two clusters."]);
    assert_holds(&html, &["experiments 0.1.0, commit abc1234", "a processor", "--dataset", "rank = 5"]);
    assert_holds(&html, &["embedding 0.25 s", "width=\"1000\""]);
    assert_eq!(html, page_of(folder.path()), "the page is deterministic");
}

#[test]
fn goals_that_are_missed_are_no_failures() {
    let folder = tempfile::tempdir().unwrap();
    let mut record = figure4_record(&[("cat", 3), ("dog", 2)]);
    record.expectations[1].goal = true;
    write(&record, folder.path().join("figure4.json")).unwrap();
    let html = without_scripts(&page_of(folder.path()));
    assert!(html.contains("<span class=\"goal\">○ 1 of 2 expectations held, 1 goal missed</span>"));
    assert!(html.contains("<td class=\"goal\">○ goal missed</td>") && !html.contains("class=\"failed\""));
    record.expectations.truncate(1);
    write(&record, folder.path().join("figure4.json")).unwrap();
    let html = without_scripts(&page_of(folder.path()));
    assert!(html.contains("✓ 1 of 1 expectations held</span>") && !html.contains("class=\"outcomes\""));
}

#[test]
fn counts_of_many_classes_have_room() {
    let folder = tempfile::tempdir().unwrap();
    let mut record = retrieval_record();
    let names: Vec<String> = (0..30).map(|i| format!("class{i}")).collect();
    record.results.classification.confusion = vec![vec![1; 31]; 30];
    record.results.classification.classes = names;
    save(&record, folder.path(), "retrieval").unwrap();
    assert!(page_of(folder.path()).contains("class=\"plot counts\" style=\"--cells: 31\""));
    let svg = fs::read_to_string(folder.path().join("retrieval-confusion.svg")).unwrap();
    assert!(svg.matches(">\n1\n</text>").count() == 30 * 31, "every count is written");
    assert!(
        (0..30).all(|i| svg.matches(&format!(">\nclass{i}\n</text>")).count() == 2),
        "every class is named"
    );
}

#[test]
fn retrieval_has_its_scores_curves_and_confusion() {
    let folder = tempfile::tempdir().unwrap();
    let record = retrieval_record();
    save(&record, folder.path(), "retrieval").unwrap();
    let html = page_of(folder.path());
    assert_eq!(without_scripts(&html).matches("data:image/svg+xml;base64,").count(), 2);
    assert_holds(&html, &["wave-kernel", "ignored", "counts", "0.875", "0.625", "Near is alike."]);
    assert_holds(&html, &["3 nearest neighbours", "0.512 for E"]);
    assert_holds(&html, &["<td>a1</td><td>a &amp; b</td><td>unknown</td><td>cat0</td>"]);
}

#[test]
fn names_from_files_never_become_markup() {
    let folder = tempfile::tempdir().unwrap();
    let mut record = figure1_record();
    record.results.shapes[0].name = "<script>alert(1)</script>".into();
    record.results.shapes[0].repair = vec!["<i>".into()];
    record.analysis = "a < b & c".into();
    record.provenance.command = "run '<u>'".into();
    write(&record, folder.path().join("figure1.json")).unwrap();
    let html = page_of(folder.path());
    let html = without_scripts(&html);
    for raw in ["<script", "<i>", "<u>", "a < b", "dog<3>", "<b>"] {
        assert!(!html.contains(raw), "{raw}");
    }
    assert_holds(&html, &["&lt;script&gt;alert(1)", "dog&lt;3&gt;", "a &lt; b &amp; c"]);
    assert_holds(&html, &["figure1-forms.svg</code> is missing", "262.1"]);
    assert!(!html.contains("nothing"));
    // Nor in plots and data.
    let evil = "</script><img src=x onerror=alert(1)>";
    let classes = [(evil, 2), ("\" onclick=\"x", 1)];
    let folder = full_folder(&figure4_record(&classes), Some(&shapes_record(&classes)));
    let html = page_of(folder.path());
    assert!(!html.contains("<img src=x") && !without_scripts(&html).contains("\" onclick=\""));
    assert_eq!(islands(&html)["figure4-data"]["labels"][0], evil, "kept as data");
}

#[test]
fn an_unreadable_record_is_an_error_that_names_the_file() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("figure4.json"), "{\"names\": 3").unwrap();
    let error = write_report(folder.path(), "", &sections()).unwrap_err();
    assert!(
        matches!(error, ReportError::Parse { .. }) && error.to_string().contains("figure4.json"),
        "{error}"
    );
    assert!(!folder.path().join(FILE).exists());
}

#[test]
fn figures_of_several_methods_have_medians_ranges_and_the_numbers_of_the_paper() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    write(&figure3_record(), place("figure3.json")).unwrap();
    save(&curves_record(), folder.path(), "figure6").unwrap();
    write(&figure9_record(), place("figure9.json")).unwrap();
    let html = page_of(folder.path());
    assert_holds(&html, &["href=\"figure6-curves.svg\"", "figure3-forms.svg</code> is missing"]);
    assert_holds(&html, &["394.41", "386.2", "david&lt;0&gt;", "<summary>cat0</summary>", "error, in m⁴"]);
    assert_holds(&html, &["1.0e4", "0.025", "3.0 MiB", "0.24", "all pairs need &lt;5.8&gt; GiB"]);
    assert_holds(&html, &["2 worker threads"]);
}

/// A folder with all records.
fn full_folder(figure4: &Record<Figure4Results>, shapes: Option<&ShapesRecord>) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    write(&figure1_record(), place("figure1.json")).unwrap();
    write(&figure3_record(), place("figure3.json")).unwrap();
    write(figure4, place("figure4.json")).unwrap();
    shapes.iter().for_each(|shapes| write(shapes, place(SHAPES_FILE)).unwrap());
    for name in CURVES {
        write(&curves_record(), place(&format!("{name}.json"))).unwrap();
    }
    write(&figure9_record(), place("figure9.json")).unwrap();
    write(&retrieval_record(), place("retrieval.json")).unwrap();
    folder
}

/// The islands of data on a page, by name.
fn islands(html: &str) -> BTreeMap<String, serde_json::Value> {
    let parts = html.split("<script type=\"application/json\" id=\"").skip(1);
    let island = |part: &str| {
        let (id, rest) = part.split_once("\">").unwrap();
        let (json, _) = rest.split_once("</script>").unwrap();
        (id.to_owned(), serde_json::from_str(json).unwrap())
    };
    parts.map(island).collect()
}

const CLASSES: [(&str, usize); 2] = [("cat", 3), ("dog", 2)];

#[test]
fn every_section_has_its_plots_and_their_data_once_in_the_page() {
    let folder = full_folder(&figure4_record(&CLASSES), Some(&shapes_record(&CLASSES)));
    let html = page_of(folder.path());
    assert_eq!(html.matches("* plotly.js v").count(), 1, "plotly is there once");
    assert_eq!(html.matches("const canonform = ").count(), 1);
    for Section { name, .. } in sections() {
        assert_eq!(html.matches(&format!("<section id=\"{name}\">")).count(), 1, "{name}");
    }
    let islands = islands(&html);
    for chart in ["figure3-stress", "figure4", "figure7-curves", "figure9-times", "retrieval-confusion"] {
        assert_eq!(html.matches(&format!("id=\"{chart}-chart\"")).count(), 1, "{chart}");
        assert!(islands.contains_key(&format!("{chart}-data")), "{chart}");
    }
    let plain = without_scripts(&html);
    for source in plain.split("data-source=\"").skip(1) {
        let (source, _) = source.split_once('"').unwrap();
        assert!(islands.contains_key(source), "{source}");
    }
    // Six records of two panels each, the precision at two scales, the stress on one shape, and the times.
    assert_eq!(plain.matches("data-plot=\"plot\"").count(), 16);
    assert_eq!(islands["figure7-curves-data"]["plots"][0]["y"]["name"], "error (m⁴)");
    assert_eq!(islands["figure4-data"]["names"].as_array().map(Vec::len), Some(5));
    assert_eq!(islands["figure4-data"]["thumbnails"][4]["forms"].as_array().map(Vec::len), Some(2));
    assert_eq!(islands["figure4-shape-4"]["forms"][0]["size"], 2.0);
    // The maps of both methods, and their matrices, are beside each other.
    for kind in ["map", "matrix"] {
        let plots: Vec<&str> = plain.split(&format!("data-plot=\"{kind}\" data-method=\"")).skip(1).collect();
        assert_eq!(plots.len(), 2);
        assert!(plots[0].starts_with("NMDS\"") && plots[1].starts_with("KPCA-Nyström\""));
        assert!(!plots[0].contains("</div>\n</div>"), "one grid");
    }
    assert!(plain.contains("id=\"figure1-explorer\""));
    assert!(plain.contains("<option value=\"0\" selected>cat0</option>"));
    let ids: Vec<&str> = html.split(" id=\"").skip(1).filter_map(|part| part.split('"').next()).collect();
    assert_eq!(ids.iter().collect::<std::collections::BTreeSet<_>>().len(), ids.len(), "no id twice");
    // The page fetches nothing.
    assert!(html.contains("default-src 'none'"));
    for source in plain.split("src=\"").skip(1) {
        assert!(source.starts_with("data:"), "{}", &source[..20]);
    }
    for outside in
        ["<link", "http:", "https:", "@import", "url(", "srcset", "<iframe", " onerror", " onclick"]
    {
        assert!(!plain.contains(outside), "{outside}");
    }
    assert!(!html.contains("<script src"));
}

#[test]
fn folders_without_surfaces_have_their_map_and_name_the_command_that_adds_them() {
    let figure4 = figure4_record(&CLASSES);
    let others = shapes_record(&[("cat", 2)]);
    for shapes in [None, Some(&others)] {
        let html = page_of(full_folder(&figure4, shapes).path());
        assert!(html.contains("id=\"figure4-map-0\"") && !html.contains("id=\"figure4-overlay\""));
        assert!(html.contains("run <code>experiments run all --dataset &#39;a &amp; b&#39;</code>"));
        assert!(!html.contains("id=\"figure4-shape-0\"") && !html.contains("id=\"figure1-explorer\""));
    }
}
