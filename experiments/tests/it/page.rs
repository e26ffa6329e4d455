use std::path::PathBuf;
use std::process::Command;
use std::sync::OnceLock;

use browser::Browser;
use serde_json::{Value, json};

/// The report on Figures 1 and 4 of the smallest built-in shapes, made once.
fn report() -> PathBuf {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    let folder = FOLDER.get_or_init(|| {
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("report-page");
        let run = Command::new(env!("CARGO_BIN_EXE_experiments"))
            .args(["run", "figure1", "figure4", "--vertices", "1000", "--quiet", "--output"])
            .arg(&folder)
            .output()
            .unwrap();
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        folder
    });
    folder.join("report.html")
}

/// The page in a browser window of this size.
fn opened(size: [u32; 2]) -> Option<Browser> {
    let browser = Browser::start()?;
    browser.resize(size[0], size[1]).unwrap();
    browser.watch_layout().unwrap();
    browser.open_file(&report()).unwrap();
    Some(browser)
}

/// Scrolls an element into view and waits until it is drawn.
fn shown(browser: &Browser, css: &str) {
    let found = format!("document.querySelector({})", json!(css));
    browser.eval(&format!("{found}.scrollIntoView({{ block: 'center', behavior: 'instant' }})")).unwrap();
    browser.wait_for(&format!("{found}.dataset.state === 'ready'")).unwrap();
}

/// Scrolls from top to bottom and waits until all plots are drawn.
fn scrolled_through(browser: &Browser) {
    let step = "scrollBy({ top: innerHeight * 0.7, behavior: 'instant' });
        return new Promise(done => setTimeout(() => done(scrollY + innerHeight >= document.documentElement.scrollHeight - 2), 150))";
    for _ in 0..200 {
        if browser.eval(step).unwrap() == true {
            break;
        }
    }
    browser
        .wait_for(
            "[...document.querySelectorAll('[data-plot]')].every(plot => plot.dataset.state === 'ready')",
        )
        .unwrap();
}

/// Asserts that the console is empty and that the page requested nothing but itself.
fn assert_silent(browser: &Browser) {
    assert_eq!(browser.console().unwrap(), []);
    let outside = |address: &String| {
        let is_page = address.starts_with("file://") && address.ends_with("/report.html");
        !is_page && !["data:", "blob:"].iter().any(|inside| address.starts_with(inside))
    };
    let requested: Vec<String> = browser.requests().unwrap().into_iter().filter(outside).collect();
    assert!(requested.is_empty(), "{requested:?}");
}

