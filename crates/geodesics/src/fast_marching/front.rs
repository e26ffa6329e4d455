//! The front: the window of every triangle, and the distances of the vertices.

use base::{Budget, Exceeded};
use surface::{NearestFirst, VertexId};

use super::buckets::{Buckets, NOWHERE, Queued};
use super::crossing::{Crossings, LANES, SolveCrossings};
use super::triangles::{MarchTriangle, Triangles, around};
use super::window::{ROUNDING, SourceWindow};
use crate::plane::{self, PlanePoint};
use crate::prefetch::prefetch;
use crate::source::Source;

/// Limit of the mean number of visits per triangle. Real surfaces need one or two.
const VISITS_PER_TRIANGLE: usize = 64;

/// A front that was stopped looks at all triangles only if it knows more than one in so many. It affects time only.
const FEW: usize = 16;

/// Three distances from a point are those of one point if its position from two of them agrees with the third to this
/// share of the longest side, which leaves room for rounding in flat triangles.
const SAME_POINT: f64 = 1e-9;

/// The distances of two vertices may differ by the length of an edge times this: rounding.
const SLACK: f64 = 1.0 + 1e-12;

/// What the crossings of a triangle count for in the meter of a budget.
const OPERATIONS: usize = 16;

/// Through which side a window enters, if not from inside the triangle: a corner that no triangle has.
const INSIDE: u32 = 3;

/// No triangle behind a side.
const NO_CORNER: u32 = u32::MAX;

/// What is known of a triangle: one cache line.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
struct TriangleLabel {
    window: SourceWindow,
    /// The corner opposite the side where the window enters.
    entry: u32,
    bucket: u32,
}

/// A window that may be better than the one of its triangle.
#[derive(Debug, Clone, Copy)]
struct WindowOffer {
    triangle: u32,
    entry: u32,
    /// The distance of the centroid.
    distance: f64,
    window: SourceWindow,
}

/// What is known of all triangles.
#[derive(Debug, Default)]
struct TriangleLabels {
    /// The distances of the centroids.
    distances: Vec<f64>,
    /// The labels, which mean something at finite distances.
    labels: Vec<TriangleLabel>,
}

impl Queued for TriangleLabels {
    #[inline(always)]
    fn distance(&self, triangle: u32) -> f64 {
        self.distances[triangle as usize]
    }

    #[inline(always)]
    fn bucket(&mut self, triangle: u32) -> &mut u32 {
        &mut self.labels[triangle as usize].bucket
    }
}

/// A front that advances bucket by bucket from triangle to triangle.
#[derive(Debug, Default)]
pub(super) struct TriangleFront {
    triangles: TriangleLabels,
    /// The triangles that have a window.
    reached: Vec<u32>,
    buckets: Buckets,
    /// The triangles of a round.
    round: Vec<u32>,
    /// The crossings that are solved next, and for each the vertex and the two entries that they lead to.
    crossings: Crossings,
    ahead: [[u32; 3]; LANES],
    n_crossings: usize,
    offers: Vec<WindowOffer>,
    /// The distance of every vertex.
    vertices: Vec<f64>,
    /// Vertices whose neighbours may be too far away.
    lowered: NearestFirst<u32>,
    /// Vertices that were first reached along edges and links.
    along_edges: Vec<u32>,
    visits: usize,
    /// The distance of the middle of every hub.
    hubs: Vec<f64>,
    instructions: pulp::Arch,
}

impl TriangleFront {
    /// Prepares for a new run. Allocates only to grow.
    fn reset(&mut self, triangles: &Triangles) {
        let n = triangles.triangles.len();
        self.triangles.distances.clear();
        self.triangles.distances.resize(n, f64::INFINITY);
        let window = SourceWindow::around([0.0; 2], f64::INFINITY);
        self.triangles.labels.resize(n, TriangleLabel { window, entry: INSIDE, bucket: NOWHERE });
        self.vertices.clear();
        self.vertices.resize(triangles.order.len(), f64::INFINITY);
        self.buckets.reset(triangles.bucket_width, triangles.longest);
        self.offers.clear();
        self.lowered.clear();
        self.along_edges.clear();
        self.reached.clear();
        self.hubs.clear();
        self.hubs.resize(triangles.n_hubs, f64::INFINITY);
        self.visits = VISITS_PER_TRIANGLE.saturating_mul(n);
        self.n_crossings = 0;
    }

