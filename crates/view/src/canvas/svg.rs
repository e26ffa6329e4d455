//! Drawings as SVG.
//!
//! What has a colour of the page (ink, pale ink, lines, the background) also has a class of that name, so that a page can
//! give it other colours in dark mode. [`dark`] does that for an SVG inside an image.

use std::fmt::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::drawing::{Anchor, Canvas, DROP, Element, GRID, INK, PALE_INK, PAPER, Point, TextStyle};
use crate::color::{Rgb, class_color, class_color_on_dark, hex};

/// The embedded font of the PNG, and fonts of similar width.
const FONTS: &str = "DejaVu Sans, Bitstream Vera Sans, Verdana, sans-serif";

/// The colours that dark pages replace, with their classes and the colours there.
fn classes() -> [(Rgb, &'static str, Rgb); 5] {
    [
        (PAPER, "page", [20, 23, 26]),
        (INK, "ink", [228, 231, 234]),
        (PALE_INK, "pale", [163, 171, 181]),
        (GRID, "line", [53, 59, 66]),
        (class_color(6), "series", class_color_on_dark(6)),
    ]
}

/// An SVG with a style that gives it the colours of dark pages if the reader prefers those, except in print.
#[must_use]
pub fn dark(svg: &str) -> String {
    let rule = |(_, class, color): (Rgb, &str, Rgb)| {
        let color = hex(color);
        format!(".{class}{{fill:{color}}}.{class}-stroke{{stroke:{color}}}")
    };
    let rules = classes().map(rule).concat();
    let style = format!("<style>@media screen and (prefers-color-scheme:dark){{{rules}}}</style>");
    match svg.find('>') {
        Some(end) => format!("{}{style}{}", &svg[..=end], &svg[end + 1..]),
        None => svg.to_owned(),
    }
}

/// The text of an SVG file.
pub(super) fn svg(canvas: &Canvas) -> Result<String, std::io::Error> {
    let (width, height) = canvas.size;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\" font-family=\"{FONTS}\">\n<rect width=\"{width}\" height=\"{height}\"{}/>\n",
        paint("fill", PAPER)
    );
    for element in &canvas.elements {
        match element {
            Element::Text { text, at, style } => write_text(&mut svg, text, *at, *style),
            Element::Image { image, corner } => {
                let (left, top) = *corner;
                let [wide, high] = super::drawing::in_units(image);
                let data = STANDARD.encode(image.to_png()?);
                let _ = writeln!(
                    svg,
                    "<image x=\"{}\" y=\"{}\" width=\"{wide}\" height=\"{high}\" href=\"data:image/png;base64,{data}\"/>",
                    short(left),
                    short(top)
                );
            }
            Element::Path { points, width, color } => {
                let _ = writeln!(
                    svg,
                    "<polyline points=\"{}\" fill=\"none\" stroke-width=\"{}\" stroke-linejoin=\"round\"{}/>",
                    list(points, (0.0, 0.0)),
                    short(*width),
                    paint("stroke", *color)
                );
            }
            Element::Polygon { origin, points, color, opacity } => {
                let opacity = if *opacity < 1.0 {
                    format!(" fill-opacity=\"{}\"", short(*opacity))
                } else {
                    String::new()
                };
                let _ = writeln!(
                    svg,
                    "<polygon points=\"{}\"{opacity}{}/>",
                    list(points, *origin),
                    paint("fill", *color)
                );
            }
        }
    }
    svg.push_str("</svg>\n");
    Ok(svg)
}

fn write_text(svg: &mut String, text: &str, (x, y): Point, style: TextStyle) {
    let size = f64::from(style.size);
    let anchor = match style.anchor {
        Anchor::Left => "start",
        Anchor::Center => "middle",
        Anchor::Right => "end",
    };
    let (x, y) = if style.upwards { (x + DROP * size, y) } else { (x, y + DROP * size) };
    let (x, y) = (short(x), short(y));
    let turn = if style.upwards { format!(" transform=\"rotate(-90 {x} {y})\"") } else { String::new() };
    let weight = if style.bold { " font-weight=\"bold\"" } else { "" };
    let paint =
        if style.is_fixed { format!(" fill=\"{}\"", hex(style.color)) } else { paint("fill", style.color) };
    let _ = writeln!(
        svg,
        "<text x=\"{x}\" y=\"{y}\" text-anchor=\"{anchor}\" font-size=\"{size}\"{weight}{paint}{turn}>{}</text>",
        escaped(text)
    );
}

/// The attributes of a colour: `fill` or `stroke`, and its class if it has one.
fn paint(attribute: &str, color: Rgb) -> String {
    let own = format!(" {attribute}=\"{}\"", hex(color));
    let suffix = if attribute == "stroke" { "-stroke" } else { "" };
    let class = classes().into_iter().find(|(known, ..)| *known == color);
    class.map_or(own.clone(), |(_, class, _)| format!(" class=\"{class}{suffix}\"{own}"))
}

fn list(points: &[Point], (left, top): Point) -> String {
    let pair = |(x, y): &Point| format!("{},{}", short(x + left), short(y + top));
    points.iter().map(pair).collect::<Vec<_>>().join(" ")
}

/// A number with at most two decimals.
fn short(value: f64) -> f64 {
    (value * 100.0).round() / 100.0
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_of_the_page_have_classes_that_follow_dark_mode() {
        let mut canvas = Canvas::new(60, 30);
        canvas.text("a < b", (5.0, 15.0), TextStyle::NAME.at(Anchor::Left));
        canvas.text("17", (5.0, 15.0), TextStyle::NAME.on_image());
        canvas.line((0.0, 0.0), (1.0, 0.333), 1.0, GRID);
        canvas.polygon((1.0, 1.0), vec![(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)], class_color(0), 0.5);
        let svg = svg(&canvas).unwrap();
        assert!(
            svg.contains(">a &lt; b</text>") && svg.contains("class=\"ink\" fill=\"#222222\">a"),
            "{svg}"
        );
        assert!(svg.contains("fill=\"#222222\">17"), "fixed colours have no class: {svg}");
        assert!(!svg.contains("class=\"ink\" fill=\"#222222\">17"));
        assert!(svg.contains("points=\"0,0 1,0.33\"") && svg.contains("class=\"line-stroke\""));
        assert!(svg.contains("points=\"1,1 2,1 1,2\" fill-opacity=\"0.5\" fill=\"#0072b2\""));
        let dark = dark(&svg);
        assert!(dark.contains("prefers-color-scheme:dark") && dark.contains(".ink{fill:#e4e7ea}"), "{dark}");
        assert!(dark.find("<style>") < dark.find("<rect"));
    }
}
