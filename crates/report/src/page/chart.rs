//! Figures on the page: plots where scripts run, images elsewhere and in print.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::html::escape;
use super::scripts::island;

use crate::error::ReportError;
use crate::figure::{Figure, FigurePanels, Heat, Plot, dark};
use base::files::FileError;

/// The figure of an experiment, with the static files in the folder.
pub(super) fn chart(folder: &Path, name: &str, figure: &Figure) -> Result<String, ReportError> {
    let still = picture(folder, name, figure)?;
    let id = format!("{name}{}", figure.part);
    let (kind, labels): (&str, Vec<(&str, String)>) = match &figure.panels {
        FigurePanels::Plots(plots) => {
            let class = |plot: &Plot| if plot.series.len() > 5 { " tall" } else { "" }.to_owned();
            ("plot", plots.iter().map(|plot| (plot.label.as_str(), class(plot))).collect())
        }
        FigurePanels::Heats(heats) => {
            ("heat", heats.iter().map(|heat| (heat.label.as_str(), room(heat))).collect())
        }
        FigurePanels::Surfaces => return Ok(still),
    };
    let mut boxes = String::new();
    for (panel, (label, class)) in labels.into_iter().enumerate() {
        let _ = writeln!(
            boxes,
            "<div class=\"plot{class}\" id=\"{id}-{panel}\" data-plot=\"{kind}\" data-panel=\"{panel}\" \
             data-source=\"{id}-data\" role=\"img\" aria-label=\"{}\"></div>",
            escape(label)
        );
    }
    let caption = escape(&figure.caption);
    let links = links(name, figure);
    let live = format!("<div class=\"plots\">\n{boxes}</div>\n<p class=\"pale\">{caption} {links}</p>\n");
    Ok(framed(&id, &live, &still) + &island(&format!("{id}-data"), &serde_json::json!(figure)))
}

/// What a matrix needs for its counts to be legible: nothing more than other plots, or room for its cells, over which a
/// narrow window scrolls.
fn room(heat: &Heat) -> String {
    let n = heat.rows.len().max(heat.columns.len());
    match heat.counts {
        Some(_) if n > 12 => format!(" counts\" style=\"--cells: {n}"),
        _ => String::new(),
    }
}

/// An element that scripts fill, the static figure in its place, and the button that switches between them.
pub(super) fn framed(id: &str, live: &str, still: &str) -> String {
    format!(
        "<div class=\"chart\" id=\"{id}-chart\">\n<div class=\"live\">\n{live}</div>\n\
         <button type=\"button\" class=\"toggle\" aria-pressed=\"false\">Static figure</button>\n\
         <div class=\"still\">\n{still}</div>\n</div>\n"
    )
}

/// The SVG of a figure, as an image that is part of the page and follows dark mode, and links to its files.
///
/// Inside an image, whatever a file contains can neither run nor change the page.
pub(super) fn picture(folder: &Path, name: &str, figure: &Figure) -> Result<String, ReportError> {
    let svg = format!("{name}{}.svg", figure.part);
    let path = folder.join(&svg);
    if !path.exists() {
        return Ok(format!(
            "<div class=\"missing\"><p>The file <code>{svg}</code> is missing. Run {name} again to create it.</p></div>\n"
        ));
    }
    let text = fs::read_to_string(&path).map_err(|source| FileError::read(&path, source))?;
    // The size keeps the layout from shifting while the page loads.
    let size = |name: &str| -> Option<u32> {
        let (_, rest) = text.split_once(&format!(" {name}=\""))?;
        rest.split_once('"')?.0.parse().ok()
    };
    let [width, height] = ["width", "height"].map(|name| size(name).unwrap_or(0));
    Ok(format!(
        "<figure>\n<img src=\"data:image/svg+xml;base64,{}\" width=\"{width}\" height=\"{height}\" alt=\"{alt}\">\n\
         <figcaption>{alt} {}</figcaption>\n</figure>\n",
        STANDARD.encode(dark(&text)),
        links(name, figure),
        alt = escape(&figure.caption),
    ))
}

/// Links to the files of a figure.
fn links(name: &str, figure: &Figure) -> String {
    let link = |kind: &str| {
        let file = format!("{name}{}.{}", figure.part, kind.to_lowercase());
        format!("<a href=\"{file}\" download>{kind}</a>")
    };
    format!("<span class=\"files\">{}</span>", ["PNG", "SVG", "PDF"].map(link).join(" "))
}
