//! A server on a small index of the built-in shapes, and a browser on its page.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use browser::Browser;
use canonform_server::ServeOptions;
use datasets::{ArticulatedOptions, Family, LabeledShape, articulated_shape};
use serde_json::{Value, json};

use crate::support::{Served, options, write_indexed};

/// A file name that contains HTML.
pub(crate) const AWKWARD: &str = "<img src=x onerror=console.error(1)>&'\" ü";

/// A body of 1,000 vertices; no two numbers give the same pose.
pub(crate) fn body(family: Family, number: usize) -> LabeledShape {
    let options = ArticulatedOptions { n_vertices: 1000, ..ArticulatedOptions::default() };
    articulated_shape(family, number, &options).unwrap()
}

/// A folder with `all.canonform` and the `meshes` it was built from; built once.
fn collection() -> PathBuf {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    let make = || {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("page");
        let families = [Family::Cat, Family::Centaur, Family::David];
        let bodies: Vec<_> = families.iter().flat_map(|f| (0..3).map(|number| body(*f, number))).collect();
        let mut meshes: Vec<_> = bodies.iter().map(|body| (&*body.name, body.mesh.clone())).collect();
        meshes.push((AWKWARD, canonform::mesh::shapes::torus(24, 12, 2.0, 0.6)));
        write_indexed(&folder, &meshes);
        folder
    };
    FOLDER.get_or_init(make).clone()
}

/// The page of a server in a browser.
pub(crate) struct Page {
    pub(crate) browser: Browser,
    server: Served,
}

impl Page {
    /// Opens the page in a window of this size; `None` where there is no browser.
    pub(crate) fn open(width: u32, height: u32) -> Option<Self> {
        Self::with(width, height, options())
    }

    /// As [`open`](Self::open), with options of the server.
    pub(crate) fn with(width: u32, height: u32, options: ServeOptions) -> Option<Self> {
        let page = Self::of(&collection(), [width, height], options)?;
        page.go("/");
        page.wait_for("document.querySelectorAll('#shapes .tile').length === 10");
        Some(page)
    }

    /// A browser for the pages of the index in a folder, which opens none yet.
    pub(crate) fn of(folder: &Path, [width, height]: [u32; 2], options: ServeOptions) -> Option<Self> {
        let browser = Browser::start()?;
        let server = Served::on(folder.to_owned(), None, options);
        browser.resize(width, height).unwrap();
        browser.watch_layout().unwrap();
        Some(Self { browser, server })
    }

    /// Opens an address of the page.
    pub(crate) fn go(&self, target: &str) {
        self.browser.open(&format!("http://{}{target}", self.server.address)).unwrap();
    }

    /// The path and the parameters of the address.
    pub(crate) fn address(&self) -> String {
        self.eval("location.pathname + location.search").as_str().unwrap().to_owned()
    }

    /// Waits until one of the results is overlaid with the query.
    pub(crate) fn overlaid(&self, id: &str) {
        self.wait_for(&format!(
            "document.querySelector('#overlay').dataset.state === 'ready' && \
             document.querySelector('#overlay').dataset.id === {}",
            json!(id)
        ));
    }

    pub(crate) fn eval(&self, expression: &str) -> Value {
        self.browser.eval(&format!("return {expression}")).unwrap()
    }

    pub(crate) fn wait_for(&self, expression: &str) {
        self.browser.wait_for(expression).unwrap();
    }

    /// Chooses a value of a list.
    pub(crate) fn choose(&self, list: &str, value: &str) {
        let list = format!("const list = document.querySelector('#{list}');");
        let choose = format!("{list} list.value = '{value}'; list.dispatchEvent(new Event('change'))");
        self.browser.eval(&choose).unwrap();
    }

    /// The text of an element.
    pub(crate) fn text(&self, css: &str) -> String {
        let text = self.eval(&format!("document.querySelector({}).textContent", json!(css)));
        text.as_str().unwrap().to_owned()
    }

    /// Waits until results are shown.
    pub(crate) fn answered(&self) {
        self.wait_for("document.querySelector('#answer').dataset.state === 'ready'");
        self.wait_for("document.querySelector('#form-view').dataset.state === 'ready'");
    }

    /// Every control is reached by Tab, in the order of the page.
    pub(crate) fn assert_reached_by_tab(&self) {
        let reached = self.eval(
            "[...document.querySelectorAll('a, button, input, select')].filter(e => e.getClientRects().length > 0 && !e.disabled) \
             .every(e => { e.focus({ preventScroll: true }); return document.activeElement === e && e.tabIndex === 0; })",
        );
        assert_eq!(reached, true);
    }

    /// The console is empty, all requests went to this server, and nothing is wider than the window.
    pub(crate) fn assert_sound(&self) {
        assert_eq!(self.browser.console().unwrap(), Vec::<String>::new());
        let origin = format!("http://{}/", self.server.address);
        let inside =
            |address: &String| ["data:", "blob:", &origin].iter().any(|own| address.starts_with(own));
        let asked: Vec<String> =
            self.browser.requests().unwrap().into_iter().filter(|a| !inside(a)).collect();
        assert!(asked.is_empty(), "{asked:?}");
        let widths = self.eval("[document.documentElement.scrollWidth, innerWidth]");
        assert!(widths[0].as_f64() <= widths[1].as_f64(), "{widths}");
    }
}
