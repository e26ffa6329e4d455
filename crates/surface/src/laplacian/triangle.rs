//! One triangle, laid out in the plane by its side lengths.

/// A triangle with corner 0 at the origin, corner 1 at `(base, 0)` and corner 2 at `(x, y)`, `y >= 0`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Triangle {
    /// Length of the side from corner 0 to corner 1.
    pub base: f64,
    /// Where corner 2 is along that side.
    pub x: f64,
    /// How far corner 2 is from that side.
    pub y: f64,
}

impl Triangle {
    /// The triangle whose sides run from corner 0 to 1, from 1 to 2 and from 2 to 0; flat when no
    /// triangle has these sides. The base is positive.
    ///
    /// The height is Kahan's form of Heron's formula, accurate for needles.
    #[must_use]
    pub fn from_sides([base, right, left]: [f64; 3]) -> Self {
        let (low, high) = if base < right { (base, right) } else { (right, base) };
        let (a, low) = if high < left { (left, (low, high)) } else { (high, (low, left)) };
        let (b, c) = if low.0 < low.1 { (low.1, low.0) } else { low };
        // a >= b >= c
        let product = (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c));
        let x = 0.5 * (base + (left - right) * ((left + right) / base));
        Self { base, x, y: 0.5 * product.max(0.0).sqrt() / base }
    }

    /// The sides from corner 0 to 1, from 1 to 2 and from 2 to 0.
    #[must_use]
    pub fn sides(self) -> [f64; 3] {
        let Self { base, x, y } = self;
        [base, (base - x).hypot(y), x.hypot(y)]
    }

    /// Its area.
    #[must_use]
    pub fn area(self) -> f64 {
        0.5 * self.base * self.y
    }

    /// The cotangent of the angle in each corner; infinite or NaN in a flat triangle.
    #[must_use]
    pub fn cotangents(self) -> [f64; 3] {
        let Self { base, x, y } = self;
        [x / y, (base - x) / y, self.apex_cotangent()]
    }

    /// The cotangent of the angle in corner 2, opposite the base.
    pub(super) fn apex_cotangent(self) -> f64 {
        let Self { base, x, y } = self;
        (x * (x - base) + y * y) / (base * y)
    }

    /// The distance between the apex of this triangle and that of `other`, laid out on the other
    /// side of the same base, run through the other way.
    pub(super) fn apex_to_apex(self, other: Self) -> f64 {
        (self.x - (self.base - other.x)).hypot(self.y + other.y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layout_has_the_sides() {
        for sides in [[3.0, 4.0, 5.0], [4.0, 5.0, 3.0], [5.0, 3.0, 4.0], [1.0, 1.0, 1e-6], [1e-6, 1.0, 1.0]] {
            let t = Triangle::from_sides(sides);
            for (a, b) in t.sides().iter().zip(sides) {
                assert!((a - b).abs() < 1e-14, "{t:?} {sides:?}");
            }
        }
        assert!((Triangle::from_sides([3.0, 4.0, 5.0]).area() - 6.0).abs() < 1e-14);
        assert_eq!(Triangle::from_sides([2.0, 1.0, 1.0]).y, 0.0);
        assert_eq!(Triangle::from_sides([2.0, 0.5, 1.0]).y, 0.0);
    }

    #[test]
    fn cotangents_are_those_of_the_angles() {
        let [a, b, c] = Triangle::from_sides([5.0, 3.0, 4.0]).cotangents();
        assert!((a - 4.0 / 3.0).abs() < 1e-14 && (b - 0.75).abs() < 1e-14 && c.abs() < 1e-14);
        let sixty = Triangle::from_sides([2.0; 3]).cotangents();
        assert!(sixty.iter().all(|c| (c - 1.0 / 3f64.sqrt()).abs() < 1e-15));
    }

    #[test]
    fn a_square_has_two_equal_diagonals() {
        let half = Triangle::from_sides([2f64.sqrt(), 1.0, 1.0]);
        assert!((half.apex_to_apex(half) - 2f64.sqrt()).abs() < 1e-15);
        // A kite: the apices of heights 1 and 3 over a base of 2, both over its middle.
        let (low, high) = (Triangle { base: 2.0, x: 1.0, y: 1.0 }, Triangle { base: 2.0, x: 1.0, y: 3.0 });
        assert_eq!(low.apex_to_apex(high), 4.0);
    }
}
