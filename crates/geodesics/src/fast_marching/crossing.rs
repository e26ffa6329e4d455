//! Windows that leave triangles, several at a time.

use super::triangles::{MarchTriangle, around};
use super::window::{COLLINEAR, NEAR_MISS, SourceWindow, TEST_POINTS};
use crate::plane::{PlanePoint, cross, dot, norm, sub};

/// Number of triangles solved together.
pub(super) const LANES: usize = 8;

type Lane = [f64; LANES];

/// Without a branch.
#[inline(always)]
fn select(condition: bool, yes: f64, no: f64) -> f64 {
    if condition { yes } else { no }
}

#[inline(always)]
fn select_point(condition: bool, yes: PlanePoint, no: PlanePoint) -> PlanePoint {
    [select(condition, yes[0], no[0]), select(condition, yes[1], no[1])]
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

/// Points in lanes.
#[derive(Debug, Clone, Copy, Default)]
struct PointLanes {
    x: Lane,
    y: Lane,
}

impl PointLanes {
    #[inline(always)]
    fn set(&mut self, lane: usize, [x, y]: PlanePoint) {
        self.x[lane] = x;
        self.y[lane] = y;
    }

    #[inline(always)]
    fn at(&self, lane: usize) -> PlanePoint {
        [self.x[lane], self.y[lane]]
    }
}

/// Windows in lanes.
#[derive(Debug, Clone, Copy, Default)]
struct WindowLanes {
    source: PointLanes,
    left: PointLanes,
    right: PointLanes,
    offset: Lane,
}

impl WindowLanes {
    #[inline(always)]
    fn set(&mut self, lane: usize, window: &SourceWindow) {
        self.source.set(lane, window.source);
        self.left.set(lane, window.limits[0]);
        self.right.set(lane, window.limits[1]);
        self.offset[lane] = window.offset;
    }

    #[inline(always)]
    fn at(&self, lane: usize) -> SourceWindow {
        let limits = [self.left.at(lane), self.right.at(lane)];
        SourceWindow { source: self.source.at(lane), limits, offset: self.offset[lane] }
    }
}

/// Triangles in lanes, each with one of its sides, by the corner opposite.
#[derive(Debug, Clone, Copy, Default)]
struct TriangleLanes {
    base: Lane,
    apex: PointLanes,
    corner: Lane,
}

impl TriangleLanes {
    #[inline(always)]
    fn set(&mut self, lane: usize, triangle: &MarchTriangle, corner: usize) {
        self.base[lane] = triangle.base();
        self.apex.set(lane, triangle.apex);
        self.corner[lane] = corner as f64;
    }

    /// The left and right end of the side and the corner opposite.
    #[inline(always)]
    fn at(&self, lane: usize) -> [PlanePoint; 3] {
        let (base, [x, y]) = (self.base[lane], self.apex.at(lane));
        let is = |corner: f64| self.corner[lane] == corner;
        [
            [select(is(0.0), base, select(is(1.0), x, 0.0)), select(is(1.0), y, 0.0)],
            [select(is(0.0), x, select(is(2.0), base, 0.0)), select(is(0.0), y, 0.0)],
            [select(is(1.0), base, select(is(2.0), x, 0.0)), select(is(2.0), y, 0.0)],
        ]
    }
}

/// What is behind one of the two sides through which a window leaves.
#[derive(Debug, Clone, Copy, Default)]
struct Exit {
    triangle: TriangleLanes,
    /// The window behind the side, and the distance of the centroid of the triangle there.
    window: WindowLanes,
    distance: Lane,
}

/// Triangles that windows leave through two sides, in lanes: each quantity of all of them side by side, as vector
/// instructions need it.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Crossings {
    window: WindowLanes,
    triangle: TriangleLanes,
    /// The distances of the left and the right end of the entry.
    known: [Lane; 2],
    /// Whether shortest paths may bend: at the left end of the entry, at the right one, and at the corner opposite.
    bends: [Lane; 3],
    /// On the left and on the right.
    exits: [Exit; 2],
    /// The distance of the corner opposite the entry.
    distance: Lane,
}

/// The rays from a virtual source to the ends of a side and to the corner behind it.
#[derive(Clone, Copy)]
struct Rays {
    ends: [PlanePoint; 2],
    apex: PlanePoint,
}

