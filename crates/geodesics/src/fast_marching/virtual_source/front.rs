//! The front: the window of every triangle, and the distances of the vertices.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use base::{Budget, Exceeded};

use super::super::buckets::Buckets;
use super::super::relaxation::ROUNDING;
use super::crossing::{Crossing, Crossings, LANES, Views};
use super::triangles::{EntrySide, Triangles, around};
use super::window::SourceWindow;
use crate::plane;
use crate::prefetch::prefetch;
use crate::source::Source;

/// Limit of the mean number of visits per triangle. Real surfaces need one or two.
const VISITS_PER_TRIANGLE: usize = 64;

/// Three distances from a point are those of one point if its position from two of them agrees with the third to this
/// share of the longest side, which leaves room for rounding in flat triangles.
const SAME_POINT: f64 = 1e-9;

/// What a crossing counts for in the meter of a budget.
const OPERATIONS: usize = 16;

/// What is known of a triangle: its window, and where that enters.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
struct TriangleLabel {
    window: SourceWindow,
    entry: EntrySide,
}

/// A window that may be better than the one of its triangle.
#[derive(Debug, Clone, Copy)]
struct WindowOffer {
    /// The distance of the centroid.
    distance: f64,
    label: TriangleLabel,
}

/// A front that advances bucket by bucket from triangle to triangle.
#[derive(Debug, Default)]
pub(crate) struct TriangleFront {
    /// The distance of the centroid of every triangle.
    distances: Vec<f64>,
    /// The labels of triangles at finite distances.
    labels: Vec<TriangleLabel>,
    buckets: Buckets,
    /// The triangles of a round.
    round: Vec<u32>,
    candidates: Vec<WindowOffer>,
    /// The crossings of a round.
    crossings: Vec<Crossings>,
    n_crossings: usize,
    /// The distance of every vertex.
    vertices: Vec<f64>,
    /// Vertices whose neighbours may be too far away.
    lowered: BinaryHeap<Reverse<(u64, u32)>>,
    visits: usize,
    /// The distance of the middle of every hub.
    hubs: Vec<f64>,
    instructions: pulp::Arch,
}

impl TriangleFront {
    /// Prepares for a new run. Allocates only to grow.
    fn reset(&mut self, triangles: &Triangles) {
        let n = triangles.triangles.len();
        self.distances.clear();
        self.distances.resize(n, f64::INFINITY);
        let blank =
            TriangleLabel { window: SourceWindow::around([0.0; 2], 0.0), entry: EntrySide::new(0, false) };
        self.labels.resize(n, blank);
        self.vertices.clear();
        self.vertices.resize(triangles.order.len(), f64::INFINITY);
        self.buckets.reset(n, triangles.bucket_width, triangles.longest);
        self.lowered.clear();
        self.hubs.clear();
        self.hubs.resize(triangles.n_hubs, f64::INFINITY);
        self.visits = VISITS_PER_TRIANGLE.saturating_mul(n);
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
        self.apply();
    }

