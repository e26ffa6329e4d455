//! What a person does with a page: points, clicks, drags, types, gives files, looks.

use std::fs;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

use crate::{Browser, BrowserError};

/// The key under which WebDriver hands out an element.
const ELEMENT: &str = "element-6066-11e4-a52e-4f735466cecf";

/// Steps in which the pointer moves: a page that follows a drag wants to see it on its way.
const STEPS: i32 = 12;

impl Browser {
    /// Clicks the middle of the first element that a CSS selector finds, once it is there.
    ///
    /// # Errors
    /// [`BrowserError::Never`] when there is none, [`BrowserError::Refused`] when another covers it.
    pub fn click(&self, css: &str) -> Result<(), BrowserError> {
        let element = self.element(css)?;
        self.session.post(&format!("element/{element}/click"), &json!({})).map(drop)
    }

    /// Types into an element.
    ///
    /// # Errors
    /// As [`Browser::click`].
    pub fn type_into(&self, css: &str, text: &str) -> Result<(), BrowserError> {
        let element = self.element(css)?;
        self.session.post(&format!("element/{element}/value"), &json!({ "text": text })).map(drop)
    }

    /// Gives files to an `input` of type `file`, as if chosen in its dialog.
    ///
    /// # Errors
    /// [`BrowserError::Start`] for a path that does not exist; else as [`Browser::click`].
    pub fn upload(&self, css: &str, paths: &[&Path]) -> Result<(), BrowserError> {
        let paths: Result<Vec<String>, _> =
            paths.iter().map(|path| Ok(path.canonicalize()?.display().to_string())).collect();
        self.type_into(css, &paths.map_err(BrowserError::Start)?.join("\n"))
    }

    /// Drops a file with this content on an element, as from a file manager: the browser's own events of a drag
    /// cannot be made from outside, those a page listens for can.
    ///
    /// # Errors
    /// As [`Browser::click`] and [`Browser::eval`].
    pub fn drop_file(&self, css: &str, name: &str, content: &[u8]) -> Result<(), BrowserError> {
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

    /// Moves the pointer onto the middle of an element, scrolling it into view.
    ///
    /// # Errors
    /// As [`Browser::click`].
    pub fn hover(&self, css: &str) -> Result<(), BrowserError> {
        let at = self.middle(css)?;
        self.hover_at(at)
    }

    /// Moves the pointer to a point of the window, in CSS pixels.
    ///
    /// # Errors
    /// [`BrowserError::Refused`] outside of the window.
    pub fn hover_at(&self, [x, y]: [i32; 2]) -> Result<(), BrowserError> {
        // A page told of one move may take it for the pointer having been there all along.
        self.pointer(vec![moved([x - 3, y - 3]), moved([x, y])])
    }

    /// Presses on the middle of an element, moves by so many CSS pixels and lets go.
    ///
    /// # Errors
    /// As [`Browser::click`]; [`BrowserError::Refused`] outside of the window.
    pub fn drag(&self, css: &str, [dx, dy]: [i32; 2]) -> Result<(), BrowserError> {
        let [x, y] = self.middle(css)?;
        let mut actions = vec![moved([x, y]), json!({ "type": "pointerDown", "button": 0 })];
        actions.extend((1..=STEPS).map(|i| moved([x + dx * i / STEPS, y + dy * i / STEPS])));
        actions.push(json!({ "type": "pointerUp", "button": 0 }));
        self.pointer(actions)
    }

    /// Clicks a point of the window, in CSS pixels.
    ///
    /// # Errors
    /// [`BrowserError::Refused`] outside of the window.
    pub fn click_at(&self, at: [i32; 2]) -> Result<(), BrowserError> {
        let [down, up] = ["pointerDown", "pointerUp"].map(|kind| json!({ "type": kind, "button": 0 }));
        self.pointer(vec![moved(at), down, up])
    }

    /// Writes what is seen of the page to a PNG file, making its folder.
    ///
    /// # Errors
    /// [`BrowserError::Picture`] and those of the driver.
    pub fn screenshot(&self, path: &Path) -> Result<(), BrowserError> {
        let picture = self.session.get("screenshot")?;
        save(path, &picture)
    }

    /// Writes the whole page, as long as it is, to a PNG file.
    ///
    /// # Errors
    /// As [`Browser::screenshot`].
    pub fn screenshot_all(&self, path: &Path) -> Result<(), BrowserError> {
        let parameters = json!({ "format": "png", "captureBeyondViewport": true });
        let picture = self.devtools("Page.captureScreenshot", &parameters)?;
        save(path, &picture["data"])
    }

    /// Waits for an element and returns its handle.
    fn element(&self, css: &str) -> Result<String, BrowserError> {
        self.wait_for(&format!("document.querySelector({}) !== null", json!(css)))?;
        let found = self.session.post("element", &json!({ "using": "css selector", "value": css }))?;
        match found[ELEMENT].as_str() {
            Some(handle) => Ok(handle.to_owned()),
            None => Err(BrowserError::Connection(format!("no element in {found}"))),
        }
    }

    /// The middle of an element in the window, once scrolled into view.
    fn middle(&self, css: &str) -> Result<[i32; 2], BrowserError> {
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

    fn pointer(&self, actions: Vec<Value>) -> Result<(), BrowserError> {
        let pointer = json!({
            "type": "pointer", "id": "mouse", "parameters": { "pointerType": "mouse" }, "actions": actions,
        });
        self.session.post("actions", &json!({ "actions": [pointer] })).map(drop)
    }
}

fn moved([x, y]: [i32; 2]) -> Value {
    json!({ "type": "pointerMove", "duration": 15, "origin": "viewport", "x": x, "y": y })
}

fn save(path: &Path, picture: &Value) -> Result<(), BrowserError> {
    let fault = |fault: String| BrowserError::Picture(format!("{}: {fault}", path.display()));
    let bytes = STANDARD.decode(picture.as_str().unwrap_or_default()).map_err(|e| fault(e.to_string()))?;
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).map_err(|e| fault(e.to_string()))?;
    }
    fs::write(path, bytes).map_err(|e| fault(e.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_that_is_none_or_has_no_place_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new/x.png");
        save(&path, &json!("AAEC")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), [0, 1, 2]);
        for (path, picture) in [(path.clone(), json!("?")), (path.join("below"), json!("AAEC"))] {
            let fault = save(&path, &picture).unwrap_err();
            assert!(matches!(fault, BrowserError::Picture(_)), "{fault}");
        }
    }
}
