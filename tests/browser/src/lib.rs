//! A real browser for tests: headless Chromium, driven over WebDriver.
//!
//! test -> **browser** -> chromedriver -> Chromium -> the page
//!
//! A [`Browser`] starts with an empty profile in a temporary folder, records all console messages and requested
//! addresses, and closes when it is dropped. Knows nothing of the content of the pages.

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

/// Environment variable: if it is `required`, tests fail instead of being skipped when there is no browser.
pub const VARIABLE: &str = "CANONFORM_BROWSER";

/// A running browser with one page.
///
/// Only one runs at a time in a process: software rendering uses all cores, so several would slow each other down.
///
/// # Errors
/// Every method returns [`BrowserError::Refused`] if the driver or the page reports an error,
/// [`BrowserError::Connection`] if the driver does not respond, [`BrowserError::Never`] if an element or a condition
/// does not appear within 30 seconds, and [`BrowserError::Start`] if a file does not exist.
pub struct Browser {
    // Dropped in this order: the page, its driver, the profile.
    session: Session,
    _driver: Driver,
    _profile: TempDir,
    logs: Mutex<Logs>,
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
        match Programs::find() {
            Ok(programs) => match Self::launch(&programs) {
                Ok(browser) => Some(browser),
                Err(error) => panic!("{error}"),
            },
            Err(error) if is_required => panic!("{error}, or unset {VARIABLE}"),
            Err(error) => {
                println!("skipped: {error}");
                None
            }
        }
    }

    fn launch(programs: &Programs) -> Result<Self, BrowserError> {
        let turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
        let profile = TempDir::new().map_err(BrowserError::Start)?;
        let driver = Driver::start(&programs.driver, profile.path())?;
        let session = Session::new(driver.port, &programs.browser, profile.path())?;
        let logs = Mutex::new(Logs::default());
        let browser = Self { session, _driver: driver, _profile: profile, logs, _turn: turn };
        browser.resize(1280, 800)?;
        // Discards the requests of the new-tab page.
        browser.open("about:blank")?;
        browser.requests()?;
        *browser.logs() = Logs::default();
        Ok(browser)
    }

    /// Opens an address and waits until the page is loaded.
    pub fn open(&self, address: &str) -> Result<(), BrowserError> {
        self.session.post("url", &json!({ "url": address }))?;
        Ok(())
    }

    /// Opens a file.
    pub fn open_file(&self, path: &Path) -> Result<(), BrowserError> {
        let path = path.canonicalize().map_err(BrowserError::Start)?;
        self.open(&format!("file://{}", path.display()))
    }

    /// Emulates a window of this size in CSS pixels, with one device pixel each. Below a width of 600 it emulates a phone:
    /// `meta viewport` has effect, and input is touch.
    pub fn resize(&self, width: u32, height: u32) -> Result<(), BrowserError> {
        let is_phone = width < 600;
        let metrics = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": is_phone });
        self.devtools("Emulation.setDeviceMetricsOverride", &metrics)?;
        self.devtools("Emulation.setTouchEmulationEnabled", &json!({ "enabled": is_phone }))?;
        Ok(())
    }

    /// Emulates a system preference, such as `prefers-color-scheme` with the value `dark`.
    pub fn prefer(&self, feature: &str, value: &str) -> Result<(), BrowserError> {
        let features = json!({ "features": [{ "name": feature, "value": value }] });
        self.devtools("Emulation.setEmulatedMedia", &features).map(drop)
    }

    /// Emulates the medium `print`, or `screen` again.
    pub fn media(&self, media: &str) -> Result<(), BrowserError> {
        self.devtools("Emulation.setEmulatedMedia", &json!({ "media": media })).map(drop)
    }

    /// Sends a command of the Chrome DevTools Protocol and returns the response.
    pub fn devtools(&self, command: &str, parameters: &Value) -> Result<Value, BrowserError> {
        self.session.post("goog/cdp/execute", &json!({ "cmd": command, "params": parameters }))
    }

    /// Runs the body of a function in the page and returns its result. Waits for promises.
    pub fn eval(&self, body: &str) -> Result<Value, BrowserError> {
        self.session.post("execute/sync", &json!({ "script": body, "args": [] }))
    }

    /// Waits until an expression is true in the page. Exceptions count as false.
    pub fn wait_for(&self, expression: &str) -> Result<(), BrowserError> {
        let start = std::time::Instant::now();
        loop {
            let last = match self.eval(&format!("return ({expression})")) {
                Ok(Value::Bool(true)) => return Ok(()),
                Ok(value) => value.to_string(),
                Err(error @ BrowserError::Connection(_)) => return Err(error),
                Err(error) => error.to_string(),
            };
            if start.elapsed() > driver::PATIENCE {
                return Err(BrowserError::Never { expression: expression.to_owned(), last });
            }
            std::thread::sleep(std::time::Duration::from_millis(50));
        }
    }

    /// All console messages since the start, oldest first, including those of the browser itself, such as violations of the
    /// content-security policy, but without its warnings about slow WebGL in software.
    pub fn console(&self) -> Result<Vec<Message>, BrowserError> {
        let mut logs = self.logs();
        logs.read_console(&self.session.post("se/log", &json!({ "type": "browser" }))?);
        Ok(logs.console.clone())
    }

    /// All addresses requested since the start, in order, including those not found or blocked. The browser reaches this
    /// machine only: other names are not resolved.
    pub fn requests(&self) -> Result<Vec<String>, BrowserError> {
        let mut logs = self.logs();
        logs.read_events(&self.session.post("se/log", &json!({ "type": "performance" }))?);
        Ok(logs.requests.clone())
    }

    fn logs(&self) -> MutexGuard<'_, Logs> {
        self.logs.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
