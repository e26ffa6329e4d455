//! The front: the window of every triangle that waits, and the distances of triangles and vertices.

use std::collections::BTreeMap;

use base::{Budget, Exceeded};
use surface::{CornerId, FaceId, NearestFirst, SurfacePoint, VertexId};

use super::crossing::{Crossing, Crossings};
use super::queue::{Buckets, Labels, NOWHERE};
use super::triangles::Triangles;
use super::window::{ROUNDING, SourceWindow};
use crate::plane::{self, around};
use crate::prefetch::prefetch;
use crate::source::{Source, point_within};

/// Limit of the mean number of visits per triangle. Real surfaces need one or two.
const VISITS_PER_TRIANGLE: usize = 64;

/// A front that was stopped looks at all triangles only if it knows more than one in so many. It affects time only.
const FEW: usize = 16;

/// The distances of two vertices may differ by the length of an edge times this: rounding.
const SLACK: f64 = 1.0 + 1e-12;

/// What the crossings of a triangle count for in the meter of a budget.
const OPERATIONS: usize = 16;

/// Through which side a window enters, if not from inside the triangle: a corner that no triangle has.
const INSIDE: usize = 3;

/// A window that may be better than the one of its triangle.
#[derive(Debug, Clone, Copy)]
struct WindowOffer {
    triangle: FaceId,
    /// The corner opposite the side where it enters.
    entry: usize,
    /// The distance of the centroid.
    distance: f64,
    window: SourceWindow,
}

/// A front that advances bucket by bucket from triangle to triangle.
#[derive(Debug, Default)]
pub(super) struct TriangleFront {
    triangles: Labels,
    /// The windows of the triangles that wait, far fewer than all, and the places among them that are free.
    windows: Vec<SourceWindow>,
    free: Vec<u32>,
    /// The triangles that have, or had, a window.
    reached: Vec<FaceId>,
    queue: Buckets,
    /// The triangles of a round.
    round: Vec<FaceId>,
    /// The crossings that are solved next.
    crossings: Crossings,
    offers: Vec<WindowOffer>,
    /// The vertices that the crossings of a round lead to, with their distances. Windows depend on what was known before the round, so
    /// the order of its triangles changes nothing.
    reached_vertices: Vec<(VertexId, f64)>,
    /// The distance of every vertex.
    vertices: Vec<f64>,
    /// Vertices whose neighbors may be too far away.
    lowered: NearestFirst<VertexId>,
    /// Vertices that were first reached along edges and links.
    along_edges: Vec<VertexId>,
    visits: usize,
    /// The distance of the middle of every hub.
    hubs: Vec<f64>,
}

impl TriangleFront {
    /// Prepares for a new run. Allocates only to grow.
    fn reset(&mut self, triangles: &Triangles) {
        self.triangles.reset(triangles.all.len());
        self.windows.clear();
        self.free.clear();
        self.vertices.clear();
        self.vertices.resize(triangles.order.len(), f64::INFINITY);
        self.queue.reset(triangles.bucket_width, triangles.longest);
        self.offers.clear();
        self.lowered.clear();
        self.along_edges.clear();
        self.reached.clear();
        self.hubs.clear();
        self.hubs.resize(triangles.n_hubs, f64::INFINITY);
        self.visits = VISITS_PER_TRIANGLE.saturating_mul(triangles.all.len());
        self.crossings.reset(triangles.may_bend);
        self.reached_vertices.clear();
    }

    /// Starts from a source.
    fn start(&mut self, triangles: &Triangles, source: &Source) {
        for (vertex, distance) in source.reach() {
            let vertex = triangles.number(*vertex);
            let known = &mut self.vertices[vertex.index()];
            *known = known.min(*distance);
            for corner in triangles.corners.row(vertex.index()) {
                self.start_at(triangles, *corner, *distance, |_, _| false);
            }
        }
        if !matches!(source.point(), SurfacePoint::Vertex(_)) {
            self.start_inside(triangles, source);
        }
    }

    /// Starts from a point inside the triangles that hold it.
    fn start_inside(&mut self, triangles: &Triangles, source: &Source) {
        let seen: BTreeMap<VertexId, f64> =
            source.seen().iter().map(|(vertex, length)| (triangles.number(*vertex), *length)).collect();
        // Every triangle once.
        let around = seen.keys().flat_map(|vertex| triangles.corners.row(vertex.index()));
        for number in around.filter(|corner| corner.slot() == 0).map(|corner| corner.face()) {
            let triangle = triangles.at(number);
            let [Some(a), Some(b), Some(c)] = triangle.vertices().map(|v| seen.get(&v)) else { continue };
            let (base, [x, y]) = (triangle.base(), triangle.apex);
            let Some([_, second, third]) = point_within([base, x, y], [*a, *b, *c]) else { continue };
            let window = SourceWindow::around([second * base + third * x, third * y], 0.0);
            let distance = window.distance(triangle.centroid());
            self.offers.push(WindowOffer { triangle: number, entry: INSIDE, distance, window });
        }
    }

