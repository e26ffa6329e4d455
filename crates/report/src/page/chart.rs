//! Figures that are plots where scripts run, and pictures elsewhere and on paper.

use std::fmt::Write;

use serde_json::Value;

use super::html::escape;
use super::scripts::island;

/// One plot of a figure.
pub(super) struct Plot {
    /// Which of the scripts' kinds of plots it is.
    pub(super) kind: &'static str,
    /// Its number among those of the same kind.
    pub(super) panel: usize,
    /// What it shows, for those who cannot see it.
    pub(super) label: String,
}

impl Plot {
    pub(super) fn new(kind: &'static str, panel: usize, label: impl Into<String>) -> Self {
        Self { kind, panel, label: label.into() }
    }
}

/// The plots of an experiment over one island of data with a caption, and its static figure, which may be empty.
pub(super) fn chart(name: &str, plots: &[Plot], caption: &str, data: &Value, still: &str) -> String {
    let mut boxes = String::new();
    for Plot { kind, panel, label } in plots {
        let _ = writeln!(
            boxes,
            "<div class=\"plot\" id=\"{name}-{kind}-{panel}\" data-plot=\"{kind}\" data-panel=\"{panel}\" \
             data-source=\"{name}-data\" role=\"img\" aria-label=\"{}\"></div>",
            escape(label)
        );
    }
    let caption = escape(caption);
    let plots = format!("<div class=\"plots\">\n{boxes}</div>\n<p class=\"pale\">{caption}</p>\n");
    format!("{}{}", framed(name, &plots, still), island(&format!("{name}-data"), data))
}

/// What scripts fill, what stands in its place, and the button between them.
pub(super) fn framed(name: &str, live: &str, still: &str) -> String {
    let toggle = match still.is_empty() {
        true => String::new(),
        false => "<button type=\"button\" class=\"toggle\" aria-pressed=\"false\">Static figure</button>\n"
            .to_owned(),
    };
    format!(
        "<div class=\"chart\" id=\"{name}-chart\">\n<div class=\"live\">\n{live}</div>\n{toggle}<div class=\"still\">\n{still}</div>\n</div>\n"
    )
}
