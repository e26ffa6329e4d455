//! Windows that cross a side from one triangle to the next, several at a time.

use super::window::{COLLINEAR, SourceWindow, TEST_POINTS};
use crate::plane::{cross, norm};

/// Number of crossings solved together.
pub(super) const LANES: usize = 8;

type Lane = [f64; LANES];

/// The lengths of a triangle that is seen through one of its sides, and twice its area.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sides {
    pub(super) base: f64,
    pub(super) from_left: f64,
    pub(super) from_right: f64,
    pub(super) double_area: f64,
}

impl Sides {
    /// The corner opposite the side, above the side.
    #[inline(always)]
    pub(super) fn apex(self) -> [f64; 2] {
        let Self { base, from_left, from_right, double_area } = self;
        let scale = 1.0 / base;
        [0.5 * (base + (from_left - from_right) * ((from_left + from_right) * scale)), double_area * scale]
    }
}

/// The lengths of triangles in lanes.
#[derive(Debug, Clone, Copy, Default)]
struct SideLanes {
    base: Lane,
    from_left: Lane,
    from_right: Lane,
    double_area: Lane,
}

impl SideLanes {
    #[inline]
    fn set(&mut self, lane: usize, sides: Sides) {
        self.base[lane] = sides.base;
        self.from_left[lane] = sides.from_left;
        self.from_right[lane] = sides.from_right;
        self.double_area[lane] = sides.double_area;
    }

    #[inline(always)]
    fn apex(&self, i: usize) -> [f64; 2] {
        let (base, double_area) = (self.base[i], self.double_area[i]);
        Sides { base, from_left: self.from_left[i], from_right: self.from_right[i], double_area }.apex()
    }
}

/// Windows in lanes.
#[derive(Debug, Clone, Copy, Default)]
struct WindowLanes {
    source: [Lane; 2],
    left: [Lane; 2],
    right: [Lane; 2],
    offset: Lane,
}

impl WindowLanes {
    #[inline]
    fn set(&mut self, lane: usize, window: &SourceWindow) {
        for axis in 0..2 {
            self.source[axis][lane] = window.source[axis];
            self.left[axis][lane] = window.limits[0][axis];
            self.right[axis][lane] = window.limits[1][axis];
        }
        self.offset[lane] = window.offset;
    }
}

/// A window that leaves a triangle through a side.
#[derive(Debug, Clone, Copy)]
pub(super) struct Crossing<'a> {
    pub(super) window: &'a SourceWindow,
    /// The triangle that is left, as seen through its entry.
    pub(super) from: Sides,
    /// Whether the side is on the right of the entry or on the left.
    pub(super) is_right: bool,
    /// The triangle that is entered.
    pub(super) to: Sides,
    /// Whether shortest paths may bend at the left and at the right end of the side.
    pub(super) bends: [bool; 2],
    /// The number of the entry.
    pub(super) entry: u32,
}

/// Crossings in lanes: each quantity of all of them side by side, as vector instructions need it.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Crossings {
    /// The window before and after.
    window: WindowLanes,
    /// The triangle that is left, whether on its right, and the one that is entered.
    from: SideLanes,
    is_right: Lane,
    to: SideLanes,
    /// Whether shortest paths may bend at the left and right end of the side: 1 or 0.
    bends: [Lane; 2],
    /// The distance of the centroid of the triangle that is entered.
    distance: Lane,
    pub(super) entry: [u32; LANES],
}

/// Without a branch.
#[inline(always)]
fn select(condition: bool, yes: f64, no: f64) -> f64 {
    if condition { yes } else { no }
}

/// Whether a number is below another, or there is no limit to compare with.
#[inline(always)]
fn below_or_nan(a: f64, b: f64) -> bool {
    (a < b) | a.is_nan() | b.is_nan()
}

/// Whether a point is in the shadow of the left and of the right limit, from products that are negative there. If it is
/// in both, the deeper one counts.
#[inline(always)]
fn shadows(at_left: f64, at_right: f64) -> [bool; 2] {
    let in_left = (at_left < 0.0) & (below_or_nan(at_left, at_right) | (at_left == at_right));
    [in_left, (at_right < 0.0) & !in_left]
}

impl Crossings {
    #[inline]
    pub(super) fn set(&mut self, lane: usize, crossing: Crossing<'_>) {
        let Crossing { window, from, is_right, to, bends, entry } = crossing;
        self.window.set(lane, window);
        self.bends[0][lane] = f64::from(bends[0]);
        self.bends[1][lane] = f64::from(bends[1]);
        self.from.set(lane, from);
        self.is_right[lane] = f64::from(is_right);
        self.to.set(lane, to);
        self.entry[lane] = entry;
    }

    /// The distance of the centroid behind the side.
    #[inline]
    pub(super) fn distance(&self, lane: usize) -> f64 {
        self.distance[lane]
    }

    /// The window behind the side.
    #[inline]
    pub(super) fn window(&self, lane: usize) -> SourceWindow {
        let at = |point: &[Lane; 2]| [point[0][lane], point[1][lane]];
        let WindowLanes { source, left, right, offset } = &self.window;
        SourceWindow { source: at(source), limits: [at(left), at(right)], offset: offset[lane] }
    }

