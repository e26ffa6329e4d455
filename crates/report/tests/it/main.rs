//! Laws of figures, pages and pictures, and the small invented figures and meshes that they share.

// Helper functions are test code too, which clippy cannot see.
#![allow(clippy::unwrap_used)]

mod bar;
mod color;
mod figure;
mod image;
mod labels;
mod page;
mod render;
mod text;
mod viewer;

use canonform_report::RgbaImage;
use canonform_report::record::{Axis, Figure, FigurePanels, Mark, Plot, PlotPoint, Series, SeriesKind, Tile};
use canonform_report::viewer::Geometry;
use mesh::TriMesh;
use nalgebra::Point3;

fn figure(panels: FigurePanels) -> Figure {
    Figure { part: "part".to_owned(), caption: "What it shows & <why>.".to_owned(), panels }
}

/// Two curves over a logarithmic vertical axis.
fn plot(title: &str) -> Plot {
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

fn tile(caption: &str, is_form: bool) -> Tile {
    let surface = Geometry::new(&mesh::shapes::icosphere(1));
    Tile { captions: vec![caption.to_owned()], is_form, surface }
}

/// Panics unless a text holds all parts.
fn assert_holds(text: &str, parts: &[&str]) {
    for part in parts {
        assert!(text.contains(part), "{part} in {text}");
    }
}

/// Panics unless as many elements of each kind are closed as are open.
fn assert_closed(markup: &str) {
    for name in ["svg", "text", "title", "section", "figure", "table", "tr", "div", "p", "details", "script"]
    {
        let open =
            markup.matches(&format!("<{name}>")).count() + markup.matches(&format!("<{name} ")).count();
        assert_eq!(open, markup.matches(&format!("</{name}>")).count(), "{name}");
    }
}

/// The pixel in column `x` and row `y`, from the top left.
fn pixel(image: &RgbaImage, x: u32, y: u32) -> [u8; 4] {
    image.pixels()[(y * image.width() + x) as usize]
}

/// A unit sphere around the z axis, `2 n` by `n` quadrilaterals.
fn sphere(n: usize) -> TriMesh {
    let mut sphere = mesh::shapes::cylinder(2 * n, n + 1, 1.0, std::f64::consts::PI);
    for p in &mut sphere.positions {
        let (sine, cosine) = p.z.sin_cos();
        *p = Point3::new(sine * p.x, sine * p.y, -cosine);
    }
    sphere
}
