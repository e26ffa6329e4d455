use super::*;
use crate::fixtures::{assert_balanced, figure1_record, figure4_record};
use crate::results::write;

fn page_of(folder: &Path) -> String {
    let path = write_report(folder).unwrap();
    assert_eq!(path, folder.join(FILE));
    let html = fs::read_to_string(path).unwrap();
    assert_balanced(&html);
    html
}

#[test]
fn what_was_not_run_is_said_with_the_command_that_runs_it() {
    let folder = tempfile::tempdir().unwrap();
    let html = page_of(folder.path());
    for name in ["figure1", "figure4"] {
        assert!(html.contains(&format!("{name}.json</code> is not in this folder")));
        assert!(html.contains(&format!("run {name}</code>")));
    }
    assert!(!html.contains("expectations"));
}

#[test]
fn figures_numbers_options_and_expectations_are_all_there() {
    let folder = tempfile::tempdir().unwrap();
    let record = figure4_record(&[("cat", 3), ("dog", 2)]);
    write(&record, folder.path().join("figure4.json")).unwrap();
    figure4::figure4(&record, folder.path().join("figure4")).unwrap();
    let html = page_of(folder.path());
    assert_eq!(html.matches("data:image/png;base64,").count(), 4);
    for (part, _, _) in figure4::PARTS {
        assert!(html.contains(&format!("href=\"figure4{part}.svg\"")), "{part}");
    }
    for text in [
        "1 of 2 expectations failed",
        "✓ held",
        "✗ failed",
        "0.910",
        "\u{2212}0.125",
        "0.875",
        "Two clusters.",
    ] {
        assert!(html.contains(text), "{text}");
    }
    for text in ["experiments 0.1.0", "--dataset", "rank", "embedding 0.25 s", "width=\"2000\""] {
        assert!(html.contains(text), "{text}");
    }
    assert_eq!(html, page_of(folder.path()), "the page is deterministic");
}

#[test]
fn names_from_files_never_become_markup() {
    let folder = tempfile::tempdir().unwrap();
    let mut record = figure1_record();
    record.shapes[0].name = "<script>alert(1)</script>".into();
    record.shapes[0].repair = vec!["<i>".into()];
    record.analysis = "a < b & c".into();
    record.provenance.command = "run '<u>'".into();
    write(&record, folder.path().join("figure1.json")).unwrap();
    let html = page_of(folder.path());
    for raw in ["<script", "<i>", "<u>", "a < b", "dog<3>", "<b>"] {
        assert!(!html.contains(raw), "{raw}");
    }
    assert!(
        html.contains("&lt;script&gt;alert(1)")
            && html.contains("dog&lt;3&gt;")
            && html.contains("a &lt; b &amp; c")
    );
    assert!(html.contains("figure1-forms.png</code> is missing"));
    assert!(
        html.contains("262.1")
            && html.contains("nothing") == record.shapes.iter().any(|s| s.repair.is_empty())
    );
}

#[test]
fn a_broken_record_is_an_error_that_names_the_file() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("figure4.json"), "{\"names\": 3").unwrap();
    let error = write_report(folder.path()).unwrap_err();
    assert!(
        matches!(error, ReportError::Parse { .. }) && error.to_string().contains("figure4.json"),
        "{error}"
    );
    assert!(!folder.path().join(FILE).exists());
}
