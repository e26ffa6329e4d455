//! Windows: intervals of edges that straight paths from one pseudo-source reach, and how they cross faces.

use super::bearing::Bearing;
use super::prepared::FaceFrame;

/// An interval of an edge that straight paths from one pseudo-source reach through one sequence of faces.
///
/// The edge lies on the x-axis from zero to its length, with the face to be entered above it and the unfolded
/// sequence below. The distance at a point `t` of the window is `offset + |(t, 0) - (x, -depth)|`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PathWindow<D = ()> {
    pub(super) start: f64,
    pub(super) end: f64,
    /// Position of the unfolded pseudo-source along the edge.
    pub(super) x: f64,
    /// Depth of the unfolded pseudo-source below the edge; not negative.
    pub(super) depth: f64,
    /// Distance of the pseudo-source from the source.
    pub(super) offset: f64,
    /// How many faces in a row were crossed around one vertex: positive for the edge's start, negative for its end.
    pub(super) turn: i32,
    /// The direction of its paths at the source.
    pub(super) bearing: D,
}

impl<D: Bearing> PathWindow<D> {
    /// Distance at the point `t` of the edge.
    #[inline]
    pub(super) fn distance(&self, t: f64) -> f64 {
        let along = t - self.x;
        self.offset + (along * along + self.depth * self.depth).sqrt()
    }

    /// The least distance in the window.
    #[inline]
    pub(super) fn least_distance(&self) -> f64 {
        self.distance(self.x.max(self.start).min(self.end))
    }

    /// The same window with the two ends of its edge, of the given length, exchanged.
    #[inline]
    pub(super) fn mirrored(&self, length: f64) -> Self {
        Self {
            start: length - self.end,
            end: length - self.start,
            x: length - self.x,
            turn: -self.turn,
            bearing: self.bearing.mirrored(),
            ..*self
        }
    }

    /// Cuts off the part that is nearer through the edge's start, a vertex at `distance`; returns whether any is
    /// left.
    ///
    /// Along the edge, the window's distance never grows faster than that from the vertex, so the part is an interval
    /// from the start, whose end solves a linear equation.
    #[inline]
    pub(super) fn cut_start(&mut self, distance: f64) -> bool {
        self.start = nearer_until(self.x, self.depth, distance - self.offset).max(self.start);
        self.start < self.end
    }

    /// As [`cut_start`](Self::cut_start), for the end of the edge, which has the given length.
    #[inline]
    pub(super) fn cut_end(&mut self, length: f64, distance: f64) -> bool {
        self.end = (length - nearer_until(length - self.x, self.depth, distance - self.offset)).min(self.end);
        self.end > self.start
    }
}

/// Up to which position the origin, at distance `lead`, is nearer than the pseudo-source at `(x, -depth)`: not
/// positive if nowhere, infinite if everywhere.
#[inline]
fn nearer_until(x: f64, depth: f64, lead: f64) -> f64 {
    let slope = lead + x;
    if slope > 0.0 { 0.5 * (x - lead + depth * depth / slope) } else { f64::INFINITY }
}

/// Positive where the paths of `left` come from further left than those of `right`, whose distance then decreases
/// relative to `left` with increasing `t`; linear in `t`.
#[inline]
pub(super) fn order<D>(left: &PathWindow<D>, right: &PathWindow<D>, t: f64) -> f64 {
    (t - left.x) * right.depth - (t - right.x) * left.depth
}

/// How far from equal rounding may leave two distances at a crossing, as a share of them.
const EQUAL: f64 = 1e-12;

/// Where in `low..high` the nearer of two windows changes from `left` to `right`; `None` if rounding hides it.
///
/// With `r` and `s` the distances to the unfolded pseudo-sources and `d` the difference of their offsets, `r = s + d`
/// squared is linear in the position but for `2 d s`; squared again it is quadratic. One of its roots may belong to
/// `-d`. If the two pseudo-sources are in line with a nearly double root, rounding leaves little of either. So a root
/// only counts if the distances agree there.
pub(super) fn crossing<D: Bearing>(
    left: &PathWindow<D>,
    right: &PathWindow<D>,
    [low, high]: [f64; 2],
) -> Option<f64> {
    let (p, q) = (left.x - low, right.x - low);
    let (rr, ss) = (p * p + left.depth * left.depth, q * q + right.depth * right.depth);
    let d = right.offset - left.offset;
    // slope * t + at_zero = 2 d s(t)
    let slope = 2.0 * (q - p);
    let at_zero = rr - ss - d * d;
    let dd = 4.0 * d * d;
    let (a, half_b, c) = (slope * slope - dd, slope * at_zero + dd * q, at_zero * at_zero - dd * ss);
    let root = (half_b * half_b - a * c).max(0.0).sqrt();
    let big = if half_b > 0.0 { -(half_b + root) } else { root - half_b };
    let is_change = |t: &f64| {
        let at = low + t;
        let r = left.distance(at) - left.offset;
        *t >= 0.0
            && at <= high
            && (r + left.offset - right.distance(at)).abs() <= EQUAL * (r + d.abs())
            && order(left, right, at) >= 0.0
    };
    [big / a, c / big].into_iter().find(is_change).map(|t| low + t)
}