    /// Starts from a point inside those triangles at a vertex all of whose vertices are at a known straight distance.
    fn start_inside(&mut self, triangles: &Triangles, vertex: u32, straight: impl Fn(u32) -> Option<f64>) {
        for corner in triangles.corners.row(vertex as usize) {
            let number = corner / 3;
            let triangle = triangles.at(number);
            let [Some(a), Some(b), Some(c)] = triangle.vertices.map(&straight) else { continue };
            let from = [a, b, c];
            // A label leaves through two sides, so the point needs one more to leave through the third.
            for slot in [0, 1] {
                let entry = EntrySide::new(3 * number + slot, false);
                let [left, right, apex] = entry.corners();
                let entered = triangle.entered(entry);
                let window = SourceWindow::around(plane::apex([entered.base, from[left], from[right]]), 0.0);
                let error = window.distance(entered.apex) - from[apex];
                if error.is_nan() || error.abs() > SAME_POINT * triangles.longest {
                    break;
                }
                let label = TriangleLabel { window, entry };
                if slot == 0 {
                    self.candidates
                        .push(WindowOffer { distance: window.distance(entered.centroid()), label });
                } else {
                    self.cross(triangles, number, &label, false);
                    self.cross(triangles, number, &label, true);
                }
            }
        }
        self.solve_crossings();
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
        let Some(side) = around(slot).into_iter().find(|side| triangle.lengths[*side] > 0.0) else { return };
        let entry = EntrySide::new(3 * number + side as u32, false);
        let entered = triangle.entered(entry);
        let at = if entry.corners()[0] == slot { [0.0, 0.0] } else { [entered.base, 0.0] };
        let window = SourceWindow::around(at, offset);
        let distance = window.distance(entered.centroid());
        if !stops(number, distance) && improves(distance, self.distances[number as usize]) {
            self.candidates.push(WindowOffer { distance, label: TriangleLabel { window, entry } });
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
        loop {
            self.march(triangles, budget, &stops)?;
            let has_unreached = self.reach_vertices(triangles);
            self.relax_edges(triangles, budget)?;
            for joint in &triangles.joints {
                let offset = self.vertices[*joint as usize];
                if offset.is_finite() {
                    self.start_around(triangles, *joint, offset, &stops);
                }
            }
            if has_unreached {
                for number in 0..triangles.triangles.len() as u32 {
                    if self.distances[number as usize] == f64::INFINITY {
                        for (slot, vertex) in (0..).zip(triangles.at(number).vertices) {
                            let offset = self.vertices[vertex as usize];
                            if offset.is_finite() {
                                self.start_at(triangles, 3 * number + slot, offset, &stops);
                            }
                        }
                    }
                }
            }
            if self.candidates.is_empty() || self.visits == 0 {
                self.candidates.clear();
                return budget.check();
            }
            self.apply();
        }
    }

    fn march(
        &mut self,
        triangles: &Triangles,
        budget: &Budget,
        stops: impl Fn(u32, f64) -> bool,
    ) -> Result<(), Exceeded> {
        let mut meter = budget.meter();
        loop {
            let distances = &self.distances;
            if self.buckets.next_round(&mut self.round, |t| distances[t as usize]).is_none() {
                return Ok(());
            }
            meter.count(OPERATIONS * (1 + self.round.len()))?;
            self.visits = self.visits.saturating_sub(self.round.len());
            let round = std::mem::take(&mut self.round);
            for number in &round {
                prefetch(std::slice::from_ref(triangles.at(*number)));
                prefetch(std::slice::from_ref(&self.labels[*number as usize]));
            }
            for number in &round {
                for corner in triangles.at(*number).across {
                    prefetch(std::slice::from_ref(triangles.at(corner / 3)));
                    prefetch(std::slice::from_ref(&self.distances[corner as usize / 3]));
                }
            }
            for number in &round {
                if stops(*number, self.distances[*number as usize]) {
                    continue;
                }
                let label = self.labels[*number as usize];
                self.cross(triangles, *number, &label, false);
                self.cross(triangles, *number, &label, true);
            }
            self.round = round;
            self.solve_crossings();
        }
    }

    /// Adds the crossings of the side of a triangle on the left or right of its entry.
    #[inline]
    fn cross(&mut self, triangles: &Triangles, number: u32, label: &TriangleLabel, is_right: bool) {
        let triangle = triangles.at(number);
        let [left, right, apex] = label.entry.corners();
        let (start, side) = if is_right { (apex, left) } else { (left, right) };
        let length = triangle.lengths[side];
        let own = 3 * number + side as u32;
        let mut corner = triangle.across[side];
        if triangles.at(corner / 3).across[corner as usize % 3] != own
            && let Some(hub) = triangles.hubs.get(&own)
        {
            let middle = label.window.middle_distance(triangle.entered(label.entry), is_right);
            let known = &mut self.hubs[*hub as usize];
            if middle.is_nan() || middle >= *known * (1.0 - ROUNDING) {
                return;
            }
            *known = middle;
        }
        while corner != own {
            let behind = triangles.at(corner / 3);
            let slot = corner as usize % 3;
            if length > 0.0 {
                let is_mirrored = behind.vertices[around(slot)[0]] != triangle.vertices[start];
                let entry = EntrySide::new(corner, is_mirrored);
                let (block, lane) = (self.n_crossings / LANES, self.n_crossings % LANES);
                if block == self.crossings.len() {
                    self.crossings.push(Crossings::default());
                }
                let crossing = Crossing {
                    window: &label.window,
                    from: triangle.sides(label.entry),
                    is_right,
                    to: behind.sides(entry),
                    bends: behind.bends(entry),
                    entry: entry.number(),
                };
                self.crossings[block].set(lane, crossing);
                self.n_crossings += 1;
            }
            corner = behind.across[slot];
        }
    }

    /// Solves all crossings and improves the triangles behind them.
    fn solve_crossings(&mut self) {
        let blocks = &mut self.crossings[..self.n_crossings.div_ceil(LANES)];
        self.instructions.dispatch(|| blocks.iter_mut().for_each(Crossings::solve));
        for first in (0..self.n_crossings).step_by(LANES) {
            let block = &self.crossings[first / LANES];
            for lane in 0..LANES.min(self.n_crossings - first) {
                let entry = EntrySide::numbered(block.entry[lane]);
                let distance = block.distance(lane);
                let state = (&mut self.distances[..], &mut self.labels[..], &mut self.buckets);
                improve(state, distance, entry, self.visits > 0, || block.window(lane));
            }
        }
        self.n_crossings = 0;
    }

    /// Improves triangles at starts.
    fn apply(&mut self) {
        for WindowOffer { distance, label } in self.candidates.drain(..) {
            let state = (&mut self.distances[..], &mut self.labels[..], &mut self.buckets);
            improve(state, distance, label.entry, self.visits > 0, || label.window);
        }
    }

    /// Lowers the vertices of all triangles to their distances. Returns whether some triangle was not reached.
    fn reach_vertices(&mut self, triangles: &Triangles) -> bool {
        let mut has_unreached = false;
        let mut views = Views::default();
        let numbers = 0..triangles.triangles.len();
        for first in numbers.clone().step_by(LANES) {
            let some = first..numbers.end.min(first + LANES);
            for (lane, number) in some.clone().enumerate() {
                let label = &self.labels[number];
                let is_reached = self.distances[number] < f64::INFINITY;
                has_unreached |= !is_reached;
                views.set(lane, &label.window, triangles.triangles[number].sides(label.entry), is_reached);
            }
            self.instructions.dispatch(|| views.solve());
            for (lane, number) in some.enumerate() {
                let triangle = &triangles.triangles[number];
                for (corner, distance) in
                    self.labels[number].entry.corners().into_iter().zip(views.distances(lane))
                {
                    let known = &mut self.vertices[triangle.vertices[corner] as usize];
                    *known = if distance < *known { distance } else { *known };
                }
            }
        }
        has_unreached
    }

    /// Lowers vertices along edges and links.
    fn relax_edges(&mut self, triangles: &Triangles, budget: &Budget) -> Result<(), Exceeded> {
        for triangle in &triangles.triangles {
            let at = triangle.vertices.map(|v| self.vertices[v as usize]);
            let too_long = [0, 1, 2].map(|side| {
                let [a, b] = around(side).map(|end| at[end]);
                let [near, far] = if a < b { [a, b] } else { [b, a] };
                improves(near + triangle.lengths[side], far)
            });
            if too_long[0] | too_long[1] | too_long[2] {
                for side in 0..3 {
                    let [a, b] = around(side).map(|end| triangle.vertices[end]);
                    self.relax(a, b, triangle.lengths[side]);
                    self.relax(b, a, triangle.lengths[side]);
                }
            }
        }
        for vertex in 0..triangles.links.n_rows() as u32 {
            for (end, length) in triangles.links.row(vertex as usize) {
                self.relax(vertex, *end, *length);
            }
        }
        let mut meter = budget.meter();
        while let Some(Reverse((at, vertex))) = self.lowered.pop() {
            if f64::from_bits(at) > self.vertices[vertex as usize] {
                continue;
            }
            for (end, length) in triangles.ways_from(vertex) {
                meter.count(1)?;
                self.relax(vertex, end, length);
            }
        }
        Ok(())
    }

    /// Lowers a vertex to the distance of another and the length of the way between them, if that is less.
    #[inline]
    fn relax(&mut self, from: u32, to: u32, length: f64) {
        let distance = self.vertices[from as usize] + length;
        let known = &mut self.vertices[to as usize];
        if improves(distance, *known) {
            *known = distance;
            self.lowered.push(Reverse((distance.to_bits(), to)));
        }
    }

    /// The distance of a vertex.
    #[inline]
    pub(crate) fn distance(&self, vertex: u32) -> f64 {
        self.vertices[vertex as usize]
    }
}

/// Whether a distance is less than the known one by more than rounding.
#[inline]
fn improves(distance: f64, known: f64) -> bool {
    distance < known * (1.0 - ROUNDING)
}

/// Gives a triangle another window, if that is nearer to the source, or sees as near but from a source that bent less.
/// A triangle that has one already keeps it unless the front `corrects`.
#[inline]
fn improve(
    (distances, labels, buckets): (&mut [f64], &mut [TriangleLabel], &mut Buckets),
    distance: f64,
    entry: EntrySide,
    corrects: bool,
    window: impl FnOnce() -> SourceWindow,
) {
    let number = entry.triangle();
    let (known, label) = (&mut distances[number as usize], &mut labels[number as usize]);
    if distance > *known * (1.0 + ROUNDING) || !(corrects || *known == f64::INFINITY) {
        return;
    }
    let window = window();
    if improves(distance, *known) || improves(window.offset, label.window.offset) {
        *known = distance;
        *label = TriangleLabel { window, entry };
        buckets.put(number, distance);
    }
}
