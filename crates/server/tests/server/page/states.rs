//! Every state of the page has an address: it can be opened, reloaded, and left with the back button.

use std::time::Duration;

use canonform_server::ServeOptions;
use datasets::Family;
use serde_json::json;

use super::search::file;
use super::support::Page;
use crate::support::options;

const N_RESULTS: &str = "document.querySelectorAll('#results .tile').length";
const AT_THE_START: &str = "document.querySelector('#answer').dataset.state === 'empty' && \
                            document.querySelector('#page').dataset.at === 'start' && \
                            document.querySelectorAll('#shapes .tile').length === 10";

#[test]
#[ignore = "slow: make test-all"]
fn every_state_of_an_indexed_shape_is_reached_by_its_address() {
    let Some(page) = Page::open(1280, 900) else { return };
    page.wait_for(AT_THE_START);
    assert_eq!(page.address(), "/");
    page.browser.click("#shapes .tile[data-id^=cat]").unwrap();
    page.answered();
    let shape = page.text("#query-name");
    assert_eq!(page.address(), format!("/?shape={shape}"));
    assert!(page.eval("document.title").as_str().unwrap().starts_with(&shape));
    let other = page.eval("document.querySelector('#results li:nth-child(2) .tile').dataset.id");
    let other = other.as_str().unwrap();
    page.browser.click("#results li:nth-child(2) .tile").unwrap();
    page.overlaid(other);
    assert_eq!(page.address(), format!("/?shape={shape}&hit={other}"));

    // Reload, back twice, and forward.
    page.browser.eval("location.reload()").unwrap();
    page.answered();
    page.overlaid(other);
    page.browser.eval("history.back()").unwrap();
    page.wait_for(&format!("location.search === '?shape={shape}'"));
    page.answered();
    page.wait_for("document.querySelector('#overlay').hidden");
    page.browser.eval("history.back()").unwrap();
    page.wait_for(AT_THE_START);
    page.browser.eval("history.go(2)").unwrap();
    page.answered();
    page.overlaid(other);

    page.browser.click("#search-hit").unwrap();
    page.wait_for(&format!("document.querySelector('#query-name').textContent === {}", json!(other)));
    page.answered();
    assert_eq!(page.address(), format!("/?shape={other}"));
    assert_eq!(page.eval("document.querySelector('#overlay').hidden"), true);
    page.assert_sound();
}

/// The page can be used with the keyboard alone.
fn use_the_keyboard(page: &Page) {
    page.wait_for(AT_THE_START);
    page.assert_reached_by_tab();
    page.browser.type_into("#shapes .tile[data-id^=cat]", "\u{e007}").unwrap();
    page.answered();
    page.browser.type_into("#results li:nth-child(2) .tile", "\u{e00d}").unwrap();
    page.wait_for("document.querySelector('#overlay').dataset.state === 'ready'");
    assert_eq!(page.eval("document.activeElement.id"), "overlay-title");
    page.browser.type_into("#close-hit", "\u{e007}").unwrap();
    page.wait_for("document.querySelector('#overlay').hidden");
    assert_eq!(page.eval("document.activeElement.closest('#results') !== null"), true);
    page.assert_sound();
}

#[test]
fn options_filters_and_downloads_follow_the_address() {
    let Some(page) = Page::open(1280, 900) else { return };
    use_the_keyboard(&page);
    page.go("/?shape=cat0&k=3&filter=cent");
    page.answered();
    assert_eq!(page.eval(N_RESULTS), 3);
    assert_eq!(page.eval("document.querySelector('#k').value"), "3");
    page.wait_for("document.querySelectorAll('#shapes .tile').length === 3");
    page.choose("k", "6");
    page.wait_for(&format!("{N_RESULTS} === 6"));
    assert_eq!(page.address(), "/?shape=cat0&k=6&filter=cent");
    page.choose("rank", "forms");
    page.wait_for("location.search.includes('rank=forms')");
    page.answered();
    page.browser.eval("history.back()").unwrap();
    page.wait_for("document.querySelector('#rank').value === 'plain'");
    page.answered();
    assert_eq!(page.address(), "/?shape=cat0&k=6&filter=cent");
    let table = page.eval("fetch(document.querySelector('#as-csv').href).then(found => found.text())");
    assert_eq!(table.as_str().unwrap().lines().count(), 7, "{table}");
    let json = page.eval("fetch(document.querySelector('#as-json').href).then(found => found.json())");
    assert_eq!((json["results"].as_array().unwrap().len(), &json["mesh"]), (6, &serde_json::Value::Null));
    page.assert_sound();
}

#[test]
#[ignore = "slow: make test-all"]
fn an_upload_has_an_address_until_it_expires() {
    let lifetime = Duration::from_secs(20);
    let brief = ServeOptions { query_lifetime: lifetime, ..options() };
    let Some(page) = Page::with(1280, 900, brief) else { return };
    let folder = tempfile::tempdir().unwrap();
    page.browser.upload("#file", &[&file(&folder, "new.off", Family::David)]).unwrap();
    page.answered();
    let query = page.address();
    assert!(query.starts_with("/?query=") && query.len() == 8 + 32, "{query}");
    page.browser.eval("location.reload()").unwrap();
    page.answered();
    assert_eq!((page.text("#query-name"), page.address()), ("new.off".to_owned(), query.clone()));
    page.browser.eval("history.back()").unwrap();
    page.wait_for(AT_THE_START);

    std::thread::sleep(lifetime);
    page.browser.eval("history.forward()").unwrap();
    page.wait_for("document.querySelector('#answer').dataset.state === 'failed'");
    assert_eq!(page.text("#error"), "new.off: this upload has expired; choose the file again");
    page.browser.upload("#file", &[&file(&folder, "new.off", Family::David)]).unwrap();
    page.answered();
    assert_eq!((page.text("#error"), page.address()), (String::new(), query));
}
