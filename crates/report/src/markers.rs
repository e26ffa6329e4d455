//! Markers that tell classes apart by shape and by colour, so that either one is enough.

use std::f64::consts::PI;

use plotters::prelude::*;

use view::canvas::{Canvas, DrawError};
use view::color::{class_color, mix};

/// Half the size of a marker, in units.
const RADIUS: f64 = 5.8;
/// Width of its dark rim, in units.
const RIM: f64 = 1.1;

/// Draws the marker of class number `class` around a pixel of the whole drawing.
///
/// Twelve shapes and eight colours: the first 24 classes differ in the pair, neighbours in both.
pub(crate) fn draw_marker<DB: DrawingBackend>(
    canvas: &Canvas<DB>,
    class: usize,
    center: (i32, i32),
) -> Result<(), DrawError> {
    let fill = class_color(class);
    // Two filled shapes, the rim under the face: backends stroke small outlines unevenly.
    let face: Vec<(f64, f64)> = outline(class).into_iter().map(|(x, y)| (x * RADIUS, y * RADIUS)).collect();
    for (points, [r, g, b]) in [(grown(&face, RIM), mix(fill, [0; 3], 0.5)), (face, fill)] {
        let points: Vec<(i32, i32)> =
            points.into_iter().map(|(x, y)| (center.0 + canvas.px(x), center.1 - canvas.px(y))).collect();
        canvas.area().draw(&Polygon::new(points, RGBColor(r, g, b)))?;
    }
    Ok(())
}

/// Corners of a marker of radius about one, y upwards.
fn outline(class: usize) -> Vec<(f64, f64)> {
    match class % 12 {
        0 => regular(24, 0.0, 0.95),
        1 => regular(3, 90.0, 1.25),
        2 => regular(4, 45.0, 1.2),
        3 => regular(4, 0.0, 1.25),
        4 => plus(0.0),
        5 => regular(3, -90.0, 1.25),
        6 => star(),
        7 => regular(6, 0.0, 1.1),
        8 => plus(45.0),
        9 => regular(3, 180.0, 1.25),
        10 => regular(5, 90.0, 1.1),
        _ => regular(3, 0.0, 1.25),
    }
}

fn at(degrees: f64, radius: f64) -> (f64, f64) {
    let angle = degrees * PI / 180.0;
    (radius * angle.cos(), radius * angle.sin())
}

fn regular(corners: u32, first: f64, radius: f64) -> Vec<(f64, f64)> {
    (0..corners).map(|i| at(first + 360.0 * f64::from(i) / f64::from(corners), radius)).collect()
}

fn star() -> Vec<(f64, f64)> {
    (0..10).map(|i| at(90.0 + 36.0 * f64::from(i), if i % 2 == 0 { 1.35 } else { 0.6 })).collect()
}

fn plus(turn: f64) -> Vec<(f64, f64)> {
    // Each arm ends in two corners; the inner corners lie on the diagonals.
    let (arm, end) = (18.4_f64, 1.2);
    let inner = end * arm.to_radians().sin() * std::f64::consts::SQRT_2;
    (0..4)
        .flat_map(|i| {
            let axis = turn + 90.0 * f64::from(i);
            [at(axis - arm, end), at(axis + arm, end), at(axis + 45.0, inner)]
        })
        .collect()
}

/// A counter-clockwise polygon with every side moved outwards by `by`.
fn grown(points: &[(f64, f64)], by: f64) -> Vec<(f64, f64)> {
    let n = points.len();
    let normal = |i: usize| {
        let (a, b) = (points[i % n], points[(i + 1) % n]);
        let length = (b.0 - a.0).hypot(b.1 - a.1);
        ((b.1 - a.1) / length, (a.0 - b.0) / length)
    };
    (0..n)
        .map(|i| {
            let (before, after) = (normal(i + n - 1), normal(i));
            let reach = by / (1.0 + before.0 * after.0 + before.1 * after.1);
            (points[i].0 + reach * (before.0 + after.0), points[i].1 + reach * (before.1 + after.1))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn growing_moves_every_side_by_the_same() {
        let square = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];
        for (&(x, y), (a, b)) in square.iter().zip(grown(&square, 0.5)) {
            assert!((a - 1.5 * x).abs() < 1e-12 && (b - 1.5 * y).abs() < 1e-12);
        }
        let area = |p: &[(f64, f64)]| -> f64 {
            (0..p.len())
                .map(|i| (p[i], p[(i + 1) % p.len()]))
                .map(|(a, b)| (a.0 * b.1 - b.0 * a.1) / 2.0)
                .sum()
        };
        for class in 0..12 {
            assert!(
                area(&grown(&outline(class), 0.2)) > area(&outline(class)),
                "marker {class} is clockwise"
            );
        }
    }

    #[test]
    fn the_first_24_classes_differ() {
        let key = |class: usize| (class % 12, class_color(class));
        for a in 0..24 {
            for b in 0..a {
                assert_ne!(key(a), key(b), "classes {a} and {b}");
            }
        }
        for a in 0..12 {
            for b in 0..a {
                assert_ne!(outline(a), outline(b));
            }
        }
    }
}
