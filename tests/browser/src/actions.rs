//! User actions: pointing, clicking, dragging, typing, choosing files.

use std::path::Path;

use anyhow::{Context, Result};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::json;

use crate::Browser;

/// The key under which WebDriver returns the handle of an element.
const ELEMENT: &str = "element-6066-11e4-a52e-4f735466cecf";

/// Pointer moves in one drag, so that the page can follow it.
const STEPS: i32 = 12;

impl Browser {
    /// Waits for the first element that matches a CSS selector and clicks its center.
    pub fn click(&self, css: &str) -> Result<()> {
        let element = self.element(css)?;
        self.session.post(&format!("/element/{element}/click"), &json!({})).map(drop)
    }

    /// Types into an element.
    pub fn type_into(&self, css: &str, text: &str) -> Result<()> {
        let element = self.element(css)?;
        self.session.post(&format!("/element/{element}/value"), &json!({ "text": text })).map(drop)
    }

    /// Chooses files in an `input` of type `file`.
    pub fn upload(&self, css: &str, paths: &[&Path]) -> Result<()> {
        let absolute = |path: &&Path| path.canonicalize().map(|path| path.display().to_string());
        let paths = paths.iter().map(absolute).collect::<Result<Vec<_>, _>>()?;
        self.type_into(css, &paths.join("\n"))
    }

    /// Drops a file with this content on an element, as from a file manager. Dispatches the events that a page listens for,
    /// because WebDriver cannot start a native drag.
    pub fn drop_file(&self, css: &str, name: &str, content: &[u8]) -> Result<()> {
        self.element(css)?;
        let [css, name, content] = [json!(css), json!(name), json!(STANDARD.encode(content))];
        self.eval(&format!(
            "const bytes = Uint8Array.from(atob({content}), c => c.charCodeAt(0));
             const dataTransfer = new DataTransfer();
             dataTransfer.items.add(new File([bytes], {name}));
             const target = document.querySelector({css});
             for (const kind of ['dragenter', 'dragover', 'drop'])
               target.dispatchEvent(new DragEvent(kind, {{dataTransfer, bubbles: true, cancelable: true}}));"
        ))
        .map(drop)
    }

    /// Drags from the center of an element by this many CSS pixels.
    pub fn drag(&self, css: &str, [dx, dy]: [i32; 2]) -> Result<()> {
        let [x, y] = self.center(css)?;
        let mut actions = vec![moved([x, y]), json!({ "type": "pointerDown", "button": 0 })];
        actions.extend((1..=STEPS).map(|i| moved([x + dx * i / STEPS, y + dy * i / STEPS])));
        actions.push(json!({ "type": "pointerUp", "button": 0 }));
        let pointer = json!({
            "type": "pointer", "id": "mouse", "parameters": { "pointerType": "mouse" }, "actions": actions,
        });
        self.session.post("/actions", &json!({ "actions": [pointer] })).map(drop)
    }

    /// Waits for an element and returns its handle.
    fn element(&self, css: &str) -> Result<String> {
        self.wait_for(&format!("document.querySelector({}) !== null", json!(css)))?;
        let found = self.session.post("/element", &json!({ "using": "css selector", "value": css }))?;
        Ok(found[ELEMENT].as_str().with_context(|| format!("no element in {found}"))?.to_owned())
    }

    /// Scrolls an element into view and returns its center in the window.
    fn center(&self, css: &str) -> Result<[i32; 2]> {
        self.element(css)?;
        let at = self.eval(&format!(
            "const element = document.querySelector({});
             element.scrollIntoView({{block: 'center', behavior: 'instant'}});
             const box = element.getBoundingClientRect();
             return [Math.round(box.x + box.width / 2), Math.round(box.y + box.height / 2)];",
            json!(css)
        ))?;
        let number = |i: usize| at[i].as_i64().and_then(|x| i32::try_from(x).ok()).unwrap_or(0);
        Ok([number(0), number(1)])
    }
}

fn moved([x, y]: [i32; 2]) -> serde_json::Value {
    json!({ "type": "pointerMove", "duration": 15, "origin": "viewport", "x": x, "y": y })
}
