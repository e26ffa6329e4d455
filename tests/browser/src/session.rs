//! WebDriver: JSON over HTTP (<https://www.w3.org/TR/webdriver2/>).

use std::path::Path;
use std::time::Duration;

use serde_json::{Value, json};
use ureq::{Agent, Body, http::Response};

use crate::BrowserError;

/// A browser window, closed when dropped.
pub(crate) struct Session {
    agent: Agent,
    address: String,
}

/// Headless, without a sandbox (containers do not provide one), with WebGL in software, and without network access of its
/// own: only names of this machine are resolved.
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
    "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1, EXCLUDE localhost",
];

impl Session {
    pub(crate) fn new(port: u16, browser: &Path, profile: &Path) -> Result<Self, BrowserError> {
        let config = Agent::config_builder()
            .http_status_as_error(false)
            .proxy(None)
            .timeout_global(Some(Duration::from_secs(120)))
            .build();
        let mut session =
            Self { agent: config.new_agent(), address: format!("http://127.0.0.1:{port}/session") };
        let profile = format!("--user-data-dir={}", profile.join("profile").display());
        let arguments: Vec<&str> = ARGUMENTS.into_iter().chain([profile.as_str()]).collect();
        let capabilities = json!({
            "browserName": "chrome",
            "goog:chromeOptions": {
                "binary": browser,
                "args": arguments,
                "perfLoggingPrefs": { "enableNetwork": true, "enablePage": false },
            },
            "goog:loggingPrefs": { "browser": "ALL", "performance": "ALL" },
        });
        let answer = session.send("", &json!({ "capabilities": { "alwaysMatch": capabilities } }))?;
        match answer["sessionId"].as_str() {
            Some(id) => session.address = format!("{}/{id}", session.address),
            None => return Err(BrowserError::Connection(format!("no session in {answer}"))),
        }
        Ok(session)
    }

    /// Sends a command and returns the `value` of the response.
    pub(crate) fn post(&self, command: &str, body: &Value) -> Result<Value, BrowserError> {
        self.send(&format!("/{command}"), body)
    }

    pub(crate) fn get(&self, command: &str) -> Result<Value, BrowserError> {
        let answer = self.agent.get(format!("{}/{command}", self.address)).call();
        value(command, answer)
    }

    fn send(&self, command: &str, body: &Value) -> Result<Value, BrowserError> {
        let request = self.agent.post(format!("{}{command}", self.address));
        let answer = request.content_type("application/json; charset=utf-8").send(body.to_string());
        value(command.trim_start_matches('/'), answer)
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        // Closes the browser.
        let _ = self.agent.delete(&self.address).call();
    }
}

fn value(command: &str, answer: Result<Response<Body>, ureq::Error>) -> Result<Value, BrowserError> {
    let lost = |error: ureq::Error| BrowserError::Connection(format!("{command}: {error}"));
    let mut answer = answer.map_err(lost)?;
    let text = answer.body_mut().with_config().limit(1 << 30).read_to_string().map_err(lost)?;
    let mut json: Value = serde_json::from_str(&text)
        .map_err(|error| BrowserError::Connection(format!("{command}: {error} in {text}")))?;
    let value = json["value"].take();
    match value["error"].as_str() {
        Some(kind) if !answer.status().is_success() => Err(BrowserError::Refused {
            command: command.to_owned(),
            kind: kind.to_owned(),
            message: value["message"].as_str().unwrap_or_default().to_owned(),
        }),
        _ => Ok(value),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_closed_port_is_an_error() {
        // Bound and closed at once, so nothing listens there.
        let port = std::net::TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let error = Session::new(port, Path::new("x"), Path::new("y")).err().unwrap();
        assert!(matches!(error, BrowserError::Connection(_)), "{error}");
    }
}
