//! Windows: what one triangle sees of the source.

use crate::plane::{PlanePoint, cross, norm, sub};

/// The test points of a triangle lie on the segments from its centroid to its corners, at this share of their length.
/// If all of them are in the shadow of a limit, the window bends there. At 1 windows reach too far into shadows and
/// distances become too short, at 0 they leave the light too early and distances become too long; `make bench-peers`
/// measures the errors.
pub(super) const TEST_POINTS: f64 = 0.7;

/// A ray that misses a side by at most this share of its length goes straight on, unless shortest paths may bend at the
/// end that it misses: the path through the triangle next to the side is hardly different. On smooth surfaces fronts
/// bend again and again otherwise, but where this is large, paths across corners become too short. Mean errors in per
/// cent at 0, .04 and .1: rocker-arm .121, .117, .114; bisected cat .046, .037, .034; armadillo .085, .082, .079;
/// subdivided once .053, .045, .043; twice -, .047, .085.
pub(super) const NEAR_MISS: f64 = 0.04;

/// Distances that differ by less than this share are equal up to rounding: a smaller improvement causes no visit.
pub(super) const ROUNDING: f64 = 1e-13;

/// A source is on the line through a side, and a ray meets its end, up to this share of the distance: rounding.
pub(super) const COLLINEAR: f64 = 1e-12;

/// The view of the source from one triangle, in the plane of its corners.
///
/// Rays start from the *virtual source*: the source itself, or the vertex where they bent last. They run between two
/// *limits*, vertices at which shortest paths may bend. What lies beyond a limit is in its shadow: the path to there
/// bends at the limit.
#[derive(Debug, Clone, Copy)]
pub(super) struct SourceWindow {
    /// The virtual source.
    pub(super) source: PlanePoint,
    /// The limits on the left and on the right, from the virtual source; NaN without one.
    pub(super) limits: [PlanePoint; 2],
    /// Distance of the virtual source from the source.
    pub(super) offset: f64,
}

/// No limit: comparisons with it are false.
const NO_LIMIT: PlanePoint = [f64::NAN; 2];

impl SourceWindow {
    /// All rays from a point at the given distance from the source.
    pub(super) fn around(source: PlanePoint, offset: f64) -> Self {
        Self { source, limits: [NO_LIMIT; 2], offset }
    }

    /// The distance at a point of the triangle.
    pub(super) fn distance(&self, target: PlanePoint) -> f64 {
        let ray = sub(target, self.source);
        for (limit, sign) in self.limits.into_iter().zip([1.0, -1.0]) {
            if sign * cross(ray, limit) < 0.0 {
                return self.offset + norm(limit) + norm(sub(ray, limit));
            }
        }
        self.offset + norm(ray)
    }

    /// All numbers of the window: source, limits, offset.
    #[inline(always)]
    pub(super) fn numbers(&self) -> [f64; 7] {
        let Self { source: [x, y], limits: [[lx, ly], [rx, ry]], offset } = *self;
        [x, y, lx, ly, rx, ry, offset]
    }

    /// The window with these [numbers](Self::numbers).
    #[inline(always)]
    pub(super) fn of([x, y, lx, ly, rx, ry, offset]: [f64; 7]) -> Self {
        Self { source: [x, y], limits: [[lx, ly], [rx, ry]], offset }
    }

    /// The same window of the [mirrored](super::triangles::MarchTriangle::mirrored) triangle, whose base has the given length.
    pub(super) fn mirrored(&self, base: f64) -> Self {
        let Self { source: [x, y], limits: [left, right], offset } = *self;
        let flipped = |[x, y]: PlanePoint| [-x, y];
        Self { source: [base - x, y], limits: [flipped(right), flipped(left)], offset }
    }
}