/// How a window goes on behind a side.
struct Behind {
    distance: f64,
    /// Where the virtual source moves, and by how much its distance grows.
    moved: PlanePoint,
    grown: f64,
    limits: [PlanePoint; 2],
}

impl Rays {
    /// Continues a window with the given limits, which narrow to the ends of the side where paths may bend. Towards a
    /// source that lies behind the side, they turn around its first or second end.
    #[inline(always)]
    fn cross(
        self,
        [left, right]: [PlanePoint; 2],
        bends: [bool; 2],
        offset: f64,
        pivots_right: bool,
    ) -> Behind {
        let Self { ends: [start, end], apex } = self;
        let base = sub(end, start);
        let third = 1.0 / 3.0;
        let ray = [(start[0] + end[0] + apex[0]) * third, (start[1] + end[1] + apex[1]) * third];
        let is_behind = cross(end, start) <= COLLINEAR * (dot(start, base).abs() + dot(base, base));
        // On the left, an end that is to the right of the limit is a new limit, and the reverse.
        let left = select_point(bends[0] & below_or_nan(cross(left, start), 0.0), start, left);
        let right = select_point(bends[1] & below_or_nan(0.0, cross(right, end)), end, right);
        // Negative in the shadow.
        let [at_left, at_right] = [cross(ray, left), -cross(ray, right)];
        let [in_left, in_right] = shadows(at_left, at_right);
        let shade = |to: PlanePoint, sign: f64, at: f64| {
            let [p, q, r] = [sign * cross(start, to), sign * cross(end, to), sign * cross(apex, to)];
            let most = select(p > q, p, q);
            let most = select(most > r, most, r);
            at + TEST_POINTS * (most - at) <= 0.0
        };
        let leaves_left = shade(left, 1.0, at_left);
        let leaves_right = shade(right, -1.0, at_right);
        // A ray through an end may bend there or not; it must not bend because of rounding. Nor need it if it passes close
        // to an end where no shortest path bends.
        let slack = COLLINEAR * dot(ray, ray);
        let (at_start, at_end) = (cross(ray, start), cross(ray, end));
        let near = NEAR_MISS * (at_start - at_end);
        let misses_left = at_start < -select(bends[0], slack, near);
        let misses_right = at_end > select(bends[1], slack, near);
        // Where the path to the centroid bends, from the source.
        let is_end = is_behind | (!in_left & !in_right & (misses_left | misses_right));
        let is_right = (is_behind & pivots_right) | (!is_behind & !misses_left);
        let limit = select_point(in_left, left, select_point(in_right, right, [0.0; 2]));
        let bend = select_point(is_end, select_point(is_right, end, start), limit);
        let before = norm(bend);
        let is_new = is_end | (in_left & leaves_left) | (in_right & leaves_right);
        let none = [f64::NAN; 2];
        Behind {
            distance: offset + before + norm(sub(ray, bend)),
            moved: select_point(is_new, bend, [0.0; 2]),
            grown: select(is_new, before, 0.0),
            limits: [select_point(is_new, none, left), select_point(is_new, none, right)],
        }
    }
}

impl Crossings {
    /// A window, and the triangle that it entered through the side opposite `corner`.
    #[inline(always)]
    pub(super) fn set(
        &mut self,
        lane: usize,
        window: &SourceWindow,
        triangle: &MarchTriangle,
        corner: usize,
    ) {
        self.window.set(lane, window);
        self.triangle.set(lane, triangle, corner);
        let [left, right] = around(corner);
        for (bends, slot) in self.bends.iter_mut().zip([left, right, corner]) {
            bends[lane] = f64::from(triangle.bends_at(slot));
        }
    }

    /// The distances known of the left and the right end of the entry.
    #[inline(always)]
    pub(super) fn set_known(&mut self, lane: usize, [left, right]: [f64; 2]) {
        self.known[0][lane] = left;
        self.known[1][lane] = right;
    }

    /// The triangle behind the exit on the left (0) or right (1), with the corner opposite that side.
    #[inline(always)]
    pub(super) fn set_exit(&mut self, lane: usize, exit: usize, triangle: &MarchTriangle, corner: usize) {
        self.exits[exit].triangle.set(lane, triangle, corner);
    }

