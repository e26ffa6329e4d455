//! A real browser for tests: headless Chromium, driven over WebDriver.
//!
//! test -> **browser** -> chromedriver -> Chromium -> the page
//!
//! A [`Browser`] starts with an empty profile in a temporary folder, records all console messages and requested
//! addresses, and closes when it is dropped. Knows nothing of the content of the pages.

mod actions;
mod session;

use std::cell::RefCell;
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use anyhow::{Result, bail};
use serde_json::{Value, json};
use tempfile::TempDir;

use session::{Session, program};

/// Environment variable: if it is `required`, tests fail instead of being skipped when there is no browser.
pub const VARIABLE: &str = "CANONFORM_BROWSER";

/// Time limit for things that should take a second.
const PATIENCE: Duration = Duration::from_secs(30);

/// Warning of the browser without a graphics card, where it reads back every WebGL frame to show it, whatever the page
/// does.
const SOFTWARE: [&str; 2] = ["GL Driver Message (OpenGL, Performance", "GPU stall due to ReadPixels"];

/// Installed before the first layout; counts all shifts that are not caused by user input.
const WATCH: &str = "window.shifts = 0; window.moved = []; new PerformanceObserver(list => {
    for (const shift of list.getEntries()) if (!shift.hadRecentInput) {
        window.shifts += shift.value;
        window.moved.push(...shift.sources.map(({ node, previousRect: a, currentRect: b }) =>
            `${node?.id || node?.className || node?.nodeName} (${a.x}, ${a.y}) to (${b.x}, ${b.y}), height ${a.height} to ${b.height}`));
    }
}).observe({ type: 'layout-shift', buffered: true });";

/// A running browser with one page.
///
/// Only one runs at a time in a process: software rendering uses all cores, so several would slow each other down.
///
/// # Errors
/// Every method returns an error if the driver does not respond, if the driver or the page reports an error, if an element or
/// a condition does not appear within 30 seconds, and if a file does not exist.
pub struct Browser {
    // Dropped before its profile.
    session: Session,
    _profile: TempDir,
    /// Console messages and requested addresses; the driver returns each only once.
    messages: RefCell<Vec<String>>,
    requests: RefCell<Vec<String>>,
    _turn: MutexGuard<'static, ()>,
}

static TURN: Mutex<()> = Mutex::new(());

impl Browser {
    /// Starts a browser with an empty page of 1280 x 800 pixels.
    ///
    /// Prints a line and returns `None` if Chromium or chromedriver is not installed.
    ///
    /// # Panics
    /// If a program is not installed and [`VARIABLE`] is `required`, or if an installed program does not start.
    #[must_use]
    pub fn start() -> Option<Self> {
        let is_required = std::env::var(VARIABLE).is_ok_and(|value| value == "required");
        let found = program(&["chromium", "chromium-browser", "google-chrome"])
            .and_then(|browser| Ok([browser, program(&["chromedriver"])?]));
        match found {
            Ok(programs) => Some(Self::launch(&programs).unwrap_or_else(|error| panic!("{error:#}"))),
            Err(error) if is_required => panic!("{error}, or unset {VARIABLE}"),
            Err(error) => {
                println!("skipped: {error}");
                None
            }
        }
    }

    fn launch(programs: &[std::path::PathBuf; 2]) -> Result<Self> {
        let turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
        let profile = TempDir::new()?;
        let session = Session::start(programs, profile.path())?;
        let (messages, requests) = Default::default();
        let browser = Self { session, _profile: profile, messages, requests, _turn: turn };
        browser.resize(1280, 800)?;
        // Discards the requests of the new-tab page.
        browser.open("about:blank")?;
        browser.requests()?;
        browser.requests.borrow_mut().clear();
        Ok(browser)
    }

    /// Opens an address and waits until the page is loaded.
    pub fn open(&self, address: &str) -> Result<()> {
        self.session.post("/url", &json!({ "url": address }))?;
        Ok(())
    }

    /// Opens a file.
    pub fn open_file(&self, path: &Path) -> Result<()> {
        let path = path.canonicalize()?;
        self.open(&format!("file://{}", path.display()))
    }

