//! Windows: what an edge sees of a source.

/// The part of an edge that a source lights through one strip of unfolded faces.
///
/// The edge lies on the x-axis from zero to its length, with the face about to be entered above it
/// and the strip below. A point `t` of the window is `offset + |(t, 0) - (x, -depth)|` from where
/// distances start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Window {
    pub(super) start: f64,
    pub(super) end: f64,
    /// Position of the unfolded source along the edge.
    pub(super) x: f64,
    /// How far the unfolded source lies below the edge; not negative.
    pub(super) depth: f64,
    /// Distance of the source itself, where paths bend on their way to it.
    pub(super) offset: f64,
    /// How many faces in a row were crossed around the same vertex: positive around the edge's
    /// start, negative around its end.
    pub(super) turn: i32,
}

impl Window {
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

    /// The window seen with the two ends of its edge, of the given length, exchanged.
    #[inline]
    pub(super) fn mirrored(&self, length: f64) -> Self {
        Self {
            start: length - self.end,
            end: length - self.start,
            x: length - self.x,
            turn: -self.turn,
            ..*self
        }
    }

    /// Cuts away the part that is nearer through the edge's start, a vertex at `distance`; `None`
    /// when that is all of it.
    ///
    /// Along the edge, the window's distance never grows faster than that from the vertex, so the part is
    /// an interval from the start; its end solves a linear equation.
    #[inline]
    pub(super) fn cut_start(&mut self, distance: f64) -> Cut {
        match cut_at(self.x, self.depth, distance - self.offset) {
            Some(at) if at <= self.start => Cut::Nothing,
            Some(at) if at < self.end => {
                self.start = at;
                Cut::Part
            }
            _ => Cut::All,
        }
    }

    /// The same from the other end of the edge, which has the given length.
    #[inline]
    pub(super) fn cut_end(&mut self, length: f64, distance: f64) -> Cut {
        match cut_at(length - self.x, self.depth, distance - self.offset) {
            Some(at) if length - at >= self.end => Cut::Nothing,
            Some(at) if length - at > self.start => {
                self.end = length - at;
                Cut::Part
            }
            _ => Cut::All,
        }
    }
}

/// What was cut off a window.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Cut {
    Nothing,
    Part,
    All,
}

/// Up to which point the origin, with a head start of `-lead`, is nearer than the source at
/// `(x, -depth)`; `None` when it is everywhere.
#[inline]
fn cut_at(x: f64, depth: f64, lead: f64) -> Option<f64> {
    let excess = x * x + depth * depth - lead * lead;
    if lead >= 0.0 && excess <= 0.0 {
        return Some(0.0);
    }
    let slope = lead + x;
    if slope > 0.0 { Some(excess / (2.0 * slope)) } else { None }
}

/// Where in `low..high` the distances of two windows are equal, if `left` is nearer at `low` and
/// `right` at `high`, by `gain` and `loss`.
///
/// With `r`, `s` the distances to the unfolded sources and `d` the difference of their offsets,
/// `r = s + d` squared is linear in the position but for `2 d s`; squared again it is quadratic.
pub(super) fn crossing(left: &Window, right: &Window, [low, high]: [f64; 2], [gain, loss]: [f64; 2]) -> f64 {
    let (p, q) = (left.x - low, right.x - low);
    let (rr, ss) = (p * p + left.depth * left.depth, q * q + right.depth * right.depth);
    let d = right.offset - left.offset;
    // slope * t + at_zero = 2 d s(t)
    let slope = 2.0 * (q - p);
    let at_zero = rr - ss - d * d;
    let dd = 4.0 * d * d;
    let (a, half_b, c) = (slope * slope - dd, slope * at_zero + dd * q, at_zero * at_zero - dd * ss);
    let width = high - low;
    let root = (half_b * half_b - a * c).max(0.0).sqrt();
    let big = if half_b > 0.0 { -(half_b + root) } else { root - half_b };
    let slack = 1e-9 * (slope * width).abs();
    let valid = |t: f64| (0.0..=width).contains(&t) && (slope * t + at_zero) * d >= -slack * d.abs();
    let t = [big / a, c / big].into_iter().find(|t| valid(*t));
    low + t.unwrap_or_else(|| (width * gain / (gain + loss)).max(0.0).min(width))
}