    /// The distance of the corner opposite the entry.
    #[inline(always)]
    pub(super) fn apex_distance(&self, lane: usize) -> f64 {
        self.distance[lane]
    }

    /// The distance of the centroid behind an exit.
    #[inline(always)]
    pub(super) fn distance(&self, lane: usize, exit: usize) -> f64 {
        self.exits[exit].distance[lane]
    }

    /// The window behind an exit.
    #[inline(always)]
    pub(super) fn window(&self, lane: usize, exit: usize) -> SourceWindow {
        self.exits[exit].window.at(lane)
    }

    /// Without branches, so that the same instructions solve all lanes.
    #[inline(always)]
    fn solve(&mut self) {
        let mut rays = [PointLanes::default(); 3];
        for i in 0..LANES {
            let SourceWindow { source, limits: [left, right], offset } = self.window.at(i);
            let corners = self.triangle.at(i);
            let [to_left, to_right, to_apex] =
                [sub(corners[0], source), sub(corners[1], source), sub(corners[2], source)];
            // The corner opposite. Rays that miss the entry go along it.
            let [in_left, in_right] = shadows(cross(to_apex, left), -cross(to_apex, right));
            let (misses_left, misses_right) = (cross(to_apex, to_left) < 0.0, cross(to_apex, to_right) > 0.0);
            let end = select_point(misses_left, to_left, select_point(misses_right, to_right, [0.0; 2]));
            let bend = select_point(in_left, left, select_point(in_right, right, end));
            let through = offset + norm(bend) + norm(sub(to_apex, bend));
            // Along the sides.
            let at_left = self.known[0][i] + norm(sub(to_apex, to_left));
            let at_right = self.known[1][i] + norm(sub(to_apex, to_right));
            let along = select(at_left < at_right, at_left, at_right);
            self.distance[i] = select(along < through, along, through);
            rays[0].set(i, to_left);
            rays[1].set(i, to_apex);
            rays[2].set(i, to_right);
        }
        let [left, right] = &mut self.exits;
        left.solve(&self.window, [&rays[0], &rays[1]], [&self.bends[0], &self.bends[2]], false);
        right.solve(&self.window, [&rays[1], &rays[2]], [&self.bends[2], &self.bends[1]], true);
    }
}

impl Exit {
    /// Without branches, so that the same instructions solve all lanes.
    #[inline(always)]
    fn solve(&mut self, own: &WindowLanes, ends: [&PointLanes; 2], bends: [&Lane; 2], pivots_right: bool) {
        let Self { triangle, window, distance } = self;
        for i in 0..LANES {
            let [start, end, apex] = triangle.at(i);
            let ends = [ends[0].at(i), ends[1].at(i)];
            let bends = [bends[0][i] > 0.0, bends[1][i] > 0.0];
            let SourceWindow { limits, offset, .. } = own.at(i);
            let (along, along_own) = (sub(end, start), sub(ends[1], ends[0]));
            let scale = 1.0 / dot(along, along);
            // The rotation from the triangle behind into this one.
            let [cos, sin] = [dot(along, along_own) * scale, cross(along, along_own) * scale];
            let [x, y] = sub(apex, start);
            let apex = [ends[0][0] + (cos * x - sin * y), ends[0][1] + (sin * x + cos * y)];
            let behind = Rays { ends, apex }.cross(limits, bends, offset, pivots_right);
            let back = |[x, y]: PlanePoint| [cos * x + sin * y, cos * y - sin * x];
            let [x, y] = back(sub(behind.moved, ends[0]));
            window.source.set(i, [start[0] + x, start[1] + y]);
            window.left.set(i, back(behind.limits[0]));
            window.right.set(i, back(behind.limits[1]));
            window.offset[i] = offset + behind.grown;
            distance[i] = behind.distance;
        }
    }
}

/// Solves crossings with the widest instructions of the processor. Not a closure, which need not be inlined into them.
pub(super) struct SolveCrossings<'a>(pub(super) &'a mut Crossings);

impl pulp::NullaryFnOnce for SolveCrossings<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.0.solve();
    }
}