    /// Offers the rays from a vertex to the triangle with the given corner there.
    fn start_at(
        &mut self,
        triangles: &Triangles,
        corner: CornerId,
        offset: f64,
        stops: impl Fn(FaceId, f64) -> bool,
    ) {
        let (number, slot) = (corner.face(), corner.slot());
        let triangle = triangles.at(number);
        let window = SourceWindow::around(triangle.corners()[slot], offset);
        let distance = window.distance(triangle.centroid());
        if !stops(number, distance) && improves(distance, self.triangles.distance(number)) {
            let entry = around(slot)[0];
            self.offers.push(WindowOffer { triangle: number, entry, distance, window });
        }
    }

    /// Runs from sources until no triangle is left, without continuing from triangles where it `stops` at their
    /// distance.
    pub(crate) fn run(
        &mut self,
        triangles: &Triangles,
        sources: &[Source],
        budget: &Budget,
        stops: impl Fn(FaceId, f64) -> bool,
    ) -> Result<(), Exceeded> {
        self.reset(triangles);
        sources.iter().for_each(|source| self.start(triangles, source));
        while !self.offers.is_empty() && self.visits > 0 {
            for WindowOffer { triangle, window, .. } in &self.offers {
                let triangle = triangles.at(*triangle);
                for (vertex, corner) in triangle.vertices().into_iter().zip(triangle.corners()) {
                    let known = &mut self.vertices[vertex.index()];
                    *known = known.min(window.distance(corner));
                }
            }
            self.take_offers(triangles);
            self.march(triangles, budget, &stops)?;
            self.relax_edges(triangles, budget, &stops)?;
            self.start_again(triangles, &stops);
        }
        budget.check()
    }

    /// Offers the rays from vertices that join parts, and next to triangles that were not reached.
    fn start_again(&mut self, triangles: &Triangles, stops: impl Fn(FaceId, f64) -> bool) {
        for joint in &triangles.joints {
            let offset = self.vertices[joint.index()];
            for corner in triangles.corners.row(joint.index()).iter().filter(|_| offset.is_finite()) {
                self.start_at(triangles, *corner, offset, &stops);
            }
        }
        if self.reached.len() == triangles.all.len() {
            return;
        }
        for number in self.nearby(triangles) {
            if self.triangles.distance(number) == f64::INFINITY {
                for (corner, vertex) in number.corners().into_iter().zip(triangles.at(number).vertices()) {
                    let offset = self.vertices[vertex.index()];
                    if offset.is_finite() {
                        self.start_at(triangles, corner, offset, &stops);
                    }
                }
            }
        }
    }

    /// The triangles with a vertex that was reached, in ascending order; all if they may be a large share of them.
    fn nearby(&self, triangles: &Triangles) -> Vec<FaceId> {
        let n_known = self.reached.len() + self.along_edges.len();
        if n_known > triangles.all.len() / FEW {
            return (0..triangles.all.len()).map(FaceId::from).collect();
        }
        let corners = self.reached.iter().flat_map(|number| triangles.at(*number).vertices());
        let vertices = corners.chain(self.along_edges.iter().copied());
        let around = vertices.flat_map(|vertex| triangles.corners.row(vertex.index()));
        let mut found: Vec<FaceId> = around.map(|corner| corner.face()).collect();
        found.sort_unstable();
        found.dedup();
        found
    }

    fn march(
        &mut self,
        triangles: &Triangles,
        budget: &Budget,
        stops: impl Fn(FaceId, f64) -> bool,
    ) -> Result<(), Exceeded> {
        let mut meter = budget.meter();
        let mut round = std::mem::take(&mut self.round);
        while self.queue.next_round(&mut round, &mut self.triangles) {
            meter.count(OPERATIONS * (1 + round.len()))?;
            self.visits = self.visits.saturating_sub(round.len());
            for number in &round {
                let label = self.triangles.labels[number.index()];
                if !stops(*number, self.triangles.distance(*number)) {
                    self.leave(triangles, *number, label.entry(), label.place());
                }
                self.free.push(label.place() as u32);
            }
            self.solve_crossings();
            for (vertex, distance) in self.reached_vertices.drain(..) {
                let known = &mut self.vertices[vertex.index()];
                *known = if distance < *known { distance } else { *known };
            }
            self.take_offers(triangles);
        }
        self.round = round;
        Ok(())
    }

