//! Ranges of axes, their ticks and how these are written.

use plotters::coord::ranged1d::Ranged;
use plotters::coord::types::RangedCoordf64;

use crate::results::{Axis, AxisScale, CurvesPanel};
use view::numbers::{Numbers, raised};

/// Ticks wanted at most.
const TICKS: usize = 7;
/// Empty room at each end, as a share of the range.
const ROOM: f64 = 0.04;

/// The range of values along an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Span {
    /// Ends, or their logarithms to base ten.
    low: f64,
    high: f64,
    scale: AxisScale,
}

impl Span {
    /// What holds every place on the horizontal axis of a panel.
    pub(super) fn across(panel: &CurvesPanel) -> Self {
        let points = panel.series.iter().flat_map(|s| s.points.iter().map(|p| p.x));
        Self::of(points.chain(panel.marks.iter().map(|mark| mark.x)), panel.x.scale)
    }

    /// What holds every line and band of a panel.
    pub(super) fn upwards(panel: &CurvesPanel) -> Self {
        let points = panel.series.iter().flat_map(|s| &s.points);
        Self::of(points.flat_map(|p| [p.low, p.median, p.high]), panel.y.scale)
    }

    fn of(values: impl Iterator<Item = f64>, scale: AxisScale) -> Self {
        let placed = values.map(|v| place(v, scale)).filter(|v| v.is_finite());
        let (low, high) =
            placed.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        let (low, high) = if low <= high { (low, high) } else { (0.0, 1.0) };
        // One value, or none: any range around it.
        let span =
            if high - low > 1e-9 * high.abs().max(low.abs()) { high - low } else { low.abs().max(1.0) };
        Self { low: low - ROOM * span, high: high + ROOM * span, scale }
    }

    /// Whether a value has a place on the axis.
    pub(super) fn shows(&self, value: f64) -> bool {
        place(value, self.scale).is_finite()
    }

    /// Where a value is, 0 at the lower end and 1 at the upper; kept inside.
    pub(super) fn share(&self, value: f64) -> f64 {
        ((place(value, self.scale) - self.low) / (self.high - self.low)).clamp(0.0, 1.0)
    }

    /// The ticks with their texts, and the name of the axis with its unit.
    pub(super) fn ticks(&self, axis: &Axis) -> (Vec<(f64, String)>, String) {
        let with_unit = |unit: &str| match unit {
            "" => axis.name.clone(),
            unit => format!("{} ({unit})", axis.name),
        };
        match self.scale {
            AxisScale::Linear => {
                let ticks = RangedCoordf64::from(self.low..self.high).key_points(TICKS);
                let numbers = Numbers::for_ticks(&ticks);
                let unit = numbers.unit(&axis.unit);
                let unit = unit.trim_end_matches(", ");
                (ticks.into_iter().map(|t| (t, numbers.write(t))).collect(), with_unit(unit))
            }
            AxisScale::Log => (self.log_ticks(), with_unit(&axis.unit)),
        }
    }

    /// Powers of ten, every few of them over a long range, and 2 and 5 times them over a short one.
    fn log_ticks(&self) -> Vec<(f64, String)> {
        let decades = self.high - self.low;
        let inside = |t: &f64| (self.low..=self.high).contains(&t.log10());
        let (first, last) = (self.low.floor() as i32, self.high.ceil() as i32);
        let values: Vec<f64> = if decades < 2.0 {
            let factors: &[f64] =
                if decades < 0.7 { &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0] } else { &[1.0, 2.0, 5.0] };
            (first..=last).flat_map(|e| factors.iter().map(move |f| f * 10f64.powi(e))).collect()
        } else {
            let step = (decades / TICKS as f64).ceil().max(1.0) as i32;
            (first..=last).filter(|e| e.rem_euclid(step) == 0).map(|e| 10f64.powi(e)).collect()
        };
        values.into_iter().filter(inside).map(|t| (t, written(t))).collect()
    }
}

fn place(value: f64, scale: AxisScale) -> f64 {
    match scale {
        AxisScale::Linear => value,
        AxisScale::Log if value > 0.0 => value.log10(),
        AxisScale::Log => f64::NAN,
    }
}

/// A tick of a logarithmic axis: plain in the middle, a power of ten far from one.
fn written(tick: f64) -> String {
    let exponent = (tick.log10() + 1e-9).floor() as i32;
    if (-2..4).contains(&exponent) {
        return format!("{}", (tick * 1e6).round() / 1e6);
    }
    let factor = tick / 10f64.powi(exponent);
    let power = format!("10{}", raised(exponent));
    if (factor - 1.0).abs() < 1e-9 { power } else { format!("{}·{power}", (factor * 10.0).round() / 10.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn log(low: f64, high: f64) -> Vec<String> {
        let span = Span::of([low, high].into_iter(), AxisScale::Log);
        span.log_ticks().into_iter().map(|(_, text)| text).collect()
    }

    #[test]
    fn logarithmic_ticks_are_powers_unless_the_range_is_short() {
        assert_eq!(log(1e-3, 1e2), ["10⁻³", "0.01", "0.1", "1", "10", "100"]);
        assert_eq!(log(1e-20, 1.0), ["10⁻²⁰", "10⁻¹⁶", "10⁻¹²", "10⁻⁸", "10⁻⁴", "1"]);
        assert_eq!(log(3.0, 30.0), ["5", "10", "20"]);
        assert_eq!(log(2e4, 6e4), ["2·10⁴", "3·10⁴", "4·10⁴", "5·10⁴", "6·10⁴"]);
    }

    #[test]
    fn shares_run_from_the_lower_end_to_the_upper_whatever_the_values() {
        let span = Span::of([1.0, 100.0].into_iter(), AxisScale::Log);
        assert!((span.share(10.0) - 0.5).abs() < 1e-12);
        assert!(span.share(1.0) > 0.0 && span.share(1e9) == 1.0 && !span.shows(0.0));
        for values in [vec![], vec![5.0], vec![0.0, 0.0], vec![-1.0]] {
            for scale in [AxisScale::Linear, AxisScale::Log] {
                let span = Span::of(values.iter().copied(), scale);
                assert!(span.low < span.high, "{values:?}");
            }
        }
    }
}
