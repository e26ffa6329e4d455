//! Tests of the harness on pages of its own.

use std::fs;
use std::path::Path;

use browser::Browser;

const PAGE: &str = r#"<!doctype html><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<style>body { margin: 0 } #pad { width: 200px; height: 200px; background: silver }
@media (prefers-color-scheme: dark) { #pad { background: black } }
@media print { #pad { display: none } }</style>
<div id="pad"></div><button id="b">press</button><input id="file" type="file"><input id="text">
<script>
const seen = window.seen = [];
const pad = document.querySelector('#pad');
for (const kind of ['pointerdown', 'pointermove', 'pointerup']) pad.addEventListener(kind, e => seen.push([kind, e.clientX, e.clientY]));
pad.addEventListener('drop', e => { e.preventDefault(); e.dataTransfer.files[0].text().then(t => { window.dropped = e.dataTransfer.files[0].name + ':' + t; }); });
document.querySelector('#b').addEventListener('click', () => console.warn('pressed'));
document.querySelector('#file').addEventListener('change', e => e.target.files[0].text().then(t => { window.given = t; }));
</script>"#;

#[test]
fn actions_reach_the_page_and_its_messages_are_recorded() {
    let Some(browser) = Browser::start() else { return };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("page.html");
    fs::write(&path, PAGE).unwrap();
    browser.open_file(&path).unwrap();
    assert_eq!(browser.console().unwrap(), []);
    assert_eq!(browser.eval("return [innerWidth, innerHeight]").unwrap(), serde_json::json!([1280, 800]));

    browser.drag("#pad", [40, 20]).unwrap();
    let seen = browser.eval("return seen").unwrap();
    let kinds: Vec<&str> = seen.as_array().unwrap().iter().filter_map(|e| e[0].as_str()).collect();
    assert!(kinds.contains(&"pointerdown") && kinds.contains(&"pointerup"), "{kinds:?}");
    assert!(kinds.iter().filter(|kind| **kind == "pointermove").count() > 5, "{kinds:?}");
    let last = &seen[kinds.len() - 1];
    assert_eq!((&last[1], &last[2]), (&140.into(), &120.into()));

    fs::write(folder.path().join("mesh.off"), "OFF").unwrap();
    browser.upload("#file", &[&folder.path().join("mesh.off")]).unwrap();
    browser.wait_for("window.given === 'OFF'").unwrap();
    browser.drop_file("#pad", "a<b>.off", b"dropped \xc3\xa9").unwrap();
    browser.wait_for("window.dropped === 'a<b>.off:dropped \u{e9}'").unwrap();
    browser.type_into("#text", "words").unwrap();
    assert_eq!(browser.eval("return document.querySelector('#text').value").unwrap(), "words");

    let color = "return getComputedStyle(document.querySelector('#pad')).backgroundColor";
    let display = "return getComputedStyle(document.querySelector('#pad')).display";
    browser.prefer("prefers-color-scheme", "dark").unwrap();
    assert_eq!(browser.eval(color).unwrap(), "rgb(0, 0, 0)");
    browser.media("print").unwrap();
    assert_eq!(browser.eval(display).unwrap(), "none");
    browser.media("screen").unwrap();
    assert_eq!(browser.eval(display).unwrap(), "block");
    browser.resize(390, 844).unwrap();
    assert_eq!(browser.eval("return [innerWidth, screen.width]").unwrap(), serde_json::json!([390, 390]));

    browser.click("#b").unwrap();
    let console = browser.console().unwrap();
    assert_eq!((console.len(), console[0].level.as_str()), (1, "WARNING"), "{console:?}");
    assert!(console[0].text.contains("pressed"));
    assert_eq!(browser.console().unwrap(), console, "messages are kept");

    let picture = folder.path().join("picture.png");
    for take in [Browser::screenshot, Browser::screenshot_all] {
        take(&browser, &picture).unwrap();
        assert!(fs::read(&picture).unwrap().starts_with(b"\x89PNG"));
    }
}

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
    assert!(console.iter().any(|m| m.text.contains("ERR_NAME_NOT_RESOLVED")), "{console:?}");
    assert!(console.iter().any(|m| m.text.contains("Content Security Policy")), "{console:?}");

    let error = browser.eval("throw new Error('of the page')").unwrap_err();
    assert!(error.to_string().contains("of the page"), "{error}");
    browser.upload("body", &[Path::new("/no/such/file")]).unwrap_err();
    browser.eval("throw 1").unwrap_err();
}

#[test]
fn meshes_are_drawn_without_a_graphics_card() {
    let Some(browser) = Browser::start() else { return };
    browser.open("about:blank").unwrap();
    // Several frames that the page never reads back.
    let drawn = "const canvas = document.body.appendChild(document.createElement('canvas'));
        const gl = canvas.getContext('webgl');
        if (!gl) return false;
        let frames = 0;
        return new Promise(done => {
            const draw = () => {
                gl.clearColor(frames % 2, 1, 0, 1);
                gl.clear(gl.COLOR_BUFFER_BIT);
                if (++frames < 20) requestAnimationFrame(draw); else done(true);
            };
            draw();
        })";
    assert_eq!(browser.eval(drawn).unwrap(), true);
    browser.screenshot(&tempfile::tempdir().unwrap().path().join("scene.png")).unwrap();
    assert_eq!(browser.console().unwrap(), []);
}
