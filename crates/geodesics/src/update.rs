//! The two local solvers: the distance at a corner from the distances at the two others.
//!
//! Both work in the plane of a triangle `ABC` laid out with `A` in the origin, `B` on the positive
//! x axis and `C` above it.

/// A triangle laid out for the update of its apex `C` from its base `AB`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Corner {
    /// Length of the base.
    pub(crate) base: f64,
    /// Abscissa of the apex.
    pub(crate) x: f64,
    /// Height of the apex above the base.
    pub(crate) y: f64,
}

impl Corner {
    /// A corner that never updates anything: every comparison with its NaN fails.
    pub(crate) const VOID: Self = Self { base: f64::NAN, x: f64::NAN, y: f64::NAN };

    /// The corner `C` with `base = |AB|`, `from_a = |AC|`, `from_b = |BC|`; [`Corner::VOID`] when the
    /// base has no length.
    pub(crate) fn from_lengths(base: f64, from_a: f64, from_b: f64) -> Self {
        if base <= 0.0 {
            return Self::VOID;
        }
        let x = 0.5 * (base + (from_a - from_b) * (from_a + from_b) / base);
        // Rounding, or lengths that break the triangle inequality, may leave no height at all.
        let y = ((from_a - x) * (from_a + x)).max(0.0).sqrt();
        Self { base, x, y }
    }

    /// Whether a front that enters through the base can reach the apex before the base's first end.
    ///
    /// If it does, the angle at the apex exceeds the angle at that end, so the base is longer than
    /// the side from the apex to the other end.
    #[inline]
    pub(crate) fn may_complete_late(self) -> bool {
        2.0 * self.base * self.x > self.x * self.x + self.y * self.y
    }

    /// Distance at the apex if the front comes from a single point beyond the base, given the
    /// distances at `A` and `B`; infinite when the straight line from that point to the apex misses
    /// the base or no such point exists (the edges then carry the front).
    ///
    /// Exact in the plane. Novotni and Klein 2002.
    #[inline]
    pub(crate) fn point_source(self, at_a: f64, at_b: f64) -> f64 {
        let Self { base, x, y } = self;
        // The virtual source (sx, -sy) lies at distance `at_a` from A and `at_b` from B.
        let sx = 0.5 * (base + (at_a - at_b) * (at_a + at_b) / base);
        let sy_sq = (at_a - sx) * (at_a + sx);
        if sy_sq < 0.0 {
            return f64::INFINITY;
        }
        let sy = sy_sq.sqrt();
        // Crossing of the line with the base, times (sy + y).
        let crossing = sx * y + x * sy;
        if crossing >= 0.0 && crossing <= base * (sy + y) {
            (x - sx).hypot_fast(y + sy)
        } else {
            f64::INFINITY
        }
    }

    /// Distance at the apex if the front is a straight line, given the distances at `A` and `B`;
    /// infinite when the characteristic through the apex misses the base.
    ///
    /// Kimmel and Sethian 1998: the larger root of their quadratic, here as the unit gradient whose
    /// component along the base is `(at_b - at_a) / base`.
    #[inline]
    pub(crate) fn planar(self, at_a: f64, at_b: f64) -> f64 {
        let Self { base, x, y } = self;
        let gx = (at_b - at_a) / base;
        let gy_sq = 1.0 - gx * gx;
        if gy_sq <= 0.0 {
            return f64::INFINITY;
        }
        let gy = gy_sq.sqrt();
        let crossing = x * gy - y * gx;
        if crossing >= 0.0 && crossing <= base * gy { at_a + gx * x + gy * y } else { f64::INFINITY }
    }
}

/// `sqrt(x^2 + y^2)` without the guard against overflow of `f64::hypot`, which costs ten times more:
/// mesh lengths are nowhere near `1e154`.
trait HypotFast {
    fn hypot_fast(self, y: Self) -> Self;
}

impl HypotFast for f64 {
    #[inline]
    fn hypot_fast(self, y: f64) -> f64 {
        (self * self + y * y).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corner(b: f64, c: [f64; 2]) -> Corner {
        Corner::from_lengths(b, c[0].hypot(c[1]), (c[0] - b).hypot(c[1]))
    }

    #[test]
    fn point_source_is_exact_in_the_plane_and_silent_when_the_line_misses_the_base() {
        let triangle = corner(2.0, [0.7, 1.5]);
        for sx in [-3.0f64, -0.5, 0.1, 1.0, 1.9, 4.0] {
            for sy in [1e-9, 0.3, 2.0, 50.0] {
                let at_a = sx.hypot(sy);
                let at_b = (sx - 2.0).hypot(sy);
                let exact = (sx - 0.7).hypot(sy + 1.5);
                let crossing = sx + (0.7 - sx) * sy / (sy + 1.5);
                let t = triangle.point_source(at_a, at_b);
                // A source within rounding of the base's line has no height that could be recovered.
                let tolerance = if sy < 1e-6 { 1e-7 } else { 1e-12 };
                if (0.01..=1.99).contains(&crossing) && (sy > 1e-6 || t.is_finite()) {
                    assert!((t - exact).abs() < tolerance * exact.max(1.0), "{t} against {exact}");
                } else if !(-0.01..=2.01).contains(&crossing) {
                    assert_eq!(t, f64::INFINITY);
                }
            }
        }
    }

    #[test]
    fn planar_is_exact_for_a_straight_front() {
        let triangle = corner(2.0, [0.7, 1.5]);
        for angle in [-0.35f64, -0.1, 0.0, 0.2, 0.4] {
            let (gx, gy) = angle.sin_cos();
            let front = |p: [f64; 2]| 5.0 + gx * p[0] + gy * p[1];
            let t = triangle.planar(front([0.0, 0.0]), front([2.0, 0.0]));
            assert!((t - front([0.7, 1.5])).abs() < 1e-13);
        }
        assert_eq!(triangle.planar(0.0, 1.9), f64::INFINITY);
        assert_eq!(triangle.planar(0.0, 2.1), f64::INFINITY);
    }

    #[test]
    fn a_base_without_length_never_updates() {
        let void = Corner::from_lengths(0.0, 1.0, 1.0);
        for update in [void.point_source(1.0, 1.0), void.planar(1.0, 1.0)] {
            assert_eq!(f64::min(7.0, update), 7.0);
        }
    }
}
