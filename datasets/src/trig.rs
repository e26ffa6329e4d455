//! Sine and cosine from basic arithmetic.
//!
//! The last bits of `sin` and `cos` in the standard library depend on the platform. Additions,
//! multiplications and square roots do not, and so neither do the datasets.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::Matrix3;

/// Sine and cosine of `angle` (radians, up to a few turns) within 1e-15.
pub(crate) fn sin_cos(angle: f64) -> (f64, f64) {
    let quarters = (angle / FRAC_PI_2).round();
    let x = angle - quarters * FRAC_PI_2;
    // |x| <= pi/4, where the remainders of both series stay below 1e-16.
    let x2 = x * x;
    let (mut sin, mut cos) = (0.0, 0.0);
    for k in (1..=9).rev() {
        let k = f64::from(k);
        sin = (1.0 + sin) * -x2 / ((2.0 * k) * (2.0 * k + 1.0));
        cos = (1.0 + cos) * -x2 / ((2.0 * k - 1.0) * (2.0 * k));
    }
    let (sin, cos) = (x * (1.0 + sin), 1.0 + cos);
    match (quarters as i64).rem_euclid(4) {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// The rotation by `y` degrees about the y axis, then `x` about the x axis, then `z` about the z axis.
pub(crate) fn rotation(x: f64, y: f64, z: f64) -> Matrix3<f64> {
    let [(sx, cx), (sy, cy), (sz, cz)] = [x, y, z].map(|degrees| sin_cos(degrees * (PI / 180.0)));
    let about_x = Matrix3::new(1.0, 0.0, 0.0, 0.0, cx, -sx, 0.0, sx, cx);
    let about_y = Matrix3::new(cy, 0.0, sy, 0.0, 1.0, 0.0, -sy, 0.0, cy);
    let about_z = Matrix3::new(cz, -sz, 0.0, sz, cz, 0.0, 0.0, 0.0, 1.0);
    about_z * about_x * about_y
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sine_and_cosine_agree_with_the_standard_library() {
        for i in -4000..=4000 {
            let angle = f64::from(i) * 0.005;
            let (sin, cos) = sin_cos(angle);
            assert!((sin - angle.sin()).abs() < 1e-14, "sin {angle}");
            assert!((cos - angle.cos()).abs() < 1e-14, "cos {angle}");
        }
    }
}
