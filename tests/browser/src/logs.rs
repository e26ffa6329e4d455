//! What a page has said and asked for.

use serde_json::Value;

/// One message of the console.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Message {
    /// `SEVERE`, `WARNING`, `INFO` or `DEBUG`.
    pub level: String,
    /// Where and what.
    pub text: String,
}

/// What the browser says of itself where there is no graphics card: it reads every WebGL picture back to show it,
/// whatever the page does, which is slow. A test holds it to that.
const SOFTWARE: [&str; 2] = ["GL Driver Message (OpenGL, Performance", "GPU stall due to ReadPixels"];

/// Everything since the start; the driver hands out each entry once.
#[derive(Debug, Default)]
pub(crate) struct Logs {
    pub(crate) console: Vec<Message>,
    pub(crate) requests: Vec<String>,
}

impl Logs {
    pub(crate) fn read_console(&mut self, entries: &Value) {
        let text = |entry: &Value, key: &str| entry[key].as_str().unwrap_or_default().to_owned();
        let is_ours = |entry: &&Value| {
            !entry["message"].as_str().is_some_and(|text| SOFTWARE.iter().all(|part| text.contains(part)))
        };
        let entries = entries.as_array().into_iter().flatten().filter(is_ours);
        self.console.extend(entries.map(|e| Message { level: text(e, "level"), text: text(e, "message") }));
    }

    /// Reads the addresses from events of the network.
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
    fn entries_are_kept_in_order_and_others_passed_over() {
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
