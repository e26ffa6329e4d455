//! Windows that leave triangles, several at a time.
//!
//! ```text
//!                     apex          Rays from the virtual source S, here the origin, enter the triangle through one of its
//!                     /\            sides, the entry, between two limits (dotted). They leave through the other two, the
//!      exit on the   /  \           exits on the left and on the right. Behind an exit is another triangle; the distance of
//!      left    ....,/    \          its centroid tells whether it takes the window.
//!                 /:      \
//!           left /_:______.\ right  Where no ray leads, the path bends: at a limit, in its shadow, or at an end of the exit
//!         known[0]  :    .   known[1]   that the straight line to the centroid misses. There is the next virtual source.
//!                   :   .
//!                    : .            The apex is reached through the entry, or along a side from one of its ends.
//!                     S
//! ```
//!
//! A triangle knows one virtual source, but not the triangles that its rays crossed before: behind a hole they may have left the
//! surface. The ends of the entry show it, since they are then farther than the window tells. So the source moves to where it
//! [agrees](agreeing) with both.

use surface::{CornerId, VertexId};

use super::triangles::MarchTriangle;
use super::window::{
    COLLINEAR, DISAGREEMENT, NEAR_MISS, SourceWindow, below_or_nan, bend_at_limit, select, select_point,
    shadows,
};
use crate::plane::{GateSide, PlanePoint, around, beyond, cross, dot, norm, sub};

/// Number of crossings solved together.
pub(super) const LANES: usize = 8;

/// A number of every crossing.
type Lane = [f64; LANES];

/// Numbers of every crossing, each of them of all crossings side by side, as vector instructions need it.
#[derive(Debug, Clone, Copy)]
struct Lanes<const N: usize>([Lane; N]);

impl<const N: usize> Default for Lanes<N> {
    fn default() -> Self {
        Self([[0.0; LANES]; N])
    }
}

impl<const N: usize> Lanes<N> {
    #[inline(always)]
    fn set(&mut self, lane: usize, numbers: [f64; N]) {
        for (all, number) in self.0.iter_mut().zip(numbers) {
            all[lane] = number;
        }
    }

    #[inline(always)]
    fn at(&self, lane: usize) -> [f64; N] {
        std::array::from_fn(|i| self.0[i][lane])
    }
}

