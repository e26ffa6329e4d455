//! Colors: the sRGB curve, a palette for classes, a color map for numbers.

use nalgebra::Point3;
use plotters::prelude::ViridisRGB;

pub use crate::color_map::ColorMap;

/// 8-bit sRGB.
pub type Rgb = [u8; 3];

/// The palette of Okabe and Ito (2008), which people with any common color blindness can tell apart. The colors
/// that are strongest on white come first.
const OKABE_ITO: [Rgb; 8] = [
    [0, 114, 178],
    [213, 94, 0],
    [0, 158, 115],
    [204, 121, 167],
    [230, 159, 0],
    [86, 180, 233],
    [60, 60, 60],
    [240, 228, 66],
];

/// The color of class number `class`. Colors repeat from the ninth class on.
pub fn class_color(class: usize) -> Rgb {
    OKABE_ITO[class % OKABE_ITO.len()]
}

/// The color of the surfaces of class number `class`: its color mixed with a pale clay, so that shading shows.
pub fn class_clay(class: usize) -> Rgb {
    mix(class_color(class), [226, 224, 220], 0.55)
}

/// A mixture of `a` and `b` in which the share of `b` is `share`.
pub fn mix(a: Rgb, b: Rgb, share: f64) -> Rgb {
    std::array::from_fn(|i| (f64::from(a[i]) * (1.0 - share) + f64::from(b[i]) * share).round() as u8)
}

/// The color map viridis: dark for 0, light for 1, and equal steps look equal. Values outside 0..=1 are clamped;
/// NaN is gray.
pub fn perceptual(t: f64) -> Rgb {
    if t.is_nan() {
        return [160, 160, 160];
    }
    let color = ViridisRGB::get_color(t.clamp(0.0, 1.0));
    [color.0, color.1, color.2]
}

/// A color for each point, by its place in the box around all of them: corresponding points of two surfaces are easy to
/// find by eye if both have the colors of one. Points that are not finite are gray.
pub fn place_colors(points: &[Point3<f64>]) -> Vec<Rgb> {
    let ranges = [0, 1, 2].map(|axis| {
        let values: Vec<f64> = points.iter().map(|p| p[axis]).collect();
        value_range(&values).unwrap_or_default()
    });
    let color = |p: &Point3<f64>| {
        if !p.coords.iter().all(|x| x.is_finite()) {
            return perceptual(f64::NAN);
        }
        [0, 1, 2].map(|axis| {
            let [low, high] = ranges[axis];
            let share = if high > low { (p[axis] - low) / (high - low) } else { 0.5 };
            (30.0 + 215.0 * share).round() as u8
        })
    };
    points.iter().map(color).collect()
}

/// The least and the greatest of the finite numbers.
pub fn value_range(values: &[f64]) -> Option<[f64; 2]> {
    let finite = || values.iter().copied().filter(|v| v.is_finite());
    let low = finite().reduce(f64::min)?;
    Some([low, finite().fold(low, f64::max)])
}

/// The colors of values in [`perceptual`], from the least finite value (dark) to the greatest (bright);
/// other values are gray.
pub fn color_scale(values: &[f64]) -> impl Fn(f64) -> Rgb + use<> {
    let [least, most] = value_range(values).unwrap_or_default();
    // Halved first: the range of finite values may overflow.
    let range = most / 2.0 - least / 2.0;
    move |value| {
        let share = if range > 0.0 { (value / 2.0 - least / 2.0) / range } else { 0.0 };
        perceptual(if value.is_finite() { share } else { f64::NAN })
    }
}

/// The colors between which [`perceptual`] interpolates linearly, at equal steps from 0 to 1.
pub fn perceptual_stops() -> [Rgb; 8] {
    std::array::from_fn(|i| perceptual(i as f64 / 7.0))
}

/// 8-bit sRGB as `#rrggbb`.
pub fn hex([red, green, blue]: Rgb) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// The linear light of an 8-bit sRGB channel, in 0..=1.
pub fn to_linear(channel: u8) -> f32 {
    let c = f32::from(channel) / 255.0;
    if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}

/// The 8-bit sRGB channel of a linear light, clamped to 0..=1.
pub fn from_linear(light: f32) -> u8 {
    let l = light.clamp(0.0, 1.0);
    let c = if l <= 0.003_130_8 { 12.92 * l } else { 1.055 * l.powf(1.0 / 2.4) - 0.055 };
    (c * 255.0).round() as u8
}
