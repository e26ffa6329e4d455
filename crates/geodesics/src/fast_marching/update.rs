//! The local solvers: the distance at one vertex of a triangle from those at the other two.
//!
//! They have no branches, so that the same instructions solve several triangles. Comparisons with NaN fail.

use surface::{double_area, scalar_product};

/// A triangle `ABC` over which the distance at `C` is updated from those at `A` and `B`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stencil {
    /// `|AB|`
    pub(crate) base: f64,
    /// `|AC|`
    pub(crate) side: f64,
    /// `AB . AC`
    pub(crate) dot: f64,
    /// `|AB x AC|`
    pub(crate) cross: f64,
}

/// If the squared height of the point source above the line through the base is below this share of its squared
/// distance, it lies on that line up to rounding. Edges carry the front as well, and rounding would decide between
/// the two.
const COLLINEAR: f64 = 1e-12;

impl Stencil {
    /// The triangle with the lengths `|AB|`, `|AC|` and `|BC|`.
    pub(super) fn of_sides([base, side, third]: [f64; 3]) -> Self {
        Self { base, side, dot: scalar_product(third, base, side), cross: double_area([base, side, third]) }
    }

    /// Distance at `C` of a front that comes from a single point beyond the base, from the distances at `A` and `B`;
    /// infinite if the straight line from that point to `C` misses the base, or without such a point. Edges carry the
    /// front.
    ///
    /// Exact in the plane. Novotni and Klein 2002 (`novotni2002`), in coordinates that are multiples of `|AB|`.
    #[inline(always)]
    pub(crate) fn point_source(self, at_a: f64, at_b: f64) -> f64 {
        let Self { base, side, dot, cross } = self;
        let sq_base = base * base;
        // The point lies at (along, -height) / |AB|: at distance `at_a` from A and `at_b` from B.
        let along = 0.5 * (sq_base + (at_a - at_b) * (at_a + at_b));
        let reach = base * at_a;
        let sq_height = (reach - along) * (reach + along);
        let height = sq_height.sqrt();
        // Where the line crosses the base, as a share of the base, times its positive denominator.
        let crossing = along * cross + dot * height;
        let distance = (side * side + at_a * at_a + 2.0 * (cross * height - dot * along) / sq_base).sqrt();
        let is_hit = (sq_height >= COLLINEAR * reach * reach)
            & (crossing >= 0.0)
            & (crossing <= sq_base * (height + cross));
        if is_hit { distance } else { f64::INFINITY }
    }

    /// Distance at `C` of a front that is a straight line, from the distances at `A` and `B`; infinite if the
    /// characteristic through `C` misses the base.
    ///
    /// Kimmel and Sethian 1998 (`kimmel1998`): the larger root of their quadratic, here by the unit gradient whose
    /// component along the base is `(at_b - at_a) / |AB|`.
    #[inline(always)]
    pub(super) fn planar(self, at_a: f64, at_b: f64) -> f64 {
        let Self { base, dot, cross, .. } = self;
        let rise = at_b - at_a;
        let sq_height = (base - rise) * (base + rise);
        let (height, sq_base) = (sq_height.sqrt(), base * base);
        let crossing = dot * height - cross * rise;
        let distance = at_a + (rise * dot + height * cross) / sq_base;
        let is_hit = (sq_height > 0.0) & (crossing >= 0.0) & (crossing <= sq_base * height);
        if is_hit { distance } else { f64::INFINITY }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stencil(base: f64, [x, y]: [f64; 2]) -> Stencil {
        Stencil { base, side: x.hypot(y), dot: base * x, cross: base * y }
    }

    #[test]
    fn a_point_source_is_exact_in_the_plane_and_infinite_if_the_line_misses_the_base() {
        let triangle = stencil(2.0, [0.7, 1.5]);
        for sx in [-3.0f64, -0.5, 0.1, 1.0, 1.9, 4.0] {
            for sy in [1e-9, 0.3, 2.0, 50.0] {
                let at_a = sx.hypot(sy);
                let at_b = (sx - 2.0).hypot(sy);
                let exact = (sx - 0.7).hypot(sy + 1.5);
                let crossing = sx + (0.7 - sx) * sy / (sy + 1.5);
                let t = triangle.point_source(at_a, at_b);
                // The height of a source within rounding of the base's line cannot be recovered.
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
    fn a_planar_update_is_exact_for_a_straight_front() {
        let triangle = stencil(2.0, [0.7, 1.5]);
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
        for void in
            [stencil(0.0, [1.0, 0.0]), Stencil { base: 0.0, side: 1.0, dot: f64::NAN, cross: f64::NAN }]
        {
            for update in [void.point_source(1.0, 1.0), void.planar(1.0, 1.0)] {
                assert_eq!(f64::min(7.0, update), 7.0);
            }
        }
    }
}
