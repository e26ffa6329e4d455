//! Colours and markers, each of which tells series apart on its own.

use std::f64::consts::PI;

use serde::ser::{Serialize, SerializeStruct, Serializer};

use view::color::{Rgb, class_color, class_color_on_dark, hex};

/// The look of class or series number `n`: twelve markers and eight colours. The first 24 differ in the pair,
/// neighbours in both.
///
/// In JSON, `{"color": "#rrggbb", "dark": the colour on dark pages, "symbol": the name of the marker in plotly}`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Style(pub usize);

/// The names of the markers in plotly, in the order of [`Style::outline`].
const SYMBOLS: [&str; 12] = [
    "circle",
    "triangle-up",
    "square",
    "diamond",
    "cross",
    "triangle-down",
    "star",
    "hexagon",
    "x",
    "triangle-left",
    "pentagon",
    "triangle-right",
];

impl Style {
    /// The colour on white.
    #[must_use]
    pub fn color(self) -> Rgb {
        class_color(self.0)
    }

    /// Corners of the marker, counter-clockwise with y upwards, of radius about one.
    pub(super) fn outline(self) -> Vec<(f64, f64)> {
        match self.0 % SYMBOLS.len() {
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
}

impl Serialize for Style {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let mut style = to.serialize_struct("Style", 3)?;
        style.serialize_field("color", &hex(self.color()))?;
        style.serialize_field("dark", &hex(class_color_on_dark(self.0)))?;
        style.serialize_field("symbol", SYMBOLS[self.0 % SYMBOLS.len()])?;
        style.end()
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
    // Each arm ends in two corners; the inner corners are on the diagonals.
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
pub(super) fn grown(points: &[(f64, f64)], by: f64) -> Vec<(f64, f64)> {
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
    fn growing_moves_every_side_by_the_same_distance() {
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
        for outline in (0..12).map(|class| Style(class).outline()) {
            assert!(area(&grown(&outline, 0.2)) > area(&outline), "clockwise");
        }
    }

    #[test]
    fn the_first_24_styles_differ() {
        let json = |class: usize| serde_json::to_string(&Style(class)).unwrap();
        for a in 0..24 {
            for b in 0..a {
                assert_ne!(json(a), json(b), "styles {a} and {b}");
            }
        }
        for a in 0..12 {
            for b in 0..a {
                assert_ne!(Style(a).outline(), Style(b).outline());
            }
        }
        assert_eq!(json(1), r##"{"color":"#d55e00","dark":"#d55e00","symbol":"triangle-up"}"##);
    }
}