/// A window that leaves a triangle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Crossing<'t> {
    pub(super) window: SourceWindow,
    pub(super) triangle: &'t MarchTriangle,
    /// The corner opposite the entry.
    pub(super) entry: usize,
    /// The distances known of the left and the right end of the entry.
    pub(super) known: [f64; 2],
    /// The distance of the centroid.
    pub(super) distance: f64,
    /// What is behind the exits on the left and on the right, if the window goes there: a triangle and its corner opposite.
    pub(super) behind: [Option<(CornerId, &'t MarchTriangle)>; 2],
}

/// Behind one of the two exits.
#[derive(Debug, Clone, Copy, Default)]
struct ExitLanes {
    /// The base and the apex of the triangle, and its corner opposite the exit.
    triangle: Lanes<4>,
    /// The window, and the distance of the centroid.
    window: Lanes<7>,
    distance: Lane,
    /// The corner opposite the exit, if there is a triangle.
    corner: [Option<CornerId>; LANES],
    /// Whether the triangle lies the other way round, and is crossed in a mirror.
    is_mirrored: [bool; LANES],
}

/// Crossings that are solved together, with all that they lead to.
#[derive(Debug, Default)]
pub(super) struct Crossings {
    len: usize,
    window: Lanes<7>,
    /// The base and the apex of the triangle, and its corner opposite the entry.
    triangle: Lanes<4>,
    known: Lanes<2>,
    /// The distance of the centroid, and by how much the window may tell the ends of the entry to be nearer than known.
    trust: Lanes<2>,
    /// That, as a share of the entry.
    disagreement: f64,
    /// Whether shortest paths may bend: at the left end of the entry, at the right one, and at the apex.
    bends: Lanes<3>,
    exits: [ExitLanes; 2],
    /// The apex, and its distance.
    apex: [VertexId; LANES],
    distance: Lane,
    instructions: pulp::Arch,
}

impl Crossings {
    /// Prepares for a surface. Where no path bends, no ray meets the end of the surface, and distances are exact in the plane.
    pub(super) fn reset(&mut self, may_bend: bool) {
        self.len = 0;
        self.disagreement = if may_bend { DISAGREEMENT } else { f64::INFINITY };
    }

    /// Adds a crossing; returns whether there is no room for another.
    #[inline(always)]
    pub(super) fn push(&mut self, crossing: &Crossing<'_>) -> bool {
        let (lane, Crossing { triangle, entry, .. }) = (self.len, *crossing);
        let [left, right] = around(entry);
        self.window.set(lane, crossing.window.numbers());
        self.triangle.set(lane, triangle.numbers(entry));
        self.known.set(lane, crossing.known);
        self.trust.set(lane, [crossing.distance, self.disagreement * triangle.lengths[entry]]);
        self.bends.set(lane, [left, right, entry].map(|slot| f64::from(triangle.bends_at(slot))));
        self.apex[lane] = triangle.vertex(entry);
        for ((exit, side), behind) in self.exits.iter_mut().zip([right, left]).zip(crossing.behind) {
            exit.corner[lane] = behind.map(|(corner, _)| corner);
            if let Some((corner, other)) = behind {
                let slot = corner.slot();
                let is_mirrored = triangle.vertex(around(side)[1]) != other.vertex(around(slot)[0]);
                exit.is_mirrored[lane] = is_mirrored;
                exit.triangle.set(
                    lane,
                    if is_mirrored { other.mirrored().numbers([1, 0, 2][slot]) } else { other.numbers(slot) },
                );
            }
        }
        self.len += 1;
        self.len == LANES
    }

    /// Solves and removes the crossings. Returns their number: what they lead to is at the lanes from zero.
    #[inline(always)]
    pub(super) fn solve(&mut self) -> usize {
        let instructions = self.instructions;
        instructions.dispatch(SolveCrossings(self));
        std::mem::take(&mut self.len)
    }

    /// The corner opposite the entry and its distance.
    #[inline(always)]
    pub(super) fn apex(&self, lane: usize) -> (VertexId, f64) {
        (self.apex[lane], self.distance[lane])
    }

    /// The corner opposite the exit on the left (0) or right (1) and the distance of the centroid behind it.
    #[inline(always)]
    pub(super) fn behind(&self, lane: usize, exit: usize) -> Option<(CornerId, f64)> {
        self.exits[exit].corner[lane].map(|corner| (corner, self.exits[exit].distance[lane]))
    }

    /// The window behind an exit.
    #[inline(always)]
    pub(super) fn window(&self, lane: usize, exit: usize) -> SourceWindow {
        let exit = &self.exits[exit];
        let window = SourceWindow::of(exit.window.at(lane));
        if exit.is_mirrored[lane] { window.mirrored(exit.triangle.at(lane)[0]) } else { window }
    }

    /// Without branches, so that the same instructions solve all lanes.
    #[inline(always)]
    fn solve_lanes(&mut self) {
        let mut is_early = [0.0; LANES];
        for (i, is_early) in is_early.iter_mut().enumerate() {
            let window = SourceWindow::of(self.window.at(i));
            let [left, right, _] = seen_from_entry(self.triangle.at(i));
            let ([at_left, at_right], [own, slack]) = (self.known.at(i), self.trust.at(i));
            let left = (window.distance(left) + slack < at_left) & (at_left < own);
            let right = (window.distance(right) + slack < at_right) & (at_right < own);
            *is_early = select(left | right, 1.0, 0.0);
        }
        for (i, _) in is_early.into_iter().enumerate().filter(|(_, is_early)| *is_early > 0.0) {
            let [left, right, _] = seen_from_entry(self.triangle.at(i));
            let window = agreeing(SourceWindow::of(self.window.at(i)), [left, right], self.known.at(i));
            self.window.set(i, window.numbers());
        }
        let mut rays = [Lanes::default(); 3];
        for i in 0..LANES {
            let [left, right, apex] = seen_from_entry(self.triangle.at(i));
            let known = self.known.at(i);
            let SourceWindow { source, limits, offset } = SourceWindow::of(self.window.at(i));
            let [to_left, to_right, to_apex] = [left, right, apex].map(|at| sub(at, source));
            let bend = bend_at_limit(to_apex, limits);
            let misses = (cross(to_apex, to_left) < 0.0) | (cross(to_apex, to_right) > 0.0);
            let through = offset + norm(bend) + norm(sub(to_apex, bend));
            let at_left = known[0] + norm(sub(apex, left));
            let at_right = known[1] + norm(sub(apex, right));
            let along = select(at_left < at_right, at_left, at_right);
            self.distance[i] = select((along < through) | misses, along, through);
            rays[0].set(i, to_left);
            rays[1].set(i, to_apex);
            rays[2].set(i, to_right);
        }
        let [left, right] = &mut self.exits;
        let [bends_left, bends_right, bends_apex] = &self.bends.0;
        let [at_left, at_right] = &self.known.0;
        let (window, at_apex) = (&self.window, &self.distance);
        left.solve_lanes(window, [&rays[0], &rays[1]], [at_apex, at_left], [bends_left, bends_apex], false);
        right.solve_lanes(window, [&rays[1], &rays[2]], [at_apex, at_right], [bends_apex, bends_right], true);
    }
}

impl ExitLanes {
    /// The rays to the `ends` of the exit, one of which is the apex, go on behind it. Without branches.
    #[inline(always)]
    fn solve_lanes(
        &mut self,
        own: &Lanes<7>,
        ends: [&Lanes<2>; 2],
        known: [&Lane; 2],
        bends: [&Lane; 2],
        pivots_right: bool,
    ) {
        for i in 0..LANES {
            let [start, end, apex] = seen_from_entry(self.triangle.at(i));
            let (ends, bends) = (ends.map(|end| end.at(i)), bends.map(|lane| lane[i] > 0.0));
            let SourceWindow { limits, offset, .. } = SourceWindow::of(own.at(i));
            let (along, along_own) = (sub(end, start), sub(ends[1], ends[0]));
            let scale = 1.0 / dot(along, along);
            // The rotation from the triangle behind into this one.
            let [cos, sin] = [dot(along, along_own) * scale, cross(along, along_own) * scale];
            let [x, y] = sub(apex, start);
            let apex = [ends[0][0] + (cos * x - sin * y), ends[0][1] + (sin * x + cos * y)];
            let known = known.map(|lane| lane[i]);
            let (distance, window) = Rays { ends, known, apex }.cross(limits, bends, offset, pivots_right);
            let back = |[x, y]: PlanePoint| [cos * x + sin * y, cos * y - sin * x];
            let [x, y] = back(sub(window.source, ends[0]));
            let source = [start[0] + x, start[1] + y];
            let window = SourceWindow { source, limits: window.limits.map(back), ..window };
            self.window.set(i, window.numbers());
            self.distance[i] = distance;
        }
    }
}

/// Solves crossings with the widest instructions of the processor. Not a closure, which need not be inlined into them.
struct SolveCrossings<'a>(&'a mut Crossings);

