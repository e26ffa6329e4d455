use std::path::PathBuf;
use std::process::Command;
use std::sync::OnceLock;

use browser::Browser;
use serde_json::{Value, json};

/// The report on Figures 1 and 4 of six small shapes, made once.
fn report() -> PathBuf {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    let folder = FOLDER.get_or_init(|| {
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("report-page");
        let run = Command::new(env!("CARGO_BIN_EXE_experiments"))
            .args(["run", "figure1", "figure4", "--families", "creatures:2x3", "--vertices", "1000"])
            .args(["--quiet", "--output"])
            .arg(&folder)
            .output()
            .unwrap();
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        folder
    });
    folder.join("report.html")
}

/// The page in a browser window of this size, with its views drawn.
fn opened(size: [u32; 2]) -> Option<Browser> {
    let browser = Browser::start()?;
    browser.resize(size[0], size[1]).unwrap();
    browser.watch_layout().unwrap();
    browser.open_file(&report()).unwrap();
    browser
        .eval("document.querySelector('.gallery').scrollIntoView({ block: 'center', behavior: 'instant' })")
        .unwrap();
    drawn(&browser);
    Some(browser)
}

/// Waits until both views are drawn.
fn drawn(browser: &Browser) {
    let views = "[...document.querySelectorAll('.view')]";
    browser
        .wait_for(&format!("{views}.length === 2 && {views}.every(view => view.dataset.state === 'ready')"))
        .unwrap();
}

/// Asserts that the console is empty and that the page requested nothing but itself.
fn assert_silent(browser: &Browser) {
    assert_eq!(browser.console().unwrap(), Vec::<String>::new());
    let outside = |address: &String| {
        let is_page = address.starts_with("file://") && address.ends_with("/report.html");
        !is_page && !["data:", "blob:"].iter().any(|inside| address.starts_with(inside))
    };
    let requested: Vec<String> = browser.requests().unwrap().into_iter().filter(outside).collect();
    assert!(requested.is_empty(), "{requested:?}");
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

#[test]
fn views_show_a_shape_with_its_form_and_rotate_together() {
    let Some(browser) = opened([1280, 900]) else { return };
    let eyes = "[...document.querySelectorAll('.view .canonform-scene')].map(view => {
        const { x, y, z } = view._fullLayout.scene._scene.getCamera().eye;
        return [x, y, z].map(value => value.toFixed(6)).join(' ');
    })";
    let before = browser.eval(&format!("return {eyes}[0]")).unwrap();
    browser.drag(".view .canonform-scene", [70, -25]).unwrap();
    let turned = "(([a, b]) => a === b && a !== BEFORE)".replace("BEFORE", &before.to_string());
    browser.wait_for(&format!("{turned}({eyes})")).unwrap();
    for (css, choice) in [(".color", "distance"), (".shape", "4"), (".color", "class")] {
        browser
            .eval(&format!(
                "const select = document.querySelector('{css}'); select.value = {};
                 select.dispatchEvent(new Event('change', {{ bubbles: true }}));",
                json!(choice)
            ))
            .unwrap();
        drawn(&browser);
    }
    let titles = "return [document.querySelector('.shape').selectedOptions[0].text, ...[...document.querySelectorAll('.canonform-title')].map(t => t.textContent)]";
    let titles = browser.eval(titles).unwrap();
    assert_eq!(titles[1], format!("shape: {}", titles[0].as_str().unwrap()));
    assert!(titles[2].as_str().unwrap().starts_with("canonical form: stress "), "{titles}");
    // Points of the map have the names of shapes.
    let names = browser.eval("return document.querySelectorAll('#figure4 circle > title').length").unwrap();
    assert!(number(&names) >= 6.0, "{names}");
    assert_silent(&browser);
}

#[test]
#[ignore = "slow: make test-all"]
fn the_layout_is_stable_and_fits_wide_and_narrow_screens_dark_mode_and_print() {
    for (name, size) in [("1280", [1280, 900]), ("390", [390, 844])] {
        let Some(browser) = opened(size) else { return };
        let (shifts, moved) = browser.shifts().unwrap();
        assert!(shifts < 0.001, "{name}: the layout shifts by {shifts}: {moved}");
        let widths = browser.eval("return [document.documentElement.scrollWidth, innerWidth]").unwrap();
        assert!(number(&widths[0]) <= number(&widths[1]), "{name}: {widths}");
        if name == "1280" {
            browser.prefer("prefers-color-scheme", "dark").unwrap();
            let light = "const light = color => { const [r, g, b] = color.match(/[\\d.]+/g).map(Number); return (r + g + b) / 765; };
                const fill = css => light(getComputedStyle(document.querySelector(css)).fill);
                return [light(getComputedStyle(document.body).backgroundColor), fill('#figure4 svg rect'), fill('#figure4 svg text')];";
            let light = browser.eval(light).unwrap();
            assert!(number(&light[0]) < 0.2 && number(&light[1]) < 0.2 && number(&light[2]) > 0.7, "{light}");
            browser.media("print").unwrap();
            let seen = |css: &str| {
                let count = format!(
                    "return [...document.querySelectorAll('{css}')].filter(e => e.getClientRects().length > 0).length"
                );
                number(&browser.eval(&count).unwrap())
            };
            assert!(seen(".gallery") == 0.0 && seen("figure svg") > 5.0);
        }
        assert_silent(&browser);
    }
}
