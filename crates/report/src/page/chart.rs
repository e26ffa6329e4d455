//! Figures on the page: plots where scripts run, images elsewhere and in print.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::html::escape;
use super::scripts::island;
use crate::error::ReportError;
use crate::figure::{Content, Figure};
use files::FileError;

/// The figure of an experiment, with the static files in the folder.
pub(super) fn chart(folder: &Path, name: &str, figure: &Figure) -> Result<String, ReportError> {
    let still = picture(folder, name, figure)?;
    let id = format!("{name}{}", figure.part);
    let (kind, labels): (&str, Vec<(&str, bool)>) = match &figure.content {
        Content::Plots(plots) => {
            ("plot", plots.iter().map(|plot| (plot.label.as_str(), plot.series.len() > 5)).collect())
        }
        Content::Heats(heats) => ("heat", heats.iter().map(|heat| (heat.label.as_str(), false)).collect()),
        Content::Surfaces => return Ok(still),
    };
    let mut boxes = String::new();
    for (panel, (label, is_tall)) in labels.into_iter().enumerate() {
        let tall = if is_tall { " tall" } else { "" };
        let _ = writeln!(
            boxes,
            "<div class=\"plot{tall}\" id=\"{id}-{panel}\" data-plot=\"{kind}\" data-panel=\"{panel}\" \
             data-source=\"{id}-data\" role=\"img\" aria-label=\"{}\"></div>",
            escape(label)
        );
    }
    let caption = escape(&figure.caption);
    let live = format!("<div class=\"plots\">\n{boxes}</div>\n<p class=\"pale\">{caption}</p>\n");
    Ok(framed(&id, &live, &still) + &island(&format!("{id}-data"), &serde_json::json!(figure)))
}

/// An element that scripts fill, the static figure in its place, and the button that switches between them.
pub(super) fn framed(id: &str, live: &str, still: &str) -> String {
    format!(
        "<div class=\"chart\" id=\"{id}-chart\">\n<div class=\"live\">\n{live}</div>\n\
         <button type=\"button\" class=\"toggle\" aria-pressed=\"false\">Static figure</button>\n\
         <div class=\"still\">\n{still}</div>\n</div>\n"
    )
}

/// The PNG of a figure, as part of the page and linked to its SVG.
pub(super) fn picture(folder: &Path, name: &str, figure: &Figure) -> Result<String, ReportError> {
    let (png, svg) = (format!("{name}{}.png", figure.part), format!("{name}{}.svg", figure.part));
    let path = folder.join(&png);
    if !path.exists() {
        return Ok(format!(
            "<div class=\"missing\"><p>The file <code>{png}</code> is missing. Run {name} again to create it.</p></div>\n"
        ));
    }
    let bytes = fs::read(&path).map_err(|source| FileError::read(&path, source))?;
    // Width and height, big-endian in the header of a PNG, keep the layout from shifting while the page loads.
    let word =
        |at: usize| bytes.get(at..at + 4).and_then(|w| w.try_into().ok()).map_or(0, u32::from_be_bytes);
    let (width, height) = (word(16), word(20));
    Ok(format!(
        "<figure>\n<a href=\"{svg}\"><img src=\"data:image/png;base64,{}\" width=\"{width}\" height=\"{height}\" \
         alt=\"{alt}\"></a>\n<figcaption>{alt} <a href=\"{png}\">PNG</a> <a href=\"{svg}\">SVG</a></figcaption>\n</figure>\n",
        STANDARD.encode(&bytes),
        alt = escape(&figure.caption),
    ))
}