    /// Without branches, so that the same instructions solve all lanes.
    #[inline(always)]
    pub(super) fn solve(&mut self) {
        for i in 0..LANES {
            let [ax, ay] = self.from.apex(i);
            let is_right = self.is_right[i] > 0.0;
            let (from_base, base) = (self.from.base[i], self.to.base[i]);
            let start = [select(is_right, ax, 0.0), select(is_right, ay, 0.0)];
            let scale = 1.0 / base;
            let ux = select(is_right, from_base - ax, ax) * scale;
            let uy = select(is_right, -ay, ay) * scale;
            let turned = |point: &[Lane; 2]| {
                let [x, y] = [point[0][i] - start[0], point[1][i] - start[1]];
                [x * ux + y * uy, ux * y - uy * x]
            };
            let source = turned(&self.window.source);
            let [mut left, mut right] = [turned(&self.window.left), turned(&self.window.right)];
            let [bx, by] = self.to.apex(i);
            let target = [(base + bx) * (1.0 / 3.0), by * (1.0 / 3.0)];
            let from_source = |p: [f64; 2]| [p[0] - source[0], p[1] - source[1]];
            let is_behind = source[1] >= -COLLINEAR * (source[0].abs() + base);
            let ends = [from_source([0.0, 0.0]), from_source([base, 0.0])];
            let (ray, apex) = (from_source(target), from_source([bx, by]));
            // On the left, an end that is to the right of the limit is a new limit, and the reverse.
            let narrows_left =
                (self.bends[0][i] > 0.0) & below_or_nan(cross(from_source(left), ends[0]), 0.0);
            let narrows_right =
                (self.bends[1][i] > 0.0) & below_or_nan(0.0, cross(from_source(right), ends[1]));
            left = [select(narrows_left, 0.0, left[0]), select(narrows_left, 0.0, left[1])];
            right = [select(narrows_right, base, right[0]), select(narrows_right, 0.0, right[1])];
            let (to_left, to_right) = (from_source(left), from_source(right));
            // Negative in the shadow.
            let [at_left, at_right] = [cross(ray, to_left), -cross(ray, to_right)];
            let [in_left, in_right] = shadows(at_left, at_right);
            let shade = |to: [f64; 2], sign: f64, at: f64| {
                let [p, q, r] = [ends[0], ends[1], apex].map(|corner| sign * cross(corner, to));
                let most = select(p > q, p, q);
                let most = select(most > r, most, r);
                at + TEST_POINTS * (most - at) <= 0.0
            };
            let leaves_left = shade(to_left, 1.0, at_left);
            let leaves_right = shade(to_right, -1.0, at_right);
            // A ray through an end may bend there or not; it must not bend because of rounding.
            let slack = COLLINEAR * (ray[0] * ray[0] + ray[1] * ray[1]);
            let (misses_left, misses_right) = (cross(ray, ends[0]) < -slack, cross(ray, ends[1]) > slack);
            let via = [ends[0], ends[1]].map(|end| norm(end) + norm([ray[0] - end[0], ray[1] - end[1]]));
            // Where the path to the centroid bends, from the source.
            let is_end = is_behind | (!in_left & !in_right & (misses_left | misses_right));
            let is_second = select(is_behind, via[0] - via[1], select(misses_left, -1.0, 1.0)) > 0.0;
            let pick = |axis: usize| {
                let end = select(is_second, ends[1][axis], ends[0][axis]);
                let limit = select(in_left, to_left[axis], select(in_right, to_right[axis], 0.0));
                select(is_end, end, limit)
            };
            let bend = [pick(0), pick(1)];
            let before = norm(bend);
            self.distance[i] = self.window.offset[i] + before + norm([ray[0] - bend[0], ray[1] - bend[1]]);
            let is_new = is_end | (in_left & leaves_left) | (in_right & leaves_right);
            for axis in 0..2 {
                self.window.source[axis][i] = source[axis] + select(is_new, bend[axis], 0.0);
                self.window.left[axis][i] = select(is_new, f64::NAN, left[axis]);
                self.window.right[axis][i] = select(is_new, f64::NAN, right[axis]);
            }
            self.window.offset[i] += select(is_new, before, 0.0);
        }
    }
}

/// Windows and the distances of the vertices of their triangles, in lanes.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Views {
    window: WindowLanes,
    sides: SideLanes,
    /// At the left and right end of the entry and at the apex.
    distances: [Lane; 3],
}

impl Views {
    #[inline]
    pub(super) fn set(&mut self, lane: usize, window: &SourceWindow, sides: Sides, is_reached: bool) {
        self.window.set(lane, window);
        if !is_reached {
            self.window.offset[lane] = f64::INFINITY;
        }
        self.sides.set(lane, sides);
    }

    #[inline]
    pub(super) fn distances(&self, lane: usize) -> [f64; 3] {
        [0, 1, 2].map(|corner| self.distances[corner][lane])
    }

    /// Without branches, so that the same instructions solve all lanes.
    #[inline(always)]
    pub(super) fn solve(&mut self) {
        for i in 0..LANES {
            let WindowLanes { source, left, right, offset } = &self.window;
            let from_source = |x: f64, y: f64| [x - source[0][i], y - source[1][i]];
            let left = from_source(left[0][i], left[1][i]);
            let right = from_source(right[0][i], right[1][i]);
            let [x, y] = self.sides.apex(i);
            let ends = [from_source(0.0, 0.0), from_source(self.sides.base[i], 0.0)];
            for (corner, ray) in [ends[0], ends[1], from_source(x, y)].into_iter().enumerate() {
                let [at_left, at_right] = [cross(ray, left), -cross(ray, right)];
                let [in_left, in_right] = shadows(at_left, at_right);
                // Rays that miss the entry go along it.
                let misses_left = (corner == 2) & (cross(ray, ends[0]) < 0.0);
                let misses_right = (corner == 2) & (cross(ray, ends[1]) > 0.0);
                let bend = [0, 1].map(|axis| {
                    let end = select(misses_left, ends[0][axis], select(misses_right, ends[1][axis], 0.0));
                    select(in_left, left[axis], select(in_right, right[axis], end))
                });
                let rest = norm([ray[0] - bend[0], ray[1] - bend[1]]);
                self.distances[corner][i] = offset[i] + norm(bend) + rest;
            }
        }
    }
}
