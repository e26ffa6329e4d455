//! What the tests share: small invented figures and meshes.

pub(crate) mod meshes;

use crate::record::{Axis, Figure, FigurePanels, Mark, Plot, PlotPoint, Series, SeriesKind, Tile};
use crate::viewer::Geometry;

pub(crate) fn figure(panels: FigurePanels) -> Figure {
    Figure { part: "part".to_owned(), caption: "What it shows & <why>.".to_owned(), panels }
}

/// Two curves over a logarithmic vertical axis.
pub(crate) fn plot(title: &str) -> Plot {
    let series = |name: &str, factor: f64| {
        let points = [10.0, 50.0, 100.0].map(|x| {
            let y = factor * 1e5 / x;
            PlotPoint { x, y, low: 0.7 * y, high: 1.5 * y, note: "5 runs".to_owned() }
        });
        Series { name: name.to_owned(), kind: SeriesKind::Curve, points: points.to_vec() }
    };
    Plot {
        title: title.to_owned(),
        x: Axis::linear("samples n"),
        y: Axis::log("error", "m⁴"),
        series: vec![series("NMDS", 1.0), series("a & b", 30.0)],
        marks: vec![Mark { x: 70.0, name: "recommended".to_owned() }],
    }
}

pub(crate) fn tile(caption: &str, is_form: bool) -> Tile {
    let surface = Geometry::new(&mesh::shapes::icosphere(1));
    Tile { captions: vec![caption.to_owned()], is_form, surface }
}

/// Panics unless a text holds all parts.
pub(crate) fn assert_holds(text: &str, parts: &[&str]) {
    for part in parts {
        assert!(text.contains(part), "{part} in {text}");
    }
}

/// Panics unless as many elements of each kind are closed as are open.
pub(crate) fn assert_closed(markup: &str) {
    for name in ["svg", "text", "title", "section", "figure", "table", "tr", "div", "p", "details", "script"]
    {
        let open =
            markup.matches(&format!("<{name}>")).count() + markup.matches(&format!("<{name} ")).count();
        assert_eq!(open, markup.matches(&format!("</{name}>")).count(), "{name}");
    }
}
