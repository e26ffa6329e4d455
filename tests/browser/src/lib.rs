//! A real browser for tests: headless Chromium, driven over WebDriver.
//!
//! test -> **browser** -> chromedriver -> Chromium -> the page
//!
//! A browser starts with an empty profile in a temporary folder, notes every message of its console and
//! every address it asks for, and is gone with its value. Knows nothing of what the pages are about.

mod actions;
mod driver;
mod error;
mod layout;
mod logs;
mod program;
mod session;

pub use error::BrowserError;
pub use logs::Message;

use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};

use serde_json::{Value, json};
use tempfile::TempDir;

use driver::Driver;
use logs::Logs;
use program::Programs;
use session::Session;

/// Name of the variable that turns skipping into failing, when it is `required`.
pub const VARIABLE: &str = "CANONFORM_BROWSER";

/// A running browser with one page.
///
/// One at a time in a process: software rendering fills the machine, and several would only wait for
/// each other.
pub struct Browser {
    // In the order in which they have to go: the page, its driver, the profile.
    session: Session,
    _driver: Driver,
    _profile: TempDir,
    logs: Mutex<Logs>,
    _turn: MutexGuard<'static, ()>,
}

static TURN: Mutex<()> = Mutex::new(());

impl Browser {
    /// A browser with an empty page, 1280 x 800 pixels.
    ///
    /// `None`, and a line that says so, where Chromium or chromedriver are not installed.
    ///
    /// # Panics
    /// When they are not and [`VARIABLE`] is `required`, and when they are and do not start.
    #[must_use]
    pub fn start() -> Option<Self> {
        let is_required = std::env::var(VARIABLE).is_ok_and(|value| value == "required");
        match Programs::find() {
            Ok(programs) => match Self::launch(&programs) {
                Ok(browser) => Some(browser),
                Err(fault) => panic!("{fault}"),
            },
            Err(fault) if is_required => panic!("{fault}, or unset {VARIABLE}"),
            Err(fault) => {
                println!("skipped: {fault}");
                None
            }
        }
    }

    fn launch(programs: &Programs) -> Result<Self, BrowserError> {
        let turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
        let profile = TempDir::new().map_err(BrowserError::Start)?;
        let driver = Driver::start(&programs.driver, profile.path())?;
        let session = Session::new(driver.port(), &programs.browser, profile.path())?;
        let logs = Mutex::new(Logs::default());
        let browser = Self { session, _driver: driver, _profile: profile, logs, _turn: turn };
        browser.resize(1280, 800)?;
        // What the page of a new tab has asked for is nobody's business.
        browser.open("about:blank")?;
        browser.requests()?;
        *browser.logs() = Logs::default();
        Ok(browser)
    }

    /// Opens an address and waits until the page is loaded.
    ///
    /// # Errors
    /// [`BrowserError::Refused`] when there is nothing, [`BrowserError::Connection`].
    pub fn open(&self, address: &str) -> Result<(), BrowserError> {
        self.session.post("url", &json!({ "url": address }))?;
        Ok(())
    }

    /// Opens a file.
    ///
    /// # Errors
    /// [`BrowserError::Start`] for a path that does not exist; else as [`Browser::open`].
    pub fn open_file(&self, path: &Path) -> Result<(), BrowserError> {
        let path = path.canonicalize().map_err(BrowserError::Start)?;
        self.open(&format!("file://{}", path.display()))
    }

    /// Makes the page see a window of this size, in CSS pixels of one device pixel each. Narrow ones are
    /// those of a telephone: with a viewport that obeys `meta viewport`, and touched instead of pointed at.
    ///
    /// # Errors
    /// [`BrowserError::Refused`] and [`BrowserError::Connection`].
    pub fn resize(&self, width: u32, height: u32) -> Result<(), BrowserError> {
        let is_phone = width < 600;
        let metrics = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": is_phone });
        self.devtools("Emulation.setDeviceMetricsOverride", &metrics)?;
        self.devtools("Emulation.setTouchEmulationEnabled", &json!({ "enabled": is_phone }))?;
        Ok(())
    }

    /// Makes the page see a preference of the system, such as `prefers-color-scheme` being `dark`.
    ///
    /// # Errors
    /// As [`Browser::resize`].
    pub fn prefer(&self, feature: &str, value: &str) -> Result<(), BrowserError> {
        let features = json!({ "features": [{ "name": feature, "value": value }] });
        self.devtools("Emulation.setEmulatedMedia", &features).map(drop)
    }

    /// Lays the page out as for `print`, or for `screen` again.
    ///
    /// # Errors
    /// As [`Browser::resize`].
    pub fn media(&self, media: &str) -> Result<(), BrowserError> {
        self.devtools("Emulation.setEmulatedMedia", &json!({ "media": media })).map(drop)
    }

    /// Sends a command of the Chrome DevTools Protocol and returns its answer.
    ///
    /// # Errors
    /// As [`Browser::resize`].
    pub fn devtools(&self, command: &str, parameters: &Value) -> Result<Value, BrowserError> {
        self.session.post("goog/cdp/execute", &json!({ "cmd": command, "params": parameters }))
    }

    /// Runs the body of a function in the page and returns what it returns; a promise is waited for.
    ///
    /// # Errors
    /// [`BrowserError::Refused`] with what the page threw; [`BrowserError::Connection`].
    pub fn eval(&self, body: &str) -> Result<Value, BrowserError> {
        self.session.post("execute/sync", &json!({ "script": body, "args": [] }))
    }

    /// Waits until an expression is true in the page.
    ///
    /// # Errors
    /// [`BrowserError::Never`] after half a minute, with what the expression was last; what the page
    /// throws meanwhile counts as false.
    pub fn wait_for(&self, expression: &str) -> Result<(), BrowserError> {
        let start = std::time::Instant::now();
        loop {
            let last = match self.eval(&format!("return ({expression})")) {
                Ok(Value::Bool(true)) => return Ok(()),
                Ok(value) => value.to_string(),
                Err(fault @ BrowserError::Connection(_)) => return Err(fault),
                Err(fault) => fault.to_string(),
            };
            if start.elapsed() > driver::PATIENCE {
                return Err(BrowserError::Never { expression: expression.to_owned(), last });
            }
            std::thread::sleep(std::time::Duration::from_millis(50));
        }
    }

    /// All messages of the console since the start, oldest first; the browser's own complaints, such as
    /// what a content-security policy has refused, are among them, but not that WebGL is slow in software.
    ///
    /// # Errors
    /// [`BrowserError::Refused`] and [`BrowserError::Connection`].
    pub fn console(&self) -> Result<Vec<Message>, BrowserError> {
        let mut logs = self.logs();
        logs.read_console(&self.session.post("se/log", &json!({ "type": "browser" }))?);
        Ok(logs.console.clone())
    }

    /// All addresses asked for since the start, in order, those that were not found or not allowed too.
    /// Nothing but the own machine is ever reached: names of others are not looked up.
    ///
    /// # Errors
    /// [`BrowserError::Refused`] and [`BrowserError::Connection`].
    pub fn requests(&self) -> Result<Vec<String>, BrowserError> {
        let mut logs = self.logs();
        logs.read_events(&self.session.post("se/log", &json!({ "type": "performance" }))?);
        Ok(logs.requests.clone())
    }

    fn logs(&self) -> MutexGuard<'_, Logs> {
        self.logs.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