impl pulp::NullaryFnOnce for SolveCrossings<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.0.solve_lanes();
    }
}

/// The left and right end of the entry and the corner opposite.
#[inline(always)]
fn seen_from_entry([base, x, y, entry]: [f64; 4]) -> [PlanePoint; 3] {
    let is = |corner: f64| entry == corner;
    [
        [select(is(0.0), base, select(is(1.0), x, 0.0)), select(is(1.0), y, 0.0)],
        [select(is(0.0), x, select(is(2.0), base, 0.0)), select(is(0.0), y, 0.0)],
        [select(is(1.0), base, select(is(2.0), x, 0.0)), select(is(2.0), y, 0.0)],
    ]
}

#[inline(always)]
fn centroid([p, q, r]: [PlanePoint; 3]) -> PlanePoint {
    let third = 1.0 / 3.0;
    [(p[0] + q[0] + r[0]) * third, (p[1] + q[1] + r[1]) * third]
}

/// The window from the point at the distances that are known of both ends of its entry, with the same offset, or a smaller one.
#[cold]
#[inline(never)]
fn agreeing(window: SourceWindow, ends: [PlanePoint; 2], known: [f64; 2]) -> SourceWindow {
    if known.contains(&f64::INFINITY) {
        return window;
    }
    let offset = window.offset.min(known[0]).min(known[1]);
    let length = norm(sub(ends[1], ends[0]));
    // Until an end is finalized it may be farther than the side leads.
    let [left, right] = [0, 1].map(|end| known[end].min(known[1 - end] + length) - offset);
    let lengths = [length, left, right];
    SourceWindow::around(beyond(ends, lengths, GateSide::Behind), offset)
}

