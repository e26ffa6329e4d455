//! Faces laid out in the plane, and windows propagated across them.

use surface::CornerId;

use super::bearing::Bearing;
use super::faces::{Beyond, Faces, next};
use super::window::PathWindow;

/// The face of a corner, laid out with its base `ab`, the side opposite the corner, on the x-axis from zero, and the
/// corner `c` above.
#[derive(Debug, Clone, Copy)]
pub(super) struct FaceFrame {
    /// Length of `ab`.
    pub(super) base: f64,
    /// Position of `c`.
    pub(super) apex: [f64; 2],
    /// Lengths of `ac` and `bc`.
    pub(super) sides: [f64; 2],
    /// Direction of `ac` from `a`.
    from_a: [f64; 2],
    /// Direction of `bc` from `b`, mirrored: in the frame with `b` at zero.
    from_b: [f64; 2],
    /// `a`, `b`, `c`.
    pub(super) vertices: [u32; 3],
    /// What lies beyond `ac` and `bc`.
    pub(super) beyond: [Beyond; 2],
}

/// Where the part of a side that a window reaches ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Until {
    /// At the ray through the end of the interval.
    Ray,
    /// At the apex: the interval ends on the ray to it.
    Apex,
}

impl FaceFrame {
    /// The face of a corner whose base has a length.
    ///
    /// Does not use [`surface::Triangle`]: the area is known, which saves a square root in the innermost loop.
    #[inline]
    pub(super) fn new(faces: &Faces, corner: CornerId) -> Self {
        let (face, slot) = (faces.of(corner.face()), corner.slot());
        let (a, b) = (next(slot), next(next(slot)));
        // A side is in the place of the corner opposite: `ac` in that of `b`.
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

    /// Appends the part of `ac` that the rays of `window` between `start` and `end` of the base reach, measured from
    /// `a`, unless it has no width.
    #[inline]
    pub(super) fn project_on_ac<D: Bearing>(
        &self,
        window: &PathWindow<D>,
        [start, end]: [f64; 2],
        until: Until,
        out: &mut Vec<PathWindow<D>>,
    ) {
        let source = [window.x, window.depth];
        let ([x, depth], [start, end]) = project(self.from_a, self.sides[0], source, [start, end], until);
        if end > start {
            let (turn, bearing) = (window.turn.max(0) + 1, window.bearing.turned(self.from_a));
            out.push(PathWindow { start, end, x, depth, offset: window.offset, turn, bearing });
        }
    }

    /// As [`project_on_ac`](Self::project_on_ac), for `bc`, measured from `c`: the apex is at its start.
    #[inline]
    pub(super) fn project_on_cb<D: Bearing>(
        &self,
        window: &PathWindow<D>,
        [start, end]: [f64; 2],
        until: Until,
        out: &mut Vec<PathWindow<D>>,
    ) {
        let side = self.sides[1];
        let source = [self.base - window.x, window.depth];
        let mirrored = [self.base - end, self.base - start];
        let ([x, depth], [start, end]) = project(self.from_b, side, source, mirrored, until);
        if end > start {
            let turn = window.turn.min(0) - 1;
            let bearing = window.bearing.mirrored().turned(self.from_b).mirrored();
            let (start, end, x) = (side - end, side - start, side - x);
            out.push(PathWindow { start, end, x, depth, offset: window.offset, turn, bearing });
        }
    }
}

/// Position and depth of a source below the side of a face that leaves the origin in the direction `(cos, sin)`, and
/// where the rays from it through `start` and `end` of the base meet the side.
#[inline]
fn project(
    [cos, sin]: [f64; 2],
    side: f64,
    [x, depth]: [f64; 2],
    [start, end]: [f64; 2],
    until: Until,
) -> ([f64; 2], [f64; 2]) {
    let below = x * sin + depth * cos;
    let meet = |t: f64| t * depth / (below - t * sin);
    let far = meet(end);
    // Rounding may let a ray along the side meet it beyond its end, before its start or nowhere.
    let far = if until == Until::Ray && far >= 0.0 { far.min(side) } else { side };
    ([x * cos - depth * sin, below.max(0.0)], [meet(start).max(0.0), far])
}