    /// Starts from a source.
    fn start(&mut self, triangles: &Triangles, source: &Source) {
        let reach = source.reach();
        for (vertex, distance) in reach {
            let vertex = triangles.rank[vertex.index()];
            let known = &mut self.vertices[vertex as usize];
            *known = known.min(*distance);
        }
        let known = |vertex: u32| {
            let vertex = triangles.order[vertex as usize];
            reach.iter().find(|(v, _)| v.0 == vertex).map(|(_, distance)| *distance)
        };
        for (vertex, distance) in reach {
            let vertex = triangles.rank[vertex.index()];
            if reach.len() > 1 {
                self.start_inside(triangles, vertex, known);
            }
            self.start_around(triangles, vertex, *distance, |_, _| false);
        }
    }

    /// Starts from a point inside those triangles at a vertex all of whose vertices are at a known straight distance.
    fn start_inside(&mut self, triangles: &Triangles, vertex: u32, straight: impl Fn(u32) -> Option<f64>) {
        for number in triangles.corners.row(vertex as usize).iter().map(|corner| corner / 3) {
            let triangle = triangles.at(number);
            let [Some(a), Some(b), Some(c)] = triangle.vertices().map(&straight) else { continue };
            let Some(source) = located(triangle, [a, b, c], SAME_POINT * triangles.longest) else { continue };
            let window = SourceWindow::around(source, 0.0);
            let distance = window.distance(triangle.centroid());
            self.offers.push(WindowOffer { triangle: number, entry: INSIDE, distance, window });
        }
    }

    /// Offers the rays from a vertex to all triangles around it.
    fn start_around(
        &mut self,
        triangles: &Triangles,
        vertex: u32,
        offset: f64,
        stops: impl Fn(u32, f64) -> bool,
    ) {
        for corner in triangles.corners.row(vertex as usize) {
            self.start_at(triangles, *corner, offset, &stops);
        }
    }