fn picture(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../target/browser").join(format!("{name}.png"))
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// The position of the camera of a view.
fn eye(browser: &Browser, css: &str) -> [f64; 3] {
    let scene = format!("document.querySelector('{css} .canonform-scene')");
    let eye = browser
        .eval(&format!("const e = {scene}._fullLayout.scene._scene.getCamera().eye; return [e.x, e.y, e.z]"))
        .unwrap();
    [0, 1, 2].map(|i| number(&eye[i]))
}

/// The position of a shape of the map, in window coordinates.
fn point_on_map(browser: &Browser, shape: usize) -> [i32; 2] {
    let at = browser
        .eval(&format!(
            "const plot = document.querySelector('#figure4-map-0');
             const box = plot.querySelector('.nsewdrag').getBoundingClientRect();
             const trace = plot._fullData.findIndex(t => t.customdata && [...t.customdata].includes({shape}));
             const at = [...plot._fullData[trace].customdata].indexOf({shape});
             const {{ xaxis, yaxis }} = plot._fullLayout;
             return [box.left + xaxis.d2p(plot._fullData[trace].x[at]), box.top + yaxis.d2p(plot._fullData[trace].y[at])];"
        ))
        .unwrap();
    [0, 1].map(|i| number(&at[i]).round() as i32)
}

/// Asserts that text is light on dark if the reader prefers dark pages.
fn assert_readable_in_the_dark(browser: &Browser) {
    browser.prefer("prefers-color-scheme", "dark").unwrap();
    let light = "const light = color => { const [r, g, b] = color.match(/[\\d.]+/g).map(Number); return (r + g + b) / 765; };
        const style = getComputedStyle(document.body); const page = getComputedStyle(document.documentElement).backgroundColor;
        const back = style.backgroundColor === 'rgba(0, 0, 0, 0)' ? page : style.backgroundColor;
        return [light(back), light(style.color)];";
    let light = browser.eval(light).unwrap();
    assert!(number(&light[0]) < 0.2 && number(&light[1]) > 0.7, "{light}");
    let tick = "getComputedStyle(document.querySelector('#figure4-map-0 .xtick text')).fill";
    browser.wait_for(&format!("{tick}.startsWith('rgb(2')")).unwrap();
    browser.screenshot_all(&picture("report-dark-1280")).unwrap();
}

/// Asserts that print shows the static figures instead of the interactive ones.
fn assert_printable(browser: &Browser) {
    let seen = |css: &str| {
        browser
            .eval(&format!(
                "return [...document.querySelectorAll('{css}')].filter(e => e.offsetHeight > 0).length"
            ))
            .unwrap()
            .as_u64()
            .unwrap()
    };
    let figures = seen("figure img");
    assert!(seen(".live [data-plot]") > 0);
    browser.media("print").unwrap();
    assert_eq!(seen(".live [data-plot]"), 0);
    assert!(seen("figure img") > figures, "{figures}");
    browser.screenshot_all(&picture("report-print")).unwrap();
}

/// Whether something becomes true within five seconds.
fn soon(is_true: impl Fn() -> bool) -> bool {
    (0..50).any(|_| {
        let found = is_true();
        if !found {
            std::thread::sleep(std::time::Duration::from_millis(100));
        }
        found
    })
}

fn text(browser: &Browser, css: &str) -> String {
    let found = browser.eval(&format!("return document.querySelector('{css}').textContent")).unwrap();
    found.as_str().unwrap().to_owned()
}

#[test]
fn hovering_shows_a_card_and_clicking_chooses_shapes() {
    let Some(browser) = opened([1280, 900]) else { return };
    shown(&browser, "#figure4-map-0");
    let facts = |key: &str| {
        browser.eval(&format!("return document.querySelector('#figure4-facts').dataset.{key}")).unwrap()
    };
    browser.hover_at(point_on_map(&browser, 20)).unwrap();
    browser.wait_for("!document.querySelector('#figure4-card').hidden").unwrap();
    let names: Value = serde_json::from_str(&text(&browser, "#figure4-data")).unwrap();
    let names = &names["names"];
    assert_eq!(text(&browser, "#figure4-card .name"), names[20]);
    let drawn =
        "[...document.querySelectorAll('#figure4-card img')].every(i => i.complete && i.naturalWidth > 0)";
    browser.wait_for(drawn).unwrap();
    browser.screenshot(&picture("report-card-1280")).unwrap();

    browser.click_at(point_on_map(&browser, 20)).unwrap();
    browser.wait_for("document.querySelector('#figure4-facts').dataset.first === '20'").unwrap();
    for view in ["first-shape", "first-form", "second-shape", "second-form", "overlay"] {
        shown(&browser, &format!("#figure4-{view}"));
    }
    assert_eq!(text(&browser, "#figure4-first-shape .canonform-title"), names[20]);

    // A cell of the matrix names its two shapes; a click chooses both.
    shown(&browser, "#figure4-matrix-0");
    let cell = browser
        .eval(
            "const plot = document.querySelector('#figure4-matrix-0');
             const box = plot.querySelector('.nsewdrag').getBoundingClientRect();
             const { xaxis, yaxis } = plot._fullLayout;
             return [box.left + xaxis.d2p(3), box.top + yaxis.d2p(12)];",
        )
        .unwrap();
    let cell = [0, 1].map(|i| number(&cell[i]).round() as i32);
    browser.hover_at(cell).unwrap();
    browser.wait_for("document.querySelector('#figure4-matrix-0 .hoverlayer').textContent !== ''").unwrap();
    let label = text(&browser, "#figure4-matrix-0 .hoverlayer");
    assert!([12, 3].iter().all(|shape| label.contains(names[*shape].as_str().unwrap())), "{label}");
    browser.click_at(cell).unwrap();
    browser.wait_for("document.querySelector('#figure4-facts').dataset.first === '12'").unwrap();
    assert_eq!(facts("second"), "3");
    assert_silent(&browser);
}

#[test]
fn views_rotate_together_by_mouse_and_keyboard() {
    let Some(browser) = opened([1280, 900]) else { return };
    shown(&browser, "#figure4-map-0");
    let views = ["#figure4-first-shape", "#figure4-second-form", "#figure4-overlay"];
    views.iter().for_each(|view| shown(&browser, view));
    let before = eye(&browser, views[0]);
    browser.drag(&format!("{} .canonform-scene", views[0]), [70, -25]).unwrap();
    let same = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6);
    let settled = || {
        let eyes = views.map(|view| eye(&browser, view));
        eyes.iter().all(|e| same(*e, eyes[0])) && !same(eyes[0], before)
    };
    assert!(soon(settled), "{:?}", views.map(|view| eye(&browser, view)));
    browser.screenshot(&picture("report-turned-1280")).unwrap();
    // The drag moved the keyboard focus to the scene.
    let turned = eye(&browser, views[2]);
    browser.eval("document.activeElement.dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowLeft', bubbles: true }))").unwrap();
    assert!(soon(|| !same(eye(&browser, views[2]), turned)));
    for choice in ["distance", "residual", "class"] {
        browser
            .eval(&format!(
                "const select = document.querySelector('#figure4-color'); select.value = '{choice}';
                 select.dispatchEvent(new Event('change', {{ bubbles: true }}));"
            ))
            .unwrap();
        views.iter().for_each(|view| shown(&browser, view));
        let has_bar = browser
            .eval("return document.querySelector('#figure4-first-shape .canonform-scene')._fullData.some(t => t.showscale)")
            .unwrap();
        assert_eq!(has_bar, choice != "class", "{choice}");
    }
    assert_silent(&browser);
}

#[test]
#[ignore = "slow: make test-all"]
fn the_layout_is_stable_and_fits_wide_and_narrow_screens_dark_mode_and_print() {
    for (name, size) in [("1280", [1280, 900]), ("390", [390, 844])] {
        let Some(browser) = opened(size) else { return };
        scrolled_through(&browser);
        let (shifts, moved) = browser.shifts().unwrap();
        assert!(shifts < 0.001, "{name}: the layout shifts by {shifts}: {moved}");
        let widths = browser.eval("return [document.documentElement.scrollWidth, innerWidth]").unwrap();
        assert!(number(&widths[0]) <= number(&widths[1]), "{name}: {widths}");
        for part in ["map-0", "overlay"] {
            shown(&browser, &format!("#figure4-{part}"));
            browser.screenshot(&picture(&format!("report-{part}-{name}"))).unwrap();
        }
        browser.eval("scrollTo({ top: 0, behavior: 'instant' })").unwrap();
        browser.screenshot(&picture(&format!("report-top-{name}"))).unwrap();
        browser.screenshot_all(&picture(&format!("report-{name}"))).unwrap();
        if name == "1280" {
            assert_readable_in_the_dark(&browser);
            assert_printable(&browser);
        }
        assert_silent(&browser);
    }
}
