//! Whether a page stays where it is.

use serde_json::{Value, json};

use crate::{Browser, BrowserError};

/// Counts, before anything is laid out, every shift that nobody asked for.
const WATCH: &str = "window.shifts = 0; window.moved = []; new PerformanceObserver(list => {
    for (const shift of list.getEntries()) if (!shift.hadRecentInput) {
        window.shifts += shift.value;
        window.moved.push(...shift.sources.map(({ node, previousRect: a, currentRect: b }) =>
            `${node?.id || node?.className || node?.nodeName} ${a.y} to ${b.y}, ${a.height} to ${b.height}`));
    }
}).observe({ type: 'layout-shift', buffered: true });";

impl Browser {
    /// Watches the layout of every page that is opened from now on.
    ///
    /// # Errors
    /// As [`Browser::resize`].
    pub fn watch_layout(&self) -> Result<(), BrowserError> {
        self.devtools("Page.addScriptToEvaluateOnNewDocument", &json!({ "source": WATCH })).map(drop)
    }

    /// The sum of all layout shifts of the page, as browsers score them, and what has moved.
    ///
    /// # Errors
    /// As [`Browser::eval`], also when the layout is not watched.
    pub fn shifts(&self) -> Result<(f64, Value), BrowserError> {
        let found = self.eval("return [window.shifts.valueOf(), window.moved]")?;
        Ok((found[0].as_f64().unwrap_or(f64::NAN), found[1].clone()))
    }
}