    /// Adds the crossing of a triangle that its window enters opposite the corner `entry`.
    #[inline(always)]
    fn leave(&mut self, triangles: &Triangles, number: FaceId, entry: usize, place: usize) {
        let triangle = triangles.at(number);
        if entry == INSIDE || triangle.is_irregular() {
            self.leave_irregular(triangles, number, entry, place);
            return;
        }
        let [left, right] = around(entry);
        self.cross(triangles, number, entry, place, [right, left].map(|side| Some(triangle.across[side])));
    }

    /// The same, if more than two triangles share a side, or the source is inside.
    #[cold]
    #[inline(never)]
    fn leave_irregular(&mut self, triangles: &Triangles, number: FaceId, entry: usize, place: usize) {
        let window = self.windows[place];
        let entries = if entry == INSIDE { 0..2 } else { entry..entry + 1 };
        for entry in entries {
            let [left, right] = around(entry);
            let own = [right, left].map(|side| CornerId::new(number, side));
            let mut ways = own;
            let mut is_open = own.map(|side| self.opens(triangles, side, &window));
            while is_open[0] | is_open[1] {
                let mut behind = [None; 2];
                for exit in 0..2 {
                    if is_open[exit] {
                        ways[exit] = triangles.at(ways[exit].face()).across[ways[exit].slot()];
                        is_open[exit] = ways[exit] != own[exit];
                        behind[exit] = Some(ways[exit]);
                    }
                }
                self.cross(triangles, number, entry, place, behind);
            }
        }
    }

    /// Whether a window may cross a side: at a hub, only if the middle is nearer through it than through those before.
    fn opens(&mut self, triangles: &Triangles, own: CornerId, window: &SourceWindow) -> bool {
        let Some(hub) = triangles.hubs.get(&own) else { return true };
        let corners = triangles.at(own.face()).corners();
        let [start, end] = around(own.slot()).map(|slot| corners[slot]);
        let middle = window.distance(plane::between(start, end, 0.5));
        let known = &mut self.hubs[*hub as usize];
        let opens = middle < *known * (1.0 - ROUNDING);
        *known = if opens { middle } else { *known };
        opens
    }

    /// Adds the crossing of a triangle towards the corners opposite the exits on the left and right, except its own.
    #[inline(always)]
    fn cross(
        &mut self,
        triangles: &Triangles,
        number: FaceId,
        entry: usize,
        place: usize,
        behind: [Option<CornerId>; 2],
    ) {
        let triangle = triangles.at(number);
        prefetch(&self.vertices[triangle.vertex(entry).index()]);
        let is_full = self.crossings.push(&Crossing {
            window: self.windows[place],
            triangle,
            entry,
            known: around(entry).map(|end| self.vertices[triangle.vertex(end).index()]),
            distance: self.triangles.distance(number),
            behind: behind.map(|corner| {
                let corner = corner.filter(|corner| corner.face() != number)?;
                Some((corner, triangles.at(corner.face())))
            }),
        });
        if is_full {
            self.solve_crossings();
        }
    }

    /// Solves the crossings, lowers the vertices that they lead to, and keeps the windows that may be better than those
    /// of their triangles.
    #[inline(never)]
    fn solve_crossings(&mut self) {
        for lane in 0..self.crossings.solve() {
            self.reached_vertices.push(self.crossings.apex(lane));
            for exit in 0..2 {
                let Some((corner, distance)) = self.crossings.behind(lane, exit) else { continue };
                let (triangle, entry) = (corner.face(), corner.slot());
                if distance <= self.triangles.distance(triangle) * (1.0 + ROUNDING) {
                    let window = self.crossings.window(lane, exit);
                    self.offers.push(WindowOffer { triangle, entry, distance, window });
                }
            }
        }
    }

