//! Axes: their range, their ticks and how these are written.

use std::ops::Range;

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};

use crate::numbers::{superscript, tick_labels, ticks};
use crate::record::{Axis, AxisScale};

/// The most ticks of an axis, about.
const TICKS: usize = 7;
/// Room at each end, as a share of the range.
const ROOM: f64 = 0.04;

/// One axis of a plot or matrix.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PlotAxis {
    /// The quantity and its unit.
    pub(crate) name: String,
    /// How values are spaced.
    pub(super) scale: AxisScale,
    /// Values at the left or lower end and at the other one; their decimal logarithms on a logarithmic axis.
    pub(crate) range: [f64; 2],
    /// Values of ticks in ascending order, with their labels.
    pub(crate) ticks: Vec<(f64, String)>,
}

impl PlotAxis {
    /// An axis for a quantity whose range holds all of `values` that can be shown, with a little room at both ends.
    pub(super) fn holding(quantity: &Axis, values: impl Iterator<Item = f64>) -> Self {
        let Axis { name, unit, scale } = quantity;
        let range = range(values.filter_map(|value| place(value, *scale)));
        match scale {
            AxisScale::Log => {
                Self { name: with_unit(name, unit), scale: *scale, range, ticks: log_ticks(range) }
            }
            _ => Self::linear(name, unit, range),
        }
    }

    /// A linear axis over a range.
    pub(super) fn linear(name: &str, unit: &str, range: [f64; 2]) -> Self {
        Self::with_ticks(name, unit, range, ticks(range, TICKS))
    }

    fn with_ticks(name: &str, unit: &str, range: [f64; 2], values: Vec<f64>) -> Self {
        let (labels, unit) = tick_labels(&values, unit);
        let ticks = values.into_iter().zip(labels).collect();
        Self { name: with_unit(name, &unit), scale: AxisScale::Linear, range, ticks }
    }

    /// The axis of a color bar, with a tick at both ends of a range that has no round values.
    pub(crate) fn bar(name: &str, unit: &str, range: [f64; 2], most: usize) -> Self {
        let [low, high] = range;
        // A step below the spacing of floating-point numbers would never arrive.
        let is_narrow = high - low <= 1e-9 * low.abs().max(high.abs());
        let values = if is_narrow { vec![] } else { ticks(range, most) };
        Self::with_ticks(name, unit, range, if values.len() < 2 { range.to_vec() } else { values })
    }

    /// An axis of categories.
    pub(super) fn categories(name: &str, labels: impl Iterator<Item = String>) -> Self {
        let ticks: Vec<_> = labels.enumerate().map(|(i, label)| (i as f64, label)).collect();
        let range = [-0.5, ticks.len() as f64 - 0.5];
        Self { name: name.to_owned(), scale: AxisScale::Category, range, ticks }
    }

    /// The place of a value between the ends of the range, clamped to 0..=1; `None` if it cannot be shown.
    pub(super) fn share(&self, value: f64) -> Option<f64> {
        let [low, high] = self.range;
        place(value, self.scale).map(|place| ((place - low) / (high - low)).clamp(0.0, 1.0))
    }

    /// The values at both ends.
    pub(super) fn ends(&self) -> [f64; 2] {
        if self.scale == AxisScale::Log { self.range.map(|end| 10f64.powf(end)) } else { self.range }
    }
}

/// A coordinate of plotters, with the ticks of the axis.
impl Ranged for PlotAxis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (low, high): (i32, i32)) -> i32 {
        low + (self.share(*value).unwrap_or(0.0) * f64::from(high - low)).round() as i32
    }

    fn key_points<H: KeyPointHint>(&self, _: H) -> Vec<f64> {
        self.ticks.iter().map(|(value, _)| *value).collect()
    }

    fn range(&self) -> Range<f64> {
        let [low, high] = self.ends();
        low..high
    }
}

impl ValueFormatter<f64> for PlotAxis {
    fn format_ext(&self, tick: &f64) -> String {
        let found = self.ticks.iter().find(|(value, _)| value == tick);
        found.map(|(_, label)| label.clone()).unwrap_or_default()
    }
}

/// The coordinate of a value along an axis, if it has one.
fn place(value: f64, scale: AxisScale) -> Option<f64> {
    let place = if scale == AxisScale::Log { value.log10() } else { value };
    place.is_finite().then_some(place)
}

fn with_unit(name: &str, unit: &str) -> String {
    if unit.is_empty() { name.to_owned() } else { format!("{name} ({unit})") }
}

/// The range of coordinates with room at both ends.
fn range(places: impl Iterator<Item = f64>) -> [f64; 2] {
    let (low, high) =
        places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    let (low, high) = if low <= high { (low, high) } else { (0.0, 1.0) };
    // A single value, or none: any range around it.
    let span = if high - low > 1e-9 * high.abs().max(low.abs()) { high - low } else { low.abs().max(1.0) };
    [low - ROOM * span, high + ROOM * span]
}

/// Powers of ten, every few of them in a long range; in a short range multiples of them too.
fn log_ticks([low, high]: [f64; 2]) -> Vec<(f64, String)> {
    let decades = high - low;
    let inside = |t: &f64| (low..=high).contains(&t.log10());
    let (first, last) = (low.floor() as i32, high.ceil() as i32);
    let values: Vec<f64> = if decades < 2.0 {
        let factors: &[f64] =
            if decades < 0.7 { &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0] } else { &[1.0, 2.0, 5.0] };
        (first..=last).flat_map(|e| factors.iter().map(move |f| f * 10f64.powi(e))).collect()
    } else {
        let step = (decades / TICKS as f64).ceil().max(1.0) as i32;
        (first..=last).filter(|e| e.rem_euclid(step) == 0).map(|e| 10f64.powi(e)).collect()
    };
    let values: Vec<f64> = values.into_iter().filter(inside).collect();
    let is_plain = values.iter().all(|&value| (-2..4).contains(&exponent(value)));
    let label =
        |value: f64| if is_plain { format!("{}", (value * 1e6).round() / 1e6) } else { power_label(value) };
    values.into_iter().map(|value| (value, label(value))).collect()
}

fn exponent(tick: f64) -> i32 {
    (tick.log10() + 1e-9).floor() as i32
}

/// A tick as a multiple of a power of ten. An axis with one such label has no others.
fn power_label(tick: f64) -> String {
    let exponent = exponent(tick);
    let factor = tick / 10f64.powi(exponent);
    let power = format!("10{}", superscript(exponent));
    if (factor - 1.0).abs() < 1e-9 { power } else { format!("{}·{power}", (factor * 10.0).round() / 10.0) }
}
