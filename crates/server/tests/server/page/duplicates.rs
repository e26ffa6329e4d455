//! The page of duplicates: groups, marks, downloads, the comparison of two members.

use std::path::Path;

use datasets::{Damage, Family, PartMesh, mechanical_parts};
use serde_json::json;

use super::support::{AWKWARD, Page, body};
use crate::support::{options, write_indexed};

const READY: &str = "document.querySelector('#duplicates').dataset.state === 'ready'";

/// A part with a copy of its file and one that is turned, a part of another family, and a cat with a finer copy.
fn index(folder: &Path) {
    let [part, other] = [0, 5].map(|i| mechanical_parts(0, 8)[i].mesh(&PartMesh::default()));
    let cat = body(Family::Cat, 0).mesh;
    let meshes = [
        ("part", part.clone()),
        (AWKWARD, part.clone()),
        ("turned part", Damage::Move.apply(&part, 3)),
        ("other part", other),
        ("cat", cat.clone()),
        ("finer cat", canonform::mesh::shapes::subdivide(&cat)),
    ];
    write_indexed(folder, &meshes);
}

/// The text that a button downloads.
fn downloaded(page: &Page, css: &str) -> String {
    let body = format!(
        "return new Promise(done => {{
             const make = URL.createObjectURL;
             URL.createObjectURL = blob => {{ URL.createObjectURL = make; blob.text().then(done); return make(blob); }};
             document.querySelector('{css}').click();
         }})"
    );
    page.browser.eval(&body).unwrap().as_str().unwrap().to_owned()
}

#[test]
#[ignore = "slow: make test-all"]
fn groups_are_compared_and_marked() {
    let folder = tempfile::tempdir().unwrap();
    index(folder.path());
    let Some(page) = Page::of(folder.path(), [1280, 800], options()) else { return };
    page.go("/");
    page.wait_for("document.querySelectorAll('#shapes .tile').length === 6");
    page.browser.click("nav a[href='/duplicates']").unwrap();
    page.wait_for(READY);
    assert_eq!(page.address(), "/duplicates");
    assert!(page.text("#told").starts_with("3 of 6 shapes can be spared: 2 groups of files of one shape"));
    let sizes =
        "[...document.querySelectorAll('.group')].map(group => group.querySelectorAll('.tile').length)";
    assert_eq!(page.eval(sizes), json!([3, 2]));

    let keepers = "[...document.querySelectorAll('.group')].map(group => group.dataset.id)";
    let found = page.eval(keepers);
    page.choose("sort", "name");
    let mut names: Vec<String> = serde_json::from_value(found).unwrap();
    names.sort();
    assert_eq!(page.eval(keepers), json!(names));
    page.assert_reached_by_tab();
    // Enter on a file shows it beside the one to keep.
    page.browser.type_into(".tile[data-id='finer cat']", "\u{e007}").unwrap();
    page.overlaid("finer cat");
    assert_eq!(page.address(), "/duplicates?a=cat&b=finer+cat");
    page.browser.eval("location.reload()").unwrap();
    page.wait_for(READY);
    page.overlaid("finer cat");
    for view in ["overlay-view", "overlay-second"] {
        page.wait_for(&format!("document.querySelector('#{view}').dataset.state === 'ready'"));
    }
    assert_eq!(page.eval("document.querySelector('#overlay').dataset.shown"), "meshes");
    assert_eq!(page.eval("document.querySelector('#overlay').closest('.group').dataset.id"), "cat");
    page.browser.click("#close-hit").unwrap();
    page.wait_for("document.querySelector('#overlay').hidden");

    // A group keeps one file at least, and marks stay.
    for id in ["cat", "finer cat"] {
        page.browser.click(&format!("[aria-label='Spare {id}']")).unwrap();
    }
    assert!(
        page.text("#marked").contains("Of 1 group nothing would be left: cat."),
        "{}",
        page.text("#marked")
    );
    page.browser.click("[aria-label='Spare cat']").unwrap();
    page.browser.click("#suggest").unwrap();
    page.browser.eval("location.reload()").unwrap();
    page.wait_for(READY);
    assert!(page.text("#marked").starts_with("3 files marked as spare"), "{}", page.text("#marked"));
    let table = downloaded(&page, "#as-csv");
    assert_eq!((table.lines().count(), table.matches(",spare,").count()), (6, 3), "{table}");
    assert_eq!(page.eval("document.querySelectorAll('img[src=\"x\"]').length"), 0);
    page.assert_sound();
    page.browser.click("#clear").unwrap();
    assert!(page.text("#marked").starts_with("0 files marked"));
    page.browser.resize(360, 800).unwrap();
    page.assert_sound();
}