    /// Gives triangles other windows, if those are nearer to the source, or see as near but from a source that bent
    /// less, or as much but through the side that their ray crosses. A triangle that has one already keeps it when there were too many visits.
    #[inline(never)]
    fn take_offers(&mut self, triangles: &Triangles) {
        let mut offers = std::mem::take(&mut self.offers);
        for &WindowOffer { triangle, entry, distance, ref window } in &offers {
            let Labels { distances, labels } = &mut self.triangles;
            let (known, label) = (&mut distances[triangle.index()], &mut labels[triangle.index()]);
            let is_new = *known == f64::INFINITY;
            if !improves(distance, *known) {
                let is_as_near = distance <= *known * (1.0 + ROUNDING);
                let is_less_bent = improves(window.offset, label.offset);
                let is_better_side = || {
                    let triangle = triangles.at(triangle);
                    // Through a corner the ray crosses two sides. Their order depends neither on numbers nor on orientation, unless they
                    // are equally long.
                    let worth = |side: usize| {
                        (side != INSIDE).then(|| (triangle.is_crossed(side, window), triangle.lengths[side]))
                    };
                    let (its, known) = (worth(entry), worth(label.entry()));
                    let is_next = label.entry() != INSIDE && around(label.entry())[0] == entry;
                    window.offset <= label.offset * (1.0 + ROUNDING)
                        && (its > known || its == known && is_next)
                };
                if !(is_as_near && (is_less_bent || is_better_side())) {
                    continue;
                }
            }
            if is_new {
                label.bucket = NOWHERE;
                self.reached.push(triangle);
            } else if self.visits == 0 {
                continue;
            }
            let place = match label.bucket {
                NOWHERE => self.free.pop().unwrap_or(self.windows.len() as u32) as usize,
                _ => label.place(),
            };
            match self.windows.get_mut(place) {
                Some(place) => *place = *window,
                None => self.windows.push(*window),
            }
            *known = distance;
            (label.offset, label.window) = (window.offset, (4 * place + entry) as u32);
            self.queue.put(triangle, &mut label.bucket, distance);
            let across = triangles.at(triangle).across;
            for side in around(entry % 3) {
                let other = across[side].face().index();
                prefetch(&triangles.all[other]);
                prefetch(&distances[other]);
                prefetch(&labels[other]);
            }
        }
        offers.clear();
        self.offers = offers;
    }

    /// Lowers vertices along edges and links, without continuing along edges of triangles where it `stops` at the
    /// distance of the vertex.
    fn relax_edges(
        &mut self,
        triangles: &Triangles,
        budget: &Budget,
        stops: impl Fn(FaceId, f64) -> bool,
    ) -> Result<(), Exceeded> {
        let mut ways = Vec::new();
        for triangle in self.nearby(triangles).into_iter().map(|number| triangles.at(number)) {
            let ([a, b, c], [to_a, to_b, to_c]) = (triangle.vertices(), triangle.lengths);
            let [at_a, at_b, at_c] = [a, b, c].map(|v| self.vertices[v.index()]);
            let (ab, bc, ca) = ((at_b - at_a).abs(), (at_c - at_b).abs(), (at_a - at_c).abs());
            if (bc > SLACK * to_a) | (ca > SLACK * to_b) | (ab > SLACK * to_c) {
                ways.extend([(to_a, [b, c]), (to_b, [c, a]), (to_c, [a, b])]);
            }
        }
        for (length, [p, q]) in ways {
            self.relax(p, q, length);
            self.relax(q, p, length);
        }
        for vertex in (0..triangles.links.n_vertices()).map(VertexId::from) {
            for way in triangles.links.ways(vertex) {
                self.relax(vertex, way.to, way.length);
            }
        }
        let mut meter = budget.meter();
        while let Some((at, vertex)) = self.lowered.pop() {
            if at > self.vertices[vertex.index()] {
                continue;
            }
            for corner in triangles.corners.row(vertex.index()) {
                meter.count(2)?;
                if !stops(corner.face(), at) {
                    for (end, length) in triangles.sides_from(*corner) {
                        self.relax(vertex, end, length);
                    }
                }
            }
            for way in triangles.links.ways(vertex) {
                meter.count(1)?;
                self.relax(vertex, way.to, way.length);
            }
        }
        Ok(())
    }

    /// Lowers a vertex to the distance of another and the length of the way between them, if that is less.
    #[inline]
    fn relax(&mut self, from: VertexId, to: VertexId, length: f64) {
        let distance = self.vertices[from.index()] + length;
        let known = &mut self.vertices[to.index()];
        if improves(distance, *known) {
            if *known == f64::INFINITY {
                self.along_edges.push(to);
            }
            *known = distance;
            self.lowered.push(distance, to);
        }
    }

    /// The distance of a vertex.
    #[inline]
    pub(crate) fn distance(&self, vertex: VertexId) -> f64 {
        self.vertices[vertex.index()]
    }
}

/// Whether a distance is less than the known one by more than rounding.
#[inline(always)]
fn improves(distance: f64, known: f64) -> bool {
    distance < known * (1.0 - ROUNDING)
}
