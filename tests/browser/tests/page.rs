//! What other tests rely on: messages and requests are recorded, and errors of the page are errors.

use std::fs;
use std::path::Path;

use browser::Browser;

#[test]
fn requests_and_errors_are_recorded_and_other_machines_are_unreachable() {
    let Some(browser) = Browser::start() else { return };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("page.html");
    fs::write(
        &path,
        "<meta http-equiv='content-security-policy' content=\"img-src 'none'\">
         <link rel=stylesheet href='http://example.com/style.css'><img src='http://127.0.0.1:9/x.png'>",
    )
    .unwrap();
    browser.open_file(&path).unwrap();
    let requests = browser.requests().unwrap();
    assert!(requests.iter().any(|r| r.ends_with("page.html")), "{requests:?}");
    assert!(requests.iter().any(|r| r == "http://example.com/style.css"), "{requests:?}");
    let console = browser.console().unwrap();
    assert!(console.iter().any(|text| text.contains("ERR_NAME_NOT_RESOLVED")), "{console:?}");
    assert!(console.iter().any(|text| text.contains("Content Security Policy")), "{console:?}");

    let error = browser.eval("throw new Error('of the page')").unwrap_err();
    assert!(error.to_string().contains("of the page"), "{error}");
    browser.upload("body", &[Path::new("/no/such/file")]).unwrap_err();
    browser.eval("throw 1").unwrap_err();
}