    /// Offers the rays from a vertex to the triangle with the given corner there.
    fn start_at(
        &mut self,
        triangles: &Triangles,
        corner: u32,
        offset: f64,
        stops: impl Fn(u32, f64) -> bool,
    ) {
        let (number, slot) = (corner / 3, corner as usize % 3);
        let triangle = triangles.at(number);
        let window = SourceWindow::around(triangle.corners()[slot], offset);
        let distance = window.distance(triangle.centroid());
        if !stops(number, distance) && improves(distance, self.triangles.distance(number)) {
            let entry = around(slot)[0] as u32;
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
        stops: impl Fn(u32, f64) -> bool,
    ) -> Result<(), Exceeded> {
        self.reset(triangles);
        sources.iter().for_each(|source| self.start(triangles, source));
        while !self.offers.is_empty() && self.visits > 0 {
            for WindowOffer { triangle, window, .. } in &self.offers {
                let triangle = triangles.at(*triangle);
                for (vertex, corner) in triangle.vertices().into_iter().zip(triangle.corners()) {
                    let known = &mut self.vertices[vertex as usize];
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
    fn start_again(&mut self, triangles: &Triangles, stops: impl Fn(u32, f64) -> bool) {
        for joint in &triangles.joints {
            let offset = self.vertices[*joint as usize];
            if offset.is_finite() {
                self.start_around(triangles, *joint, offset, &stops);
            }
        }
        if self.reached.len() < triangles.triangles.len() {
            match self.nearby(triangles) {
                Some(nearby) => self.start_next_to(triangles, nearby.into_iter(), stops),
                None => self.start_next_to(triangles, 0..triangles.triangles.len() as u32, stops),
            }
        }
    }

    /// Offers the rays from all corners of those triangles that were not reached.
    fn start_next_to(
        &mut self,
        triangles: &Triangles,
        numbers: impl Iterator<Item = u32>,
        stops: impl Fn(u32, f64) -> bool,
    ) {
        for number in numbers {
            if self.triangles.distance(number) == f64::INFINITY {
                for (slot, vertex) in (0..).zip(triangles.at(number).vertices()) {
                    let offset = self.vertices[vertex as usize];
                    if offset.is_finite() {
                        self.start_at(triangles, 3 * number + slot, offset, &stops);
                    }
                }
            }
        }
    }

    /// The triangles with a vertex that was reached, in ascending order; none if they may be a large share of all.
    fn nearby(&self, triangles: &Triangles) -> Option<Vec<u32>> {
        let n_known = self.reached.len() + self.along_edges.len();
        if n_known > triangles.triangles.len() / FEW {
            return None;
        }
        let corners = self.reached.iter().flat_map(|number| triangles.at(*number).vertices());
        let vertices = corners.chain(self.along_edges.iter().copied());
        let around = vertices.flat_map(|vertex| triangles.corners.row(vertex as usize));
        let mut found: Vec<u32> = around.map(|corner| corner / 3).collect();
        found.sort_unstable();
        found.dedup();
        Some(found)
    }

    fn march(
        &mut self,
        triangles: &Triangles,
        budget: &Budget,
        stops: impl Fn(u32, f64) -> bool,
    ) -> Result<(), Exceeded> {
        let mut meter = budget.meter();
        let mut round = std::mem::take(&mut self.round);
        while self.buckets.next_round(&mut round, &mut self.triangles) {
            meter.count(OPERATIONS * (1 + round.len()))?;
            self.visits = self.visits.saturating_sub(round.len());
            for number in &round {
                if !stops(*number, self.triangles.distance(*number)) {
                    self.leave(triangles, *number);
                }
            }
            self.solve_crossings(triangles);
            self.take_offers(triangles);
        }
        self.round = round;
        Ok(())
    }

    /// Adds the crossings of the sides of a triangle through which its window leaves.
    #[inline(always)]
    fn leave(&mut self, triangles: &Triangles, number: u32) {
        let triangle = triangles.at(number);
        let entry = self.triangles.labels[number as usize].entry;
        if entry == INSIDE || triangle.is_irregular() {
            self.leave_irregular(triangles, number);
            return;
        }
        let [left, right] = around(entry as usize);
        self.cross(triangles, number, entry, [triangle.across[right], triangle.across[left]]);
    }

    /// The same, if more than two triangles share a side, or the source is inside.
    #[cold]
    #[inline(never)]
    fn leave_irregular(&mut self, triangles: &Triangles, number: u32) {
        let TriangleLabel { entry, window, .. } = self.triangles.labels[number as usize];
        let entries = if entry == INSIDE { 0..2 } else { entry..entry + 1 };
        for entry in entries {
            let [left, right] = around(entry as usize);
            let mut ways = [right, left].map(|side| 3 * number + side as u32);
            let mut is_open = ways.map(|own| self.opens(triangles, own, &window));
            while is_open[0] | is_open[1] {
                let mut behind = [NO_CORNER; 2];
                for exit in 0..2 {
                    if is_open[exit] {
                        let own = 3 * number + [right, left][exit] as u32;
                        ways[exit] = triangles.at(ways[exit] / 3).across[ways[exit] as usize % 3];
                        is_open[exit] = ways[exit] != own;
                        behind[exit] = ways[exit];
                    }
                }
                self.cross(triangles, number, entry, behind);
            }
        }
    }

    /// Whether a window may cross a side: at a hub, only if the middle is nearer through it than through those before.
    fn opens(&mut self, triangles: &Triangles, own: u32, window: &SourceWindow) -> bool {
        let Some(hub) = triangles.hubs.get(&own) else { return true };
        let corners = triangles.at(own / 3).corners();
        let [start, end] = around(own as usize % 3).map(|slot| corners[slot]);
        let middle = window.distance(plane::between(start, end, 0.5));
        let known = &mut self.hubs[*hub as usize];
        let opens = middle < *known * (1.0 - ROUNDING);
        *known = if opens { middle } else { *known };
        opens
    }

    /// Adds the crossing of a triangle towards the entries on the left and right.
    #[inline(always)]
    fn cross(&mut self, triangles: &Triangles, number: u32, entry: u32, behind: [u32; 2]) {
        let triangle = triangles.at(number);
        let lane = self.n_crossings;
        let label = &self.triangles.labels[number as usize];
        self.crossings.set(lane, &label.window, triangle, entry as usize);
        let [left, right] = around(entry as usize);
        let vertex = triangle.vertex(entry as usize);
        prefetch(&self.vertices[vertex as usize]);
        let at_left = self.vertices[triangle.vertex(left) as usize];
        let at_right = self.vertices[triangle.vertex(right) as usize];
        self.crossings.set_known(lane, [at_left, at_right]);
        let mut ahead = [vertex, NO_CORNER, NO_CORNER];
        for (exit, side) in [(0, right), (1, left)] {
            let corner = behind[exit];
            if corner == NO_CORNER || corner == 3 * number + side as u32 {
                continue;
            }
            let (other, slot) = (triangles.at(corner / 3), corner as usize % 3);
            ahead[1 + exit] = corner;
            if triangle.vertex(around(side)[1]) == other.vertex(around(slot)[0]) {
                self.crossings.set_exit(lane, exit, other, slot);
            } else {
                ahead[1 + exit] |= MIRRORED;
                self.crossings.set_exit(lane, exit, &other.mirrored(), [1, 0, 2][slot]);
            }
        }
        self.ahead[lane] = ahead;
        self.n_crossings += 1;
        if self.n_crossings == LANES {
            self.solve_crossings(triangles);
        }
    }

    /// Solves the crossings, lowers the vertices that they lead to, and keeps the windows that may be better than those
    /// of their triangles.
    #[inline(never)]
    fn solve_crossings(&mut self, triangles: &Triangles) {
        let n = std::mem::take(&mut self.n_crossings);
        self.instructions.dispatch(SolveCrossings(&mut self.crossings));
        for (lane, [vertex, left, right]) in self.ahead.iter().enumerate().take(n) {
            let distance = self.crossings.apex_distance(lane);
            let known = &mut self.vertices[*vertex as usize];
            *known = if distance < *known { distance } else { *known };
            for (exit, corner) in [(0, *left), (1, *right)] {
                if corner == NO_CORNER {
                    continue;
                }
                let (triangle, entry) = ((corner & !MIRRORED) / 3, (corner & !MIRRORED) % 3);
                let distance = self.crossings.distance(lane, exit);
                if distance <= self.triangles.distance(triangle) * (1.0 + ROUNDING) {
                    let mut window = self.crossings.window(lane, exit);
                    if corner & MIRRORED != 0 {
                        window = unmirrored(&window, triangles.at(triangle).base());
                    }
                    self.offers.push(WindowOffer { triangle, entry, distance, window });
                }
            }
        }
    }

    /// Gives triangles other windows, if those are nearer to the source, or see as near but from a source that bent
    /// less, or as much but through the next side. A triangle that has one already keeps it when there were too many visits.
    #[inline(never)]
    fn take_offers(&mut self, triangles: &Triangles) {
        for WindowOffer { triangle, entry, distance, window } in self.offers.drain(..) {
            let TriangleLabels { distances, labels } = &mut self.triangles;
            let (known, label) = (&mut distances[triangle as usize], &mut labels[triangle as usize]);
            let is_new = *known == f64::INFINITY;
            if !improves(distance, *known) {
                let is_as_near = distance <= *known * (1.0 + ROUNDING);
                let is_less_bent = improves(window.offset, label.window.offset);
                // The order of the sides does not depend on numbers.
                let is_next = label.entry != INSIDE
                    && around(label.entry as usize)[0] == entry as usize
                    && window.offset <= label.window.offset * (1.0 + ROUNDING);
                if !(is_as_near && (is_less_bent || is_next)) {
                    continue;
                }
            }
            if !is_new && self.visits == 0 {
                continue;
            }
            *known = distance;
            let mut bucket = if is_new { NOWHERE } else { label.bucket };
            self.buckets.put(triangle, &mut bucket, distance);
            *label = TriangleLabel { window, entry, bucket };
            if is_new {
                self.reached.push(triangle);
            }
            let across = triangles.at(triangle).across;
            for side in around(entry as usize % 3) {
                let other = across[side] as usize / 3;
                prefetch(&triangles.triangles[other]);
                prefetch(&distances[other]);
                prefetch(&labels[other]);
            }
        }
    }

    /// Lowers vertices along edges and links, without continuing along edges of triangles where it `stops` at the
    /// distance of the vertex.
    fn relax_edges(
        &mut self,
        triangles: &Triangles,
        budget: &Budget,
        stops: impl Fn(u32, f64) -> bool,
    ) -> Result<(), Exceeded> {
        match self.nearby(triangles) {
            Some(nearby) => self.relax_sides(nearby.iter().map(|number| triangles.at(*number))),
            None => self.relax_sides(triangles.triangles.iter()),
        }
        for vertex in 0..triangles.links.n_vertices() as u32 {
            for way in triangles.links.ways(VertexId(vertex)) {
                self.relax(vertex, way.to.0, way.length);
            }
        }
        let mut meter = budget.meter();
        while let Some((at, vertex)) = self.lowered.pop() {
            if at > self.vertices[vertex as usize] {
                continue;
            }
            for corner in triangles.corners.row(vertex as usize) {
                meter.count(2)?;
                if !stops(corner / 3, at) {
                    for (end, length) in triangles.sides_from(*corner) {
                        self.relax(vertex, end, length);
                    }
                }
            }
            for way in triangles.links.ways(VertexId(vertex)) {
                meter.count(1)?;
                self.relax(vertex, way.to.0, way.length);
            }
        }
        Ok(())
    }

    /// Lowers the vertices of triangles along their sides.
    fn relax_sides<'t>(&mut self, triangles: impl Iterator<Item = &'t MarchTriangle>) {
        for triangle in triangles {
            let ([a, b, c], [to_a, to_b, to_c]) = (triangle.vertices(), triangle.lengths);
            let [at_a, at_b, at_c] =
                [self.vertices[a as usize], self.vertices[b as usize], self.vertices[c as usize]];
            let (ab, bc, ca) = ((at_b - at_a).abs(), (at_c - at_b).abs(), (at_a - at_c).abs());
            if (bc > SLACK * to_a) | (ca > SLACK * to_b) | (ab > SLACK * to_c) {
                for (length, [p, q]) in [(to_a, [b, c]), (to_b, [c, a]), (to_c, [a, b])] {
                    self.relax(p, q, length);
                    self.relax(q, p, length);
                }
            }
        }
    }

    /// Lowers a vertex to the distance of another and the length of the way between them, if that is less.
    #[inline]
    fn relax(&mut self, from: u32, to: u32, length: f64) {
        let distance = self.vertices[from as usize] + length;
        let known = &mut self.vertices[to as usize];
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
    pub(crate) fn distance(&self, vertex: u32) -> f64 {
        self.vertices[vertex as usize]
    }
}

/// The flag of an entry into a triangle that lies the other way round than the one before.
const MIRRORED: u32 = 1 << 31;

/// A window of a mirrored triangle in the plane of the triangle, whose base has the given length.
fn unmirrored(window: &SourceWindow, base: f64) -> SourceWindow {
    let SourceWindow { source: [x, y], limits: [left, right], offset } = *window;
    let flipped = |[x, y]: PlanePoint| [-x, y];
    SourceWindow { source: [base - x, y], limits: [flipped(right), flipped(left)], offset }
}

/// Whether a distance is less than the known one by more than rounding.
#[inline(always)]
fn improves(distance: f64, known: f64) -> bool {
    distance < known * (1.0 - ROUNDING)
}

/// The point in the plane of a triangle at the given distances from its corners; none if no point is, up to a slack.
fn located(triangle: &MarchTriangle, distances: [f64; 3], slack: f64) -> Option<PlanePoint> {
    let [start, end, apex] = triangle.corners();
    let at =
        plane::beyond([start, end], [triangle.base(), distances[0], distances[1]], plane::GateSide::Ahead);
    let error = plane::distance(at, apex) - distances[2];
    (error.abs() <= slack).then_some(at)
}
