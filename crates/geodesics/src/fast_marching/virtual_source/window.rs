//! Windows: what one triangle sees of the source.

use crate::plane::{PlanePoint, cross, norm, sub};

/// The test points of a triangle lie on the segments from its centroid to its corners, at this share of their length.
/// If all of them are in the shadow of a limit, the window bends there. At 1 windows reach too far into shadows and
/// distances become too short, at 0 they leave the light too early and distances become too long; `make bench-peers`
/// measures the errors.
pub(super) const TEST_POINTS: f64 = 0.75;

/// A source is on the line through a side, and a ray meets its end, up to this share of the distance: rounding.
pub(super) const COLLINEAR: f64 = 1e-12;

/// The view of the source through one side of a triangle, the *entry*, laid out in the plane: the entry runs from the
/// origin along the x-axis, the triangle lies above it.
///
/// Rays start from the *virtual source*: the source itself, or the vertex where they bent last. They run between two
/// *limits*, vertices at which shortest paths may bend. What lies beyond a limit is in its shadow: the path to there
/// bends at the limit.
#[derive(Debug, Clone, Copy)]
pub(super) struct SourceWindow {
    /// The virtual source.
    pub(super) source: PlanePoint,
    /// The limits on the left and on the right; NaN without one.
    pub(super) limits: [PlanePoint; 2],
    /// Distance of the virtual source from the source.
    pub(super) offset: f64,
}

/// No limit: comparisons with it are false.
pub(super) const NO_LIMIT: PlanePoint = [f64::NAN; 2];

/// A triangle above its entry, which starts at the origin.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entered {
    /// Length of the entry.
    pub(super) base: f64,
    pub(super) apex: PlanePoint,
}

impl Entered {
    pub(super) fn centroid(self) -> PlanePoint {
        [(self.base + self.apex[0]) / 3.0, self.apex[1] / 3.0]
    }
}

impl SourceWindow {
    /// All rays from a point at the given distance from the source.
    pub(super) fn around(source: PlanePoint, offset: f64) -> Self {
        Self { source, limits: [NO_LIMIT; 2], offset }
    }

    /// All rays from a point that the window sees, and the distance of `target` through it.
    #[inline]
    fn bent(&self, at: PlanePoint, target: PlanePoint) -> (Self, f64) {
        let offset = self.offset + norm(sub(at, self.source));
        (Self::around(at, offset), offset + norm(sub(target, at)))
    }

    /// The distance at a point of the triangle.
    #[inline]
    pub(super) fn distance(&self, target: PlanePoint) -> f64 {
        let ray = sub(target, self.source);
        for (limit, sign) in self.limits.into_iter().zip([1.0, -1.0]) {
            if sign * cross(ray, sub(limit, self.source)) < 0.0 {
                return self.bent(limit, target).1;
            }
        }
        self.offset + norm(ray)
    }

    /// The distance at the middle of the side on the left or right of the entry.
    pub(super) fn middle_distance(&self, triangle: Entered, is_right: bool) -> f64 {
        let [x, y] = triangle.apex;
        let end = if is_right { triangle.base } else { 0.0 };
        self.distance([0.5 * (x + end), 0.5 * y])
    }
}