    /// Emulates a window of this size in CSS pixels, with one device pixel each. Below a width of 600 it emulates a phone:
    /// `meta viewport` has effect, and input is touch.
    pub fn resize(&self, width: u32, height: u32) -> Result<()> {
        let is_phone = width < 600;
        let metrics = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": is_phone });
        self.devtools("Emulation.setDeviceMetricsOverride", &metrics)?;
        self.devtools("Emulation.setTouchEmulationEnabled", &json!({ "enabled": is_phone }))
    }

    /// Emulates a system preference, such as `prefers-color-scheme` with the value `dark`.
    pub fn prefer(&self, feature: &str, value: &str) -> Result<()> {
        let features = json!({ "features": [{ "name": feature, "value": value }] });
        self.devtools("Emulation.setEmulatedMedia", &features)
    }

    /// Emulates the medium `print`, or `screen` again.
    pub fn media(&self, media: &str) -> Result<()> {
        self.devtools("Emulation.setEmulatedMedia", &json!({ "media": media }))
    }

    /// Sends a command of the Chrome DevTools Protocol.
    fn devtools(&self, command: &str, parameters: &Value) -> Result<()> {
        self.session.post("/goog/cdp/execute", &json!({ "cmd": command, "params": parameters })).map(drop)
    }

    /// Runs the body of a function in the page and returns its result. Waits for promises.
    pub fn eval(&self, body: &str) -> Result<Value> {
        self.session.post("/execute/sync", &json!({ "script": body, "args": [] }))
    }

    /// Waits until an expression is true in the page. Exceptions count as false.
    pub fn wait_for(&self, expression: &str) -> Result<()> {
        let start = Instant::now();
        loop {
            let last = self.eval(&format!("return ({expression})"));
            if matches!(last, Ok(Value::Bool(true))) {
                return Ok(());
            }
            if start.elapsed() > PATIENCE {
                bail!("`{expression}` did not become true; its last value was {last:?}");
            }
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    /// Watches the layout of all pages opened from now on.
    pub fn watch_layout(&self) -> Result<()> {
        self.devtools("Page.addScriptToEvaluateOnNewDocument", &json!({ "source": WATCH }))
    }

    /// The sum of all layout shift scores of the page, and the elements that moved.
    pub fn shifts(&self) -> Result<(f64, Value)> {
        let found = self.eval("return [window.shifts.valueOf(), window.moved]")?;
        Ok((found[0].as_f64().unwrap_or(f64::NAN), found[1].clone()))
    }

    /// All console messages since the start, oldest first, including those of the browser itself, such as violations of the
    /// content-security policy, but without its warnings about slow WebGL in software.
    pub fn console(&self) -> Result<Vec<String>> {
        let entries = self.log("browser")?;
        let texts = entries.iter().filter_map(|entry| entry["message"].as_str());
        let texts = texts.filter(|text| !SOFTWARE.iter().all(|part| text.contains(part)));
        self.messages.borrow_mut().extend(texts.map(str::to_owned));
        Ok(self.messages.borrow().clone())
    }

    /// All addresses requested since the start, in order, including those not found or blocked. The browser reaches this
    /// machine only: other names are not resolved.
    pub fn requests(&self) -> Result<Vec<String>> {
        for entry in self.log("performance")? {
            let event: Value = serde_json::from_str(entry["message"].as_str().unwrap_or("null"))?;
            let parameters = &event["message"]["params"];
            let address = match event["message"]["method"].as_str() {
                Some("Network.requestWillBeSent") => &parameters["request"]["url"],
                Some("Network.webSocketCreated") => &parameters["url"],
                _ => continue,
            };
            self.requests.borrow_mut().extend(address.as_str().map(str::to_owned));
        }
        Ok(self.requests.borrow().clone())
    }

    /// What the driver has logged since the last call.
    fn log(&self, kind: &str) -> Result<Vec<Value>> {
        let mut entries = self.session.post("/se/log", &json!({ "type": kind }))?;
        Ok(entries.as_array_mut().map(std::mem::take).unwrap_or_default())
    }
}
