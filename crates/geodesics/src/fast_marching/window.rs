//! Windows: what one triangle sees of the source.

use crate::plane::{PlanePoint, cross, norm, sub};

/// A ray that misses a side by at most this share of its length goes straight on, unless shortest paths may bend at the
/// end that it misses: the path through the triangle next to the side is hardly different. On smooth surfaces fronts
/// bend again and again otherwise. Mean errors in per cent at .04, .4 and 1, with the [disagreement](DISAGREEMENT) that is allowed:
/// ten sheets with holes, spirals and pipes .064, .037, .048; six bodies .119, .102, .102; four subdivided ones .063, .041, .072.
pub(super) const NEAR_MISS: f64 = 0.4;

/// A window may reach an end of the side where it enters earlier than is known of the end by this share of the side, since distances
/// along a curved surface depend on the triangles that they cross. Without an allowance fronts take up rounding and unfinished
/// distances; with a large one rays pass through holes. Mean errors in per cent at .03, .05, .1 and without the comparison: sheets
/// with holes .040, .037, .070, .943; six bodies .123, .102, .102, .170; four subdivided ones .046, .041, .072, .207.
pub(super) const DISAGREEMENT: f64 = 0.05;

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

    /// The distance at a point of the triangle. Without branches.
    #[inline(always)]
    pub(super) fn distance(&self, target: PlanePoint) -> f64 {
        let ray = sub(target, self.source);
        let bend = bend_at_limit(ray, self.limits);
        self.offset + norm(bend) + norm(sub(ray, bend))
    }

    /// Where the path to a point bends last: at a limit or at the virtual source.
    pub(super) fn bend(&self, target: PlanePoint) -> PlanePoint {
        let [x, y] = bend_at_limit(sub(target, self.source), self.limits);
        [self.source[0] + x, self.source[1] + y]
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

/// The limit at which the path along a ray bends; zero, which is the source, if it bends at none.
#[inline(always)]
pub(super) fn bend_at_limit(ray: PlanePoint, [left, right]: [PlanePoint; 2]) -> PlanePoint {
    let [in_left, in_right] = shadows(cross(ray, left), -cross(ray, right));
    select_point(in_left, left, select_point(in_right, right, [0.0; 2]))
}

/// Without a branch.
#[inline(always)]
pub(super) fn select(condition: bool, yes: f64, no: f64) -> f64 {
    if condition { yes } else { no }
}

#[inline(always)]
pub(super) fn select_point(condition: bool, yes: PlanePoint, no: PlanePoint) -> PlanePoint {
    [select(condition, yes[0], no[0]), select(condition, yes[1], no[1])]
}

/// Whether a number is below another, or there is no limit to compare with.
#[inline(always)]
pub(super) fn below_or_nan(a: f64, b: f64) -> bool {
    (a < b) | a.is_nan() | b.is_nan()
}

/// Whether a point is in the shadow of the left and of the right limit, from products that are negative there. If it is
/// in both, the deeper one counts.
#[inline(always)]
pub(super) fn shadows(at_left: f64, at_right: f64) -> [bool; 2] {
    let in_left = (at_left < 0.0) & (below_or_nan(at_left, at_right) | (at_left == at_right));
    [in_left, (at_right < 0.0) & !in_left]
}
