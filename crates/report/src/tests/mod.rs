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

/// A page without the contents of its scripts and islands of data.
pub(crate) fn without_scripts(html: &str) -> String {
    let mut parts = html.split("<script");
    let mut kept = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (_, rest) = part.split_once("</script>").expect("a script ends");
        kept.push_str(rest);
    }
    kept
}

/// Panics unless all elements of an XML or HTML text are closed in order.
pub(crate) fn assert_balanced(markup: &str) {
    let mut open: Vec<&str> = Vec::new();
    let plain = without_scripts(markup);
    let mut rest = plain.as_str();
    while let Some(start) = rest.find('<') {
        let end = start + rest[start..].find('>').expect("a tag ends");
        let tag = &rest[start + 1..end];
        rest = &rest[end + 1..];
        let name = tag.trim_start_matches('/').split([' ', '\n']).next().unwrap_or_default();
        let void = tag.ends_with('/') || tag.starts_with(['!', '?']) || ["meta", "img"].contains(&name);
        if tag.starts_with('/') {
            assert_eq!(open.pop(), Some(name), "closed out of order");
        } else if !void {
            assert_eq!(tag.matches('"').count() % 2, 0, "quotes in <{tag}>");
            open.push(name);
        }
    }
    assert!(open.is_empty(), "left open: {open:?}");
}
