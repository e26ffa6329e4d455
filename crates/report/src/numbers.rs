//! Numbers as text: ticks of an axis, durations, amounts of memory.

use plotters::coord::ranged1d::Ranged;
use plotters::coord::types::RangedCoordf64;

/// Round values within `range` at equal steps, at most about `most` of them.
pub fn ticks([low, high]: [f64; 2], most: usize) -> Vec<f64> {
    RangedCoordf64::from(low..high).key_points(most)
}

/// Ticks with the fewest digits that tell all of them apart, and the unit of their axis, which may be missing. Very large and very
/// small ones share a power of ten, which the unit has.
pub fn tick_labels(ticks: &[f64], unit: &str) -> (Vec<String>, String) {
    let largest = ticks.iter().fold(0.0_f64, |m, t| m.max(t.abs()));
    let plain = largest == 0.0 || (0.01..10_000.0).contains(&largest);
    let exponent = if plain { 0 } else { 3 * (largest.log10() / 3.0).floor() as i32 };
    let power = 10f64.powi(exponent);
    let exact = |t: &f64, decimals: i32| {
        let digits = t / power * 10f64.powi(decimals);
        (digits - digits.round()).abs() < 1e-6 * (largest / power * 10f64.powi(decimals)).max(1.0)
    };
    let decimals = (0..9).find(|&d| ticks.iter().all(|t| exact(t, d))).unwrap_or(9);
    let unit = match (exponent, unit) {
        (0, unit) => unit.to_owned(),
        (exponent, "") => format!("×10{}", superscript(exponent)),
        (exponent, unit) => format!("×10{}, {unit}", superscript(exponent)),
    };
    (ticks.iter().map(|tick| signed(tick / power, decimals as usize)).collect(), unit)
}

/// An exponent in superscript digits.
pub fn superscript(exponent: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let sign = if exponent < 0 { "⁻" } else { "" };
    let digits: String =
        exponent.unsigned_abs().to_string().bytes().map(|d| DIGITS[usize::from(d - b'0')]).collect();
    format!("{sign}{digits}")
}

/// A number with a fixed number of decimals and a typographic minus sign, without a sign if it rounds to zero.
pub fn signed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(zero) if zero.chars().all(|c| matches!(c, '0' | '.')) => zero.to_string(),
        Some(positive) => format!("\u{2212}{positive}"),
        None => text,
    }
}

/// A number with so many significant digits; whole numbers in full.
pub fn significant(value: f64, digits: i32) -> String {
    let size = value.abs();
    if value.fract() == 0.0 && size < 1e15 {
        return format!("{value:.0}");
    }
    if !(1e-4..1e6).contains(&size) {
        return format!("{value:.1e}");
    }
    // The first digit is that of the largest power of ten.
    let decimals = (digits - 1 - size.log10().floor() as i32).max(0) as usize;
    format!("{value:.decimals$}")
}

/// A duration in seconds with at least two significant digits.
pub fn seconds(seconds: f64) -> String {
    match seconds {
        s if s >= 10.0 => format!("{s:.1}"),
        s if s >= 1.0 => format!("{s:.2}"),
        s if s >= 0.01 => format!("{s:.3}"),
        s => format!("{s:.4}"),
    }
}

/// An amount of memory in MiB or GiB.
pub fn bytes(bytes: usize) -> String {
    let mib = bytes as f64 / f64::from(1 << 20);
    match mib {
        m if m >= 1024.0 => format!("{:.2} GiB", m / 1024.0),
        m if m >= 100.0 => format!("{m:.0} MiB"),
        m => format!("{m:.1} MiB"),
    }
}
