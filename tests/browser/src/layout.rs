//! Layout shifts of a page.

use serde_json::{Value, json};

use crate::{Browser, BrowserError};

/// Installed before the first layout; counts all shifts that are not caused by user input.
const WATCH: &str = "window.shifts = 0; window.moved = []; new PerformanceObserver(list => {
    for (const shift of list.getEntries()) if (!shift.hadRecentInput) {
        window.shifts += shift.value;
        window.moved.push(...shift.sources.map(({ node, previousRect: a, currentRect: b }) =>
            `${node?.id || node?.className || node?.nodeName} (${a.x}, ${a.y}) to (${b.x}, ${b.y}), height ${a.height} to ${b.height}`));
    }
}).observe({ type: 'layout-shift', buffered: true });";

impl Browser {
    /// Watches the layout of all pages opened from now on.
    pub fn watch_layout(&self) -> Result<(), BrowserError> {
        self.devtools("Page.addScriptToEvaluateOnNewDocument", &json!({ "source": WATCH })).map(drop)
    }

    /// The sum of all layout shift scores of the page, and the elements that moved.
    pub fn shifts(&self) -> Result<(f64, Value), BrowserError> {
        let found = self.eval("return [window.shifts.valueOf(), window.moved]")?;
        Ok((found[0].as_f64().unwrap_or(f64::NAN), found[1].clone()))
    }
}
