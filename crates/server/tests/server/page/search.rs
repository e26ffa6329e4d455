//! Searching with a mesh or a shape of the index, and the display of results.

use std::fs;

use datasets::Family;
use serde_json::json;

use super::support::{AWKWARD, Page, body};

/// A mesh in a file of its own.
pub(crate) fn file(folder: &tempfile::TempDir, name: &str, family: Family) -> std::path::PathBuf {
    let path = folder.path().join(name);
    canonform::mesh::io::write(&path, &body(family, 4).mesh).unwrap();
    path
}

#[test]
fn a_chosen_mesh_is_classified_and_overlaid_with_a_result() {
    let Some(page) = Page::open(1280, 900) else { return };
    let folder = tempfile::tempdir().unwrap();
    page.browser.upload("#file", &[&file(&folder, "new.off", Family::Cat)]).unwrap();
    page.answered();
    page.wait_for("document.querySelector('#mesh-view').dataset.state === 'ready'");
    assert_eq!(page.eval("document.querySelector('#predicted').dataset.label"), "cat");
    assert_eq!(page.text("#query-name"), "new.off");
    assert!(page.text("#facts").contains("1000 vertices"), "{}", page.text("#facts"));
    let labels =
        "[...document.querySelectorAll('#results .tile')].slice(0, 3).map(tile => tile.dataset.label)";
    assert_eq!(page.eval(labels), json!(["cat", "cat", "cat"]));
    // Content that arrives late must not shift the layout.
    page.browser
            .eval(
                "const fetch = window.fetch;
                 window.fetch = async (...asked) => { await new Promise(done => setTimeout(done, 300)); return fetch(...asked); };",
            )
            .unwrap();
    page.browser.click("#results li:first-child .tile").unwrap();
    page.wait_for("document.querySelector('#overlay').dataset.state === 'ready'");
    page.wait_for("document.querySelector('#overlay-view').dataset.state === 'ready'");
    let told = "document.querySelector('#overlay-kind').dataset.kind";
    page.wait_for(&format!("['identical-file', 'identical-geometry', 'other-pose'].includes({told})"));
    page.browser.click("#match-hit").unwrap();
    page.wait_for("document.querySelector('#match').dataset.state === 'ready'");
    page.wait_for("document.querySelector('#match-second').dataset.state === 'ready'");
    assert!(page.text("#match-facts").contains("same color"), "{}", page.text("#match-facts"));
    page.browser.click("input[name=shown][value=second]").unwrap();
    page.wait_for("document.querySelector('#overlay-view .canonform-scene').data.length === 1");
    page.assert_sound();
    let (shifts, moved) = page.browser.shifts().unwrap();
    assert!(shifts < 0.01, "the layout shifts by {shifts}: {moved}");
    page.browser.resize(390, 844).unwrap();
    page.assert_sound();
}

#[test]
fn names_are_never_interpreted_as_html() {
    let Some(page) = Page::open(1280, 900) else { return };
    assert_eq!(page.eval("document.querySelectorAll('#shapes .tile')[0].dataset.id"), AWKWARD);
    page.browser.click("#shapes li:first-child .tile").unwrap();
    page.answered();
    assert_eq!(page.text("#query-name"), AWKWARD);
    page.browser.click("#results li:nth-child(2) .tile").unwrap();
    page.wait_for("document.querySelector('#overlay').dataset.state === 'ready'");
    assert!(page.text("#overlay-title").starts_with(AWKWARD));
    let folder = tempfile::tempdir().unwrap();
    let bytes = fs::read(file(&folder, "x.off", Family::Cat)).unwrap();
    // Browsers write quotes in the names of files as %22 when they send them.
    let name = format!("{AWKWARD}.off").replace('"', "");
    page.browser.drop_file("#drop", &name, &bytes).unwrap();
    page.wait_for(&format!("document.querySelector('#query-name').textContent === {}", json!(name)));
    page.answered();
    assert_eq!(page.eval("document.querySelector('#predicted').dataset.label"), "cat");
    assert_eq!(page.eval("document.querySelector('#drop').classList.contains('over')"), false);
    // An element made from a name would have requested its image and logged an error.
    assert_eq!(page.eval("document.querySelectorAll('img[src=\"x\"]').length"), 0);
    page.assert_sound();

    // A bad mesh is reported, and the page still works.
    let path = folder.path().join("bad.off");
    fs::write(&path, "OFF\n3 1 0\n0 0 0\n1 0 0\n").unwrap();
    page.browser.upload("#file", &[&path]).unwrap();
    page.wait_for("document.querySelector('#answer').dataset.state === 'failed'");
    assert!(page.text("#error").contains("bad.off"), "{}", page.text("#error"));
    page.browser.upload("#file", &[&file(&folder, "good.off", Family::Centaur)]).unwrap();
    page.answered();
    assert_eq!(page.text("#error"), "");
    // The browser itself logs the failed response.
    let console = page.browser.console().unwrap();
    let is_expected = |text: &str| text.contains("/api/search") && text.contains("status of 4");
    assert!(console.iter().all(|message| is_expected(message)), "{console:?}");
}
