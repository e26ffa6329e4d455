//! Colours and markers, each of which tells series apart on its own.

use serde::ser::{Serialize, SerializeStruct, Serializer};

use crate::color::{Rgb, class_color, class_color_on_dark, hex};

/// The look of class or series number `n`: five markers and eight colours. The first 40 differ in the pair, neighbours
/// in both.
///
/// In JSON, `{"color": "#rrggbb", "dark": the colour on dark pages, "symbol": the name of the marker in plotly}`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SeriesStyle(pub usize);

/// Markers: the name in plotly, and a regular polygon by its number of corners, the direction of the first in degrees
/// and its radius, about one.
const MARKERS: [(&str, u32, f64, f64); 5] = [
    ("circle", 24, 0.0, 0.95),
    ("triangle-up", 3, 90.0, 1.25),
    ("square", 4, 45.0, 1.2),
    ("diamond", 4, 0.0, 1.25),
    ("triangle-down", 3, -90.0, 1.25),
];

impl SeriesStyle {
    /// The colour on white.
    #[must_use]
    pub fn color(self) -> Rgb {
        class_color(self.0)
    }

    /// Corners of the marker around the origin, with y upwards.
    pub(super) fn outline(self) -> impl Iterator<Item = [f64; 2]> {
        let (_, corners, first, radius) = MARKERS[self.0 % MARKERS.len()];
        let angle = move |i| (first + 360.0 * f64::from(i) / f64::from(corners)).to_radians();
        (0..corners).map(move |i| [radius * angle(i).cos(), radius * angle(i).sin()])
    }
}

impl Serialize for SeriesStyle {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let mut style = to.serialize_struct("SeriesStyle", 3)?;
        style.serialize_field("color", &hex(self.color()))?;
        style.serialize_field("dark", &hex(class_color_on_dark(self.0)))?;
        style.serialize_field("symbol", MARKERS[self.0 % MARKERS.len()].0)?;
        style.end()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_40_styles_differ_and_neighbours_in_both_parts() {
        let parts = |n: usize| (SeriesStyle(n).color(), MARKERS[n % MARKERS.len()].0);
        for a in 0..40 {
            assert!((0..a).all(|b| parts(a) != parts(b)), "style {a}");
            let ((color, marker), (next_color, next_marker)) = (parts(a), parts(a + 1));
            assert!(color != next_color && marker != next_marker, "style {a}");
        }
        let json = serde_json::to_string(&SeriesStyle(1)).unwrap();
        assert_eq!(json, r##"{"color":"#d55e00","dark":"#d55e00","symbol":"triangle-up"}"##);
    }
}
