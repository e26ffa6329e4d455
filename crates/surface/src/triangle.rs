//! Triangles from their side lengths.

/// A triangle laid out in the plane: its base runs from the origin along the x-axis, its apex lies above.
///
/// ```
/// use canonform_surface::Triangle;
///
/// let triangle = Triangle::from_sides([5.0, 3.0, 4.0]);
/// assert!((triangle.x - 1.8).abs() < 1e-15 && (triangle.y - 2.4).abs() < 1e-15);
/// assert_eq!(triangle.area(), 6.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Triangle {
    /// Length of the base, which ends at `(base, 0)`.
    pub base: f64,
    /// Position of the apex along the base.
    pub x: f64,
    /// Height of the apex above the base; not negative.
    pub y: f64,
}

/// Twice the area of the triangle with these sides, in any order; zero if they violate the triangle inequality.
///
/// Heron's formula in Kahan's form, which is accurate for needles.
#[inline]
pub fn twice_area([p, q, r]: [f64; 3]) -> f64 {
    // Not `min` and `max`, which check for NaN as well.
    let least = |p: f64, q: f64| if p < q { p } else { q };
    let greatest = |p: f64, q: f64| if p < q { q } else { p };
    let (low, high) = (least(p, q), greatest(p, q));
    let (a, middle) = (greatest(high, r), least(high, r));
    let (b, c) = (greatest(low, middle), least(low, middle));
    // a >= b >= c
    let (sum, excess, p, q) = (a + (b + c), c - (a - b), c + (a - b), a + (b - c));
    let product = sum * excess * p * q;
    if product.is_normal() {
        0.5 * product.max(0.0).sqrt()
    } else {
        // The triangle is flat, or the product overflows or underflows.
        0.5 * (sum * excess).max(0.0).sqrt() * (p * q).max(0.0).sqrt()
    }
}

/// Scalar product of two sides of a triangle from their common corner, from their lengths `p` and `q` and that of the
/// side opposite.
#[inline]
pub fn scalar_product(opposite: f64, p: f64, q: f64) -> f64 {
    0.5 * (q * q + (p - opposite) * (p + opposite))
}

impl Triangle {
    /// The triangle with the given lengths of the base and of the sides from its start and its end to the apex.
    ///
    /// The height is zero if they violate the triangle inequality. Over a base without length, the apex is above its
    /// start.
    #[inline]
    pub fn from_sides([base, left, right]: [f64; 3]) -> Self {
        if base <= 0.0 {
            return Self { base, x: 0.0, y: left };
        }
        let x = 0.5 * (base + (left - right) * ((left + right) / base));
        Self { base, x, y: twice_area([base, right, left]) / base }
    }

    /// The lengths of the base and of the sides from its start and its end to the apex.
    pub fn sides(self) -> [f64; 3] {
        let Self { base, x, y } = self;
        [base, x.hypot(y), (base - x).hypot(y)]
    }

    /// Its area.
    pub fn area(self) -> f64 {
        0.5 * self.base * self.y
    }

    /// The cotangents at the start of the base, at its end and at the apex; infinite or NaN in a flat triangle.
    pub fn cotangents(self) -> [f64; 3] {
        let Self { base, x, y } = self;
        [x / y, (base - x) / y, self.apex_cotangent()]
    }

    pub(crate) fn apex_cotangent(self) -> f64 {
        let Self { base, x, y } = self;
        (x * (x - base) + y * y) / (base * y)
    }

    /// The distance between the apex of this triangle and that of `other`, which lies on the other side of the same
    /// base and is given with the base reversed.
    pub(crate) fn apex_to_apex(self, other: Self) -> f64 {
        (self.x - (self.base - other.x)).hypot(self.y + other.y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_layout_has_the_given_sides() {
        for sides in [[3.0, 5.0, 4.0], [4.0, 3.0, 5.0], [5.0, 4.0, 3.0], [1.0, 1e-6, 1.0], [1e-6, 1.0, 1.0]] {
            let t = Triangle::from_sides(sides);
            for (a, b) in t.sides().iter().zip(sides) {
                assert!((a - b).abs() < 1e-14, "{t:?} {sides:?}");
            }
        }
        assert!((Triangle::from_sides([3.0, 5.0, 4.0]).area() - 6.0).abs() < 1e-14);
    }

    #[test]
    fn lengths_of_no_triangle_give_a_flat_one() {
        for [left, right] in [[1.0, 1.0], [1.0, 0.5], [0.0, 2.0], [7.0, 1.0]] {
            let t = Triangle::from_sides([2.0, left, right]);
            assert!(t.y == 0.0 && t.x.is_finite(), "{t:?}");
        }
        assert_eq!(Triangle::from_sides([0.0, 3.0, 3.0]), Triangle { base: 0.0, x: 0.0, y: 3.0 });
        assert_eq!(twice_area([0.0; 3]).max(0.0), 0.0);
    }

    #[test]
    fn areas_of_tiny_and_huge_triangles_neither_underflow_nor_overflow() {
        for scale in [1e-140, 1e-90, 1e90, 1e140] {
            let area = twice_area([3.0 * scale, 5.0 * scale, 4.0 * scale]);
            assert!((area / (12.0 * scale * scale) - 1.0).abs() < 1e-15, "{area}");
        }
    }

    #[test]
    fn cotangents_are_those_of_the_angles() {
        let [a, b, c] = Triangle::from_sides([5.0, 4.0, 3.0]).cotangents();
        assert!((a - 4.0 / 3.0).abs() < 1e-14 && (b - 0.75).abs() < 1e-14 && c.abs() < 1e-14, "{a} {b} {c}");
        let sixty = Triangle::from_sides([2.0; 3]).cotangents();
        assert!(sixty.iter().all(|c| (c - 1.0 / 3f64.sqrt()).abs() < 1e-15));
        assert!((scalar_product(5.0, 3.0, 4.0) - 0.0).abs() < 1e-15);
        assert!((scalar_product(2.0, 2.0, 2.0) - 2.0).abs() < 1e-15);
    }
}