/// The rays from a virtual source to the ends of an exit and to the corner behind it.
#[derive(Clone, Copy)]
struct Rays {
    ends: [PlanePoint; 2],
    /// The distances of the end that is the apex, and of the other.
    known: [f64; 2],
    apex: PlanePoint,
}

impl Rays {
    /// Continues a window with the given limits, which narrow to the ends of the exit where paths may bend. Towards a
    /// source that lies behind the exit, they turn around its first or second end. Returns the distance of the centroid and
    /// the window, both seen from the virtual source.
    #[inline(always)]
    fn cross(
        self,
        [left, right]: [PlanePoint; 2],
        bends: [bool; 2],
        offset: f64,
        pivots_right: bool,
    ) -> (f64, SourceWindow) {
        let Self { ends: [start, end], known, apex } = self;
        let base = sub(end, start);
        let ray = centroid([start, end, apex]);
        let is_behind = cross(end, start) <= COLLINEAR * (dot(start, base).abs() + dot(base, base));
        // On the left, an end that is to the right of the limit is a new limit, and the reverse.
        let left = select_point(bends[0] & below_or_nan(cross(left, start), 0.0), start, left);
        let right = select_point(bends[1] & below_or_nan(0.0, cross(right, end)), end, right);
        // Negative in the shadow.
        let [at_left, at_right] = [cross(ray, left), -cross(ray, right)];
        let [in_left, in_right] = shadows(at_left, at_right);
        let [leaves_left, leaves_right] = [self.leaves_light(left, 1.0), self.leaves_light(right, -1.0)];
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
        let [to_apex, to_entry] = [known[0] - offset - before, known[1] - offset - before];
        let is_apex = is_end & (is_right != pivots_right) & (to_apex < f64::INFINITY);
        let is_entry = is_end & (is_right == pivots_right) & (to_entry < f64::INFINITY);
        let before = before + select(is_apex, to_apex, 0.0) + select(is_entry, to_entry, 0.0);
        let is_new = is_end | (in_left & leaves_left) | (in_right & leaves_right);
        let none = [f64::NAN; 2];
        let window = SourceWindow {
            source: select_point(is_new, bend, [0.0; 2]),
            limits: [left, right].map(|limit| select_point(is_new, none, limit)),
            offset: offset + select(is_new, before, 0.0),
        };
        (offset + before + norm(sub(ray, bend)), window)
    }