/// Where the part of a side that a window reaches ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Until {
    /// At the ray through the end of the interval.
    Ray,
    /// At the apex: the interval ends on the ray to it.
    Apex,
}

impl<D: Bearing> PathWindow<D> {
    /// The part of a side of the next face that the rays of the window reach, unless it has no width. The side leaves the start of
    /// the base in the direction `(cos, sin)`.
    #[inline]
    pub(super) fn projected(&self, [cos, sin]: [f64; 2], length: f64, until: Until) -> Option<Self> {
        let Self { start, end, x, depth, .. } = *self;
        let below = x * sin + depth * cos;
        let meet = |t: f64| t * depth / (below - t * sin);
        let (near, far) = (meet(start).max(0.0), meet(end));
        // Rounding may let a ray along the side meet it beyond its end, before its start or nowhere.
        let far = if until == Until::Ray && far >= 0.0 { far.min(length) } else { length };
        (far > near).then(|| Self {
            start: near,
            end: far,
            x: x * cos - depth * sin,
            depth: below.max(0.0),
            turn: self.turn.max(0) + 1,
            bearing: self.bearing.turned([cos, sin]),
            ..*self
        })
    }
}

/// A ray that misses the apex by no more than this, in lengths of the base where it crosses it, bends there to meet
/// it. Rounding opens such gaps between windows that share a ray, and diverging rays widen them. The bent path is too
/// long by the square of the gap.
const NEAR_MISS: f64 = 1e-6;

/// The side of the apex on which the rays of a window pass: that of the base's start, that of its end, or both.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Passes {
    Left,
    Both,
    Right,
}

/// The shortest of the paths to the apex so far.
#[derive(Debug, Clone, Copy)]
pub(super) struct Apex {
    at: [f64; 2],
    slack: f64,
    /// Index of its window.
    pub(super) nearest: Option<usize>,
    pub(super) distance: f64,
    /// Where it crosses the base.
    pub(super) entry: f64,
    /// Where its last straight stretch begins.
    from: [f64; 2],
}

impl Apex {
    #[inline]
    pub(super) fn new(frame: &FaceFrame) -> Self {
        Self {
            at: frame.apex,
            slack: NEAR_MISS * frame.base,
            nearest: None,
            distance: f64::INFINITY,
            entry: 0.0,
            from: [0.0; 2],
        }
    }

    /// Where the ray from the window's pseudo-source to the apex crosses the base, times the height of the apex over
    /// the pseudo-source, which saves a division.
    #[inline]
    fn scaled_crossing<D>(&self, window: &PathWindow<D>) -> [f64; 2] {
        let [x, y] = self.at;
        [window.x * y + x * window.depth, window.depth + y]
    }

    /// Where the ray from the window's pseudo-source to the apex crosses the base.
    #[inline]
    pub(super) fn crossing<D>(&self, window: &PathWindow<D>) -> f64 {
        let [scaled, height] = self.scaled_crossing(window);
        scaled / height
    }

    #[inline]
    pub(super) fn passes<D>(&self, window: &PathWindow<D>) -> Passes {
        let [scaled, height] = self.scaled_crossing(window);
        if scaled >= window.end * height {
            Passes::Left
        } else if scaled <= window.start * height {
            Passes::Right
        } else {
            Passes::Both
        }
    }

    /// Considers the path through a window, straight or with a bend at the end of the window.
    #[inline]
    pub(super) fn consider<D: Bearing>(&mut self, index: usize, window: &PathWindow<D>) {
        let [scaled, height] = self.scaled_crossing(window);
        if scaled < (window.start - self.slack) * height || scaled > (window.end + self.slack) * height {
            return;
        }
        let [x, y] = self.at;
        let crossing = scaled / height;
        let entry = crossing.max(window.start).min(window.end);
        let (distance, from) = if entry == crossing {
            let along = x - window.x;
            (window.offset + (along * along + height * height).sqrt(), [window.x, -window.depth])
        } else {
            let along = x - entry;
            (window.distance(entry) + (along * along + y * y).sqrt(), [entry, 0.0])
        };
        if distance < self.distance {
            *self = Self { nearest: Some(index), distance, entry, from, ..*self };
        }
    }

    /// Sine and cosine, up to a common factor, of the angle at the apex between the side to the base's start and the
    /// path.
    pub(super) fn direction(&self) -> [f64; 2] {
        let [x, y] = self.at;
        let [dx, dy] = [self.from[0] - x, self.from[1] - y];
        [y * dx - x * dy, -(x * dx + y * dy)]
    }

    /// The ray from the pseudo-source of its window, along which the path leaves that window.
    pub(super) fn ray<D>(&self, window: &PathWindow<D>) -> [f64; 2] {
        let [x, y] = if self.from[1] < 0.0 { self.at } else { [self.entry, 0.0] };
        [x - window.x, y + window.depth]
    }
}
