//! A triangle laid out in the plane.

/// The apex `C` of a triangle `ABC` laid out with `A` in the origin, `B` on the positive x axis and
/// `C` above it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Corner {
    /// Abscissa of the apex.
    pub(crate) x: f64,
    /// Height of the apex above the base.
    pub(crate) y: f64,
}

impl Corner {
    /// A corner over a base without length: every comparison with its NaN fails.
    const VOID: Self = Self { x: f64::NAN, y: f64::NAN };

    /// The corner `C` with `base = |AB|`, `from_a = |AC|`, `from_b = |BC|`; NaN when the base has no
    /// length.
    pub(crate) fn from_lengths(base: f64, from_a: f64, from_b: f64) -> Self {
        if base <= 0.0 {
            return Self::VOID;
        }
        let x = 0.5 * (base + (from_a - from_b) * (from_a + from_b) / base);
        // Rounding, or lengths that break the triangle inequality, may leave no height at all.
        let y = ((from_a - x) * (from_a + x)).max(0.0).sqrt();
        Self { x, y }
    }
}
