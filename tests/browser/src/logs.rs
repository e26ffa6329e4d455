//! Console messages and network requests of a page.

use serde_json::Value;

/// A console message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Message {
    /// `SEVERE`, `WARNING`, `INFO` or `DEBUG`.
    pub level: String,
    /// Source and text.
    pub text: String,
}

/// Warning of the browser without a graphics card, where it reads back every WebGL frame to show it, whatever the page
/// does.
const SOFTWARE: [&str; 2] = ["GL Driver Message (OpenGL, Performance", "GPU stall due to ReadPixels"];

/// All entries since the start. The driver returns each entry only once.
#[derive(Debug, Default)]
pub(crate) struct Logs {
    pub(crate) console: Vec<Message>,
    pub(crate) requests: Vec<String>,
}

impl Logs {
    pub(crate) fn read_console(&mut self, entries: &Value) {
        let text = |entry: &Value, key: &str| entry[key].as_str().unwrap_or_default().to_owned();
        let is_relevant = |entry: &&Value| {
            !entry["message"].as_str().is_some_and(|text| SOFTWARE.iter().all(|part| text.contains(part)))
        };
        let entries = entries.as_array().into_iter().flatten().filter(is_relevant);
        self.console.extend(entries.map(|e| Message { level: text(e, "level"), text: text(e, "message") }));
    }

    /// Reads the addresses from network events.
    pub(crate) fn read_events(&mut self, entries: &Value) {
        for entry in entries.as_array().into_iter().flatten() {
            let event: Value = entry["message"]
                .as_str()
                .and_then(|text| serde_json::from_str(text).ok())
                .unwrap_or_default();
            let event = &event["message"];
            let parameters = &event["params"];
            let address = match event["method"].as_str() {
                Some("Network.requestWillBeSent") => &parameters["request"]["url"],
                Some("Network.webSocketCreated") => &parameters["url"],
                _ => continue,
            };
            self.requests.extend(address.as_str().map(str::to_owned));
        }
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn entries_are_kept_in_order_and_others_ignored() {
        let mut logs = Logs::default();
        logs.read_console(
            &json!([{ "level": "SEVERE", "message": "a" }, { "level": "INFO", "message": "b" }]),
        );
        logs.read_console(&Value::Null);
        assert_eq!(logs.console.len(), 2);
        assert_eq!(logs.console[1], Message { level: "INFO".into(), text: "b".into() });
        let event = |method: &str, params: Value| {
            let text = json!({ "message": { "method": method, "params": params } }).to_string();
            json!({ "message": text })
        };
        logs.read_events(&json!([
            event("Network.requestWillBeSent", json!({ "request": { "url": "file:///x" } })),
            event("Network.dataReceived", json!({ "url": "no" })),
            event("Network.webSocketCreated", json!({ "url": "ws://x" })),
            { "message": "no event" },
        ]));
        assert_eq!(logs.requests, ["file:///x", "ws://x"]);
    }
}
