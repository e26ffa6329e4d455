//! Faces laid out in the plane, and windows falling through them.

use super::faces::{Beyond, Surface, next};
use super::window::Window;

/// The face of a corner, laid out with its base `ab`, the edge opposite the corner, on the x-axis
/// from zero on and the corner `c` above.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    /// Length of `ab`.
    pub(super) base: f64,
    /// Where `c` is.
    pub(super) apex: [f64; 2],
    /// Lengths of `ac` and `bc`.
    pub(super) sides: [f64; 2],
    /// Direction of `ac` seen from `a`.
    from_a: [f64; 2],
    /// Direction of `bc` seen from `b`, mirrored: in the frame with `b` at zero.
    from_b: [f64; 2],
    /// `a`, `b`, `c`.
    pub(super) vertices: [u32; 3],
    /// What lies beyond `ac` and `bc`.
    pub(super) beyond: [Beyond; 2],
}

/// Up to where light falls onto a side.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Until {
    /// The ray at the end of the interval.
    Ray,
    /// The apex: the interval ends on the ray to it.
    Apex,
}

impl Frame {
    /// The face of a corner whose base has a length.
    #[inline]
    pub(super) fn new(surface: &Surface, corner: u32) -> Self {
        let face = surface.face(corner);
        let slot = corner as usize % 3;
        let (a, b) = (next(slot), next(next(slot)));
        // An edge is in the place of the corner opposite: `ac` in that of `b`.
        let (base, ac, bc) = (face.lengths[slot], face.lengths[b], face.lengths[a]);
        let per_base = 1.0 / base;
        let height = face.double_area * per_base;
        // The differences are exact on short sides, where the squares are not.
        let skew = (ac - bc) * (ac + bc) * per_base;
        let (from_a, from_b) = (0.5 * (base + skew), 0.5 * (base - skew));
        let (per_ac, per_bc) = (1.0 / ac, 1.0 / bc);
        Self {
            base,
            apex: [from_a, height],
            sides: [ac, bc],
            from_a: [from_a * per_ac, height * per_ac],
            from_b: [from_b * per_bc, height * per_bc],
            vertices: [face.vertices[a], face.vertices[b], face.vertices[slot]],
            beyond: [face.beyond[b], face.beyond[a]],
        }
    }

    /// The light of `window` between `start` and `end` of the base where it falls onto `ac`,
    /// measured from `a`; nothing is pushed when no width is left.
    #[inline]
    pub(super) fn cast_on_ac(
        &self,
        window: &Window,
        [start, end]: [f64; 2],
        until: Until,
        out: &mut Vec<Window>,
    ) {
        let source = [window.x, window.depth];
        let ([x, depth], [start, end]) = cast(self.from_a, self.sides[0], source, [start, end], until);
        if end > start {
            let turn = window.turn.max(0) + 1;
            out.push(Window { start, end, x, depth, offset: window.offset, turn });
        }
    }

    /// The same for `bc`, measured from `c`; here the apex is at the start of the interval.
    #[inline]
    pub(super) fn cast_on_cb(
        &self,
        window: &Window,
        [start, end]: [f64; 2],
        until: Until,
        out: &mut Vec<Window>,
    ) {
        let side = self.sides[1];
        let source = [self.base - window.x, window.depth];
        let mirrored = [self.base - end, self.base - start];
        let ([x, depth], [start, end]) = cast(self.from_b, side, source, mirrored, until);
        if end > start {
            let turn = window.turn.min(0) - 1;
            let (start, end, x) = (side - end, side - start, side - x);
            out.push(Window { start, end, x, depth, offset: window.offset, turn });
        }
    }
}

/// Position and depth of a source under the side of a face that leaves the origin in the direction
/// `(cos, sin)`, and where the rays from it through `start` and `end` of the base meet the side.
#[inline]
fn cast(
    [cos, sin]: [f64; 2],
    side: f64,
    [x, depth]: [f64; 2],
    [start, end]: [f64; 2],
    until: Until,
) -> ([f64; 2], [f64; 2]) {
    let below = x * sin + depth * cos;
    let meet = |t: f64| t * depth / (below - t * sin);
    let far = meet(end);
    // By rounding, a ray along the side may meet it beyond its end, behind its start or nowhere.
    let far = if until == Until::Ray && far >= 0.0 { far.min(side) } else { side };
    ([x * cos - depth * sin, below.max(0.0)], [meet(start).max(0.0), far])
}