    /// Whether the triangle behind is in the shadow of a limit on the left (1) or right (-1).
    #[inline(always)]
    fn leaves_light(self, limit: PlanePoint, sign: f64) -> bool {
        let [start, end] = self.ends;
        let [p, q, r] =
            [sign * cross(start, limit), sign * cross(end, limit), sign * cross(self.apex, limit)];
        let most = select(p > q, p, q);
        select(most > r, most, r) <= 0.0
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use base::SplitMix;
    use surface::FaceId;

    use super::*;
    use crate::plane::distance;

    /// What a point in the shadow of a limit bends at: of two limits, the one in whose shadow it is deeper.
    fn limit_before(ray: PlanePoint, [left, right]: [Option<PlanePoint>; 2]) -> Option<PlanePoint> {
        let in_left = left.map_or(0.0, |left| -cross(ray, left));
        let in_right = right.map_or(0.0, |right| cross(ray, right));
        match in_left > 0.0 || in_right > 0.0 {
            true => {
                if in_left >= in_right {
                    left
                } else {
                    right
                }
            }
            false => None,
        }
    }

    /// The rules of a crossing, one after the other, with branches: the distance of the apex, and behind each exit that of the
    /// centroid and the window.
    fn by_rules(crossing: &Crossing<'_>) -> (f64, [Option<(f64, SourceWindow)>; 2]) {
        let Crossing { window, triangle, entry, known, behind, .. } = *crossing;
        let [left, right] = around(entry);
        let ends = [left, right].map(|slot| triangle.corners()[slot]);
        let length = distance(ends[0], ends[1]);
        let is_early = !known.contains(&f64::INFINITY)
            && (0..2).any(|i| {
                known[i] - window.distance(ends[i]) > DISAGREEMENT * length && known[i] < crossing.distance
            });
        let SourceWindow { source, limits, offset } = match is_early {
            true => {
                let offset = window.offset.min(known[0]).min(known[1]);
                let radii = [0, 1].map(|end| known[end].min(known[1 - end] + length) - offset);
                let source = beyond(ends, [length, radii[0], radii[1]], GateSide::Behind);
                SourceWindow::around(source, offset)
            }
            false => window,
        };
        let limits = limits.map(|limit| (!limit[0].is_nan()).then_some(limit));
        let at = triangle.corners().map(|corner| sub(corner, source));
        let misses = cross(at[entry], at[left]) < 0.0 || cross(at[entry], at[right]) > 0.0;
        let bend = limit_before(at[entry], limits).unwrap_or([0.0; 2]);
        let through = if misses { f64::INFINITY } else { offset + norm(bend) + distance(at[entry], bend) };
        let along = [left, right].map(|end| distance(at[entry], at[end]));
        let apex = through.min(known[0] + along[0]).min(known[1] + along[1]);
        let mut at_corners = [apex; 3];
        (at_corners[left], at_corners[right]) = (known[0], known[1]);
        let exit = |[start, end]: [usize; 2], behind: Option<(CornerId, &MarchTriangle)>, pivot: usize| {
            let (corner, other) = behind?;
            // The triangle behind, turned over if need be, rolled onto the exit.
            let is_mirrored = triangle.vertex(start) != other.vertex(around(corner.slot())[0]);
            let base = other.base();
            let flip = |[x, y]: PlanePoint| if is_mirrored { [base - x, y] } else { [x, y] };
            let mut its = [around(corner.slot())[0], around(corner.slot())[1], corner.slot()];
            if is_mirrored {
                its.swap(0, 1);
            }
            let [own_start, own_end, third] = its.map(|slot| flip(other.corners()[slot]));
            let angle = |[x, y]: PlanePoint| y.atan2(x);
            let turn = angle(sub(at[end], at[start])) - angle(sub(own_end, own_start));
            let turned =
                |[x, y]: PlanePoint, by: f64| [x * by.cos() - y * by.sin(), x * by.sin() + y * by.cos()];
            let [x, y] = turned(sub(third, own_start), turn);
            let third = [at[start][0] + x, at[start][1] + y];
            let centroid = [0, 1].map(|axis| (at[start][axis] + at[end][axis] + third[axis]) / 3.0);
            let [mut left, mut right] = limits;
            if triangle.bends_at(start) && left.is_none_or(|left| cross(left, at[start]) < 0.0) {
                left = Some(at[start]);
            }
            if triangle.bends_at(end) && right.is_none_or(|right| cross(right, at[end]) > 0.0) {
                right = Some(at[end]);
            }
            let slack = |corner: usize| {
                let width = cross(centroid, at[start]) - cross(centroid, at[end]);
                if triangle.bends_at(corner) { 0.0 } else { NEAR_MISS * width }
            };
            let limit = limit_before(centroid, [left, right]);
            let turns_at = if cross(at[end], at[start]) <= 0.0 {
                Some(pivot)
            } else if limit.is_some() {
                None
            } else if cross(centroid, at[start]) < -slack(start) {
                Some(start)
            } else if cross(centroid, at[end]) > slack(end) {
                Some(end)
            } else {
                None
            };
            let (bend, before, is_new) = match (turns_at, limit) {
                (Some(corner), _) => {
                    let known = Some(at_corners[corner] - offset).filter(|known| known.is_finite());
                    (at[corner], known.unwrap_or(norm(at[corner])), true)
                }
                (None, Some(limit)) => {
                    // Dark if no corner is on the light side.
                    let sign = if left == Some(limit) { 1.0 } else { -1.0 };
                    let is_dark = [at[start], at[end], third].iter().all(|p| sign * cross(*p, limit) <= 0.0);
                    (limit, norm(limit), is_dark)
                }
                (None, None) => ([0.0; 2], 0.0, false),
            };
            let found = offset + before + distance(centroid, bend);
            let [x, y] = turned(sub(if is_new { bend } else { [0.0; 2] }, at[start]), -turn);
            let limits = [left, right]
                .map(|limit| limit.filter(|_| !is_new).map_or([f64::NAN; 2], |limit| turned(limit, -turn)));
            let offset = offset + if is_new { before } else { 0.0 };
            let window = SourceWindow { source: [own_start[0] + x, own_start[1] + y], limits, offset };
            Some((found, if is_mirrored { window.mirrored(base) } else { window }))
        };
        (apex, [exit([left, entry], behind[0], left), exit([entry, right], behind[1], right)])
    }

    #[test]
    fn lanes_follow_the_rules() {
        let mut random = SplitMix(7);
        let mut number = move |low: f64, high: f64| low + (high - low) * (0.5 + 0.5 * random.uniform());
        let mut n_new = 0;
        for _ in 0..2000 {
            let own = [number(0.8, 1.2), number(0.8, 1.2), number(0.45, 0.75)];
            // Vertices 0, 1 and 2, at some of which paths may bend; vertex 3 is beyond both exits.
            let vertices = [0, 1, 2].map(|i| i | if number(0.0, 1.0) < 0.4 { 1 << 31 } else { 0 });
            let triangle = MarchTriangle::of(own, vertices);
            let entry = number(0.0, 3.0) as usize;
            let [left, right] = around(entry);
            // The triangles behind, either way round, with any of their sides at the exit.
            let mut behind = |side: usize| {
                let mut ends = around(side);
                if number(0.0, 1.0) < 0.5 {
                    ends.swap(0, 1);
                }
                let corner = number(0.0, 3.0) as usize;
                let (mut lengths, mut vertices) = ([0.0; 3], [3; 3]);
                lengths[corner] = own[side];
                for (slot, end) in around(corner).into_iter().zip(ends) {
                    (lengths[slot], vertices[slot]) = (number(1.01, 1.5) * own[side], end as u32);
                }
                (CornerId::new(FaceId(5), corner), MarchTriangle::of(lengths, vertices))
            };
            let exits = [behind(right), behind(left)];
            let at = |slot: usize| triangle.corners()[slot];
            // A source on the outer side of the entry, seen from its middle, and limits on either side of the apex.
            let along = sub(at(right), at(left));
            let away = number(-1.4, 1.4) - FRAC_PI_2;
            let far = number(0.1, 4.0);
            let direction = along[1].atan2(along[0]) + away;
            let middle = crate::plane::between(at(left), at(right), 0.5);
            let source = [middle[0] + far * direction.cos(), middle[1] + far * direction.sin()];
            let to_apex = sub(at(entry), source);
            let mut limit = |turn: f64| {
                let (angle, size) = (
                    to_apex[1].atan2(to_apex[0]) + turn * number(-0.2, 0.6),
                    number(0.1, 1.0) * norm(to_apex),
                );
                if number(0.0, 1.0) < 0.4 { [f64::NAN; 2] } else { [size * angle.cos(), size * angle.sin()] }
            };
            let window = SourceWindow { source, limits: [limit(1.0), limit(-1.0)], offset: number(0.0, 2.0) };
            // Windows tell the ends to be nearer or farther than they are known to be, or they are not known.
            let near = |end: usize, by: f64| window.offset + distance(at(end), source) + by;
            let known = [left, right].map(|end| near(end, number(-0.2, 0.3)));
            if (known[0] - known[1]).abs() > 0.95 * own[entry] {
                continue;
            }
            let known = known.map(|known| if number(0.0, 1.0) < 0.1 { f64::INFINITY } else { known });
            let crossing = Crossing {
                window,
                triangle: &triangle,
                entry,
                known,
                distance: window.distance(triangle.centroid()),
                behind: [0, 1].map(|exit| Some((exits[exit].0, &exits[exit].1))),
            };
            let mut lanes = Crossings::default();
            lanes.reset(true);
            lanes.push(&crossing);
            assert_eq!(lanes.solve(), 1);
            let (apex, expected) = by_rules(&crossing);
            assert!(lanes.apex(0).1 == apex || (lanes.apex(0).1 - apex).abs() < 1e-12);
            for (exit, expected) in expected.into_iter().enumerate() {
                let (distance, expected) = expected.unwrap();
                let window = lanes.window(0, exit);
                assert!((lanes.behind(0, exit).unwrap().1 - distance).abs() < 1e-12, "{crossing:?}");
                for (a, b) in window.numbers().into_iter().zip(expected.numbers()) {
                    assert!((a - b).abs() < 1e-11 || (a.is_nan() && b.is_nan()), "{window:?} {expected:?}");
                }
                n_new += usize::from(expected.offset > crossing.window.offset);
            }
        }
        assert!((400..3600).contains(&n_new), "{n_new}");
    }
}
