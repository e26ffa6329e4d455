//! chromedriver, and WebDriver: JSON over HTTP (<https://www.w3.org/TR/webdriver2/>).

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, Stdio};
use std::time::Duration;

use anyhow::{Context, Result, bail};
use serde_json::{Value, json};
use ureq::Agent;

/// Headless, without a sandbox (containers do not provide one), with WebGL in software, and without network access of its
/// own: only names of this machine are resolved, and those of examples, which lead to it.
const ARGUMENTS: [&str; 13] = [
    "--headless=new",
    "--no-sandbox",
    "--disable-dev-shm-usage",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-default-apps",
    "--enable-unsafe-swiftshader",
    "--force-device-scale-factor=1",
    "--window-size=1280,900",
    "--host-resolver-rules=MAP *.example.org 127.0.0.1, MAP * ~NOTFOUND, EXCLUDE 127.0.0.1, EXCLUDE localhost",
];

/// A browser window of a chromedriver of its own, both closed when dropped.
pub(crate) struct Session {
    driver: Child,
    /// Stays open, because the driver stops when it cannot print.
    _output: BufReader<ChildStdout>,
    agent: Agent,
    address: String,
}

/// The first of some programs in `PATH`; the error says how to install it.
pub(crate) fn program(names: &[&str]) -> Result<PathBuf> {
    let folders = std::env::var_os("PATH").unwrap_or_default();
    let mut paths =
        names.iter().flat_map(|name| std::env::split_paths(&folders).map(move |path| path.join(name)));
    paths.find(|path| path.is_file()).with_context(|| {
        let name = names[0];
        format!("{name} is not installed; the browser tests need it (on Debian: apt-get install chromium chromium-driver)")
    })
}

impl Session {
    /// Starts the programs. Their temporary files, and the profile, are in `folder`.
    pub(crate) fn start([browser, driver]: &[PathBuf; 2], folder: &Path) -> Result<Self> {
        let mut command = Command::new(driver);
        command.arg("--port=0").env("TMPDIR", folder).stdin(Stdio::null()).stderr(Stdio::null());
        let mut driver = command.stdout(Stdio::piped()).spawn().context("chromedriver")?;
        let mut output = BufReader::new(driver.stdout.take().context("a pipe")?);
        let mut line = String::new();
        // `ChromeDriver was started successfully on port 12345.`
        let port = loop {
            line.clear();
            if output.read_line(&mut line)? == 0 {
                bail!("chromedriver did not start: run it on a command line");
            }
            if let Some((_, port)) = line.split_once("started successfully on port ") {
                break port.trim().trim_end_matches('.').to_owned();
            }
        };
        let config = Agent::config_builder().http_status_as_error(false).proxy(None);
        let agent = config.timeout_global(Some(Duration::from_secs(120))).build().new_agent();
        let address = format!("http://127.0.0.1:{port}/session");
        let mut session = Self { driver, _output: output, agent, address };
        let profile = format!("--user-data-dir={}", folder.join("profile").display());
        let arguments: Vec<&str> = ARGUMENTS.into_iter().chain([profile.as_str()]).collect();
        let capabilities = json!({
            "browserName": "chrome",
            "acceptInsecureCerts": true,
            "goog:chromeOptions": {
                "binary": browser,
                "args": arguments,
                "perfLoggingPrefs": { "enableNetwork": true, "enablePage": false },
            },
            "goog:loggingPrefs": { "browser": "ALL", "performance": "ALL" },
        });
        let answer = session.post("", &json!({ "capabilities": { "alwaysMatch": capabilities } }))?;
        let id = answer["sessionId"].as_str().with_context(|| format!("no session in {answer}"))?;
        session.address = format!("{}/{id}", session.address);
        Ok(session)
    }

    /// Sends a command, such as `/url`, and returns the `value` of the response.
    pub(crate) fn post(&self, command: &str, body: &Value) -> Result<Value> {
        let request = self.agent.post(format!("{}{command}", self.address));
        let answer = request.content_type("application/json; charset=utf-8").send(body.to_string());
        let mut answer = answer.with_context(|| format!("chromedriver does not respond to {command}"))?;
        let text = answer.body_mut().with_config().limit(1 << 30).read_to_string()?;
        let value = serde_json::from_str::<Value>(&text).context(text)?["value"].take();
        if let Some(kind) = value["error"].as_str().filter(|_| !answer.status().is_success()) {
            bail!("{command}: {kind}: {}", value["message"].as_str().unwrap_or_default());
        }
        Ok(value)
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        // Closes the browser.
        let _ = self.agent.delete(&self.address).call();
        let _ = self.driver.kill();
        let _ = self.driver.wait();
    }
}
