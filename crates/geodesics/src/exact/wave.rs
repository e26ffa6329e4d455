//! How the front advances.

use surface::VertexKind;

use super::Exact;
use super::apex::{Apex, Passes};
use super::envelope::trim;
use super::faces::{Along, Facing, next};
use super::frame::{Frame, Until};
use super::front::{Arrival, Front};
use super::window::Window;

/// Memory that runs share.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    pub(super) front: Front,
    /// Windows on the way into a face.
    arrived: Vec<Window>,
    /// Windows on the way out of it, on either side of its apex.
    left: Vec<Window>,
    right: Vec<Window>,
}

/// One run of the front over a surface.
pub(super) struct Wave<'a> {
    pub(super) exact: &'a Exact,
    pub(super) front: &'a mut Front,
    left: &'a mut Vec<Window>,
    right: &'a mut Vec<Window>,
    /// Beyond this, windows need not be followed.
    max_distance: f64,
    /// How many windows may still enter a face.
    pub(super) budget: usize,
}

/// Windows that may enter a face on the average before the run is given up; real surfaces of a
/// million vertices need less than a hundred. It takes needles with angles below 1e-6 around one
/// vertex to come near.
const BUDGET_PER_FACE: usize = 10_000;

/// Share of the limit by which windows beyond it are followed, for rounding.
const LIMIT_SLACK: f64 = 1e-9;

/// Share of a distance by which it may be longer than one along an edge, for rounding.
const EDGE_SLACK: f64 = 1e-13;

/// Lets the front run from what `start` gives it over everything within `max_distance`.
pub(super) fn run(exact: &Exact, scratch: &mut Scratch, max_distance: f64, start: impl FnOnce(&mut Wave)) {
    let Scratch { front, arrived, left, right } = scratch;
    let budget = BUDGET_PER_FACE.saturating_mul(exact.surface.faces.len());
    let max_distance = max_distance * (1.0 + LIMIT_SLACK);
    let mut wave = Wave { exact, front, left, right, max_distance, budget };
    start(&mut wave);
    loop {
        wave.advance(arrived);
        if !wave.relax_edges() {
            break;
        }
    }
}

impl Wave<'_> {
    fn advance(&mut self, arrived: &mut Vec<Window>) {
        // The way to a vertex within the limit may cross an edge between two vertices beyond it.
        let last = self.max_distance + self.exact.surface.longest_edge;
        while let Some((distance, vertex)) = self.front.pop() {
            if distance > last {
                break;
            }
            let arrival = self.front.arrival(vertex);
            if arrival == Arrival::Anywhere || self.exact.fans.kind(vertex) != VertexKind::Ordinary {
                self.leave_vertex(vertex, distance, arrival);
            }
            self.front.release(vertex);
            while let Some(corner) = self.front.next_ready(arrived) {
                self.enter_face(corner, arrived);
            }
        }
    }

    /// Whether some vertex is nearer along an edge than it was thought to be: light does not find
    /// its way through faces whose lengths belong to no triangle.
    fn relax_edges(&mut self) -> bool {
        let mut is_any = false;
        for face in &self.exact.surface.faces {
            for slot in 0..3 {
                let ends = [next(slot), next(next(slot))].map(|end| face.vertices[end]);
                let [p, q] = ends.map(|v| self.front.distance(v));
                let (near, far, vertex) = if p < q { (p, q, ends[1]) } else { (q, p, ends[0]) };
                let along = near + face.lengths[slot];
                if along < far - EDGE_SLACK * far.min(f64::MAX) && along <= self.max_distance {
                    self.front.reach(vertex, along, Arrival::Anywhere);
                    is_any = true;
                }
            }
        }
        is_any
    }

    /// Takes the windows at the base of a corner through its face.
    fn enter_face(&mut self, corner: u32, windows: &mut Vec<Window>) {
        let frame = Frame::new(&self.exact.surface, corner);
        let [a, b, c] = frame.vertices;
        let ends = [self.front.distance(a), self.front.distance(b)];
        if self.max_distance < f64::INFINITY {
            windows.retain(|window| window.least_distance() <= self.max_distance);
        }
        trim(windows, frame.base, ends);
        if windows.len() > self.budget {
            return;
        }
        self.budget -= windows.len();

        let through = |[sin, cos]: [f64; 2]| Arrival::Through { corner, sin, cos };
        self.front.reach(c, ends[0] + frame.sides[0], through([0.0, 1.0]));
        if ends[1] + frame.sides[1] < self.front.distance(c) {
            let face = self.exact.surface.face(corner);
            let angle = [face.double_area, face.cosine(corner as usize % 3)];
            self.front.reach(c, ends[1] + frame.sides[1], through(angle));
        }
        let apex = self.cast(&frame, windows);
        if apex.distance < self.front.distance(c) {
            self.front.reach(c, apex.distance, through(apex.direction()));
        }
        self.hand_on(&frame);
    }

    /// Casts windows, in order along the base, onto the two sides of a face.
    fn cast(&mut self, frame: &Frame, windows: &[Window]) -> Apex {
        let mut apex = Apex::new(frame);
        self.left.clear();
        self.right.clear();
        // First come those that fall on `ac` alone, ...
        let mut first = 0;
        while first < windows.len() && apex.passes(&windows[first]) == Passes::Left {
            self.cast_left(frame, &windows[first], windows[first].end, Until::Ray);
            first += 1;
        }
        // ... then those that `c` sees, of which the nearest must be known before any is split, ...
        if first > 0 {
            apex.look_at(first - 1, &windows[first - 1]);
        }
        let mut rest = first;
        while rest < windows.len() {
            apex.look_at(rest, &windows[rest]);
            if apex.passes(&windows[rest]) == Passes::Right {
                break;
            }
            rest += 1;
        }
        for (i, window) in windows.iter().enumerate().take(rest).skip(first) {
            self.split(frame, &apex, i, window);
        }
        // ... then those that fall on `bc` alone, but for windows that overlap.
        for (i, window) in windows.iter().enumerate().skip(rest) {
            if apex.passes(window) == Passes::Right {
                self.cast_right(frame, window, window.start, Until::Ray);
            } else {
                apex.look_at(i, window);
                self.split(frame, &apex, i, window);
            }
        }
        apex
    }

    /// Casts a window onto whichever sides it falls on.
    fn split(&mut self, frame: &Frame, apex: &Apex, index: usize, window: &Window) {
        match apex.passes(window) {
            Passes::Left => self.cast_left(frame, window, window.end, Until::Ray),
            Passes::Right => self.cast_right(frame, window, window.start, Until::Ray),
            Passes::Both => {
                let at = apex.crossing(window);
                // A path that crosses a shorter one to `c` is not the shortest.
                let nearest = apex.nearest.is_none_or(|nearest| nearest == index);
                let entry = if nearest { at } else { apex.entry };
                if entry < at {
                    self.cast_left(frame, window, entry, Until::Ray);
                } else {
                    self.cast_left(frame, window, at, Until::Apex);
                }
                if entry > at {
                    self.cast_right(frame, window, entry, Until::Ray);
                } else {
                    self.cast_right(frame, window, at, Until::Apex);
                }
            }
        }
    }

    /// A shortest path crosses no face twice, so it turns around no vertex for more faces than the
    /// vertex has: `max_turn` bounds how often light goes round a needle.
    #[inline]
    fn cast_left(&mut self, frame: &Frame, window: &Window, end: f64, until: Until) {
        if end > window.start && window.turn < self.exact.max_turn {
            frame.cast_on_ac(window, [window.start, end], until, self.left);
        }
    }

    #[inline]
    fn cast_right(&mut self, frame: &Frame, window: &Window, start: f64, until: Until) {
        if start < window.end && -window.turn < self.exact.max_turn {
            frame.cast_on_cb(window, [start, window.end], until, self.right);
        }
    }

    /// Hands the windows that leave a face on to the faces beyond.
    fn hand_on(&mut self, frame: &Frame) {
        let [a, b, c] = frame.vertices;
        let sides = [(&mut *self.left, [a, c]), (&mut *self.right, [b, c])];
        for (side, (windows, ends)) in sides.into_iter().enumerate() {
            if windows.is_empty() {
                continue;
            }
            let (surface, beyond) = (&self.exact.surface, frame.beyond[side]);
            if let Some(Facing { corner, along: Along::Opposite }) = surface.only_facing(beyond) {
                self.front.deliver_all(corner, ends, windows);
                continue;
            }
            surface.for_each_facing(beyond, |facing| match facing.along {
                Along::Opposite => self.front.deliver(facing.corner, ends, windows.iter().copied()),
                Along::Same => {
                    let mirrored = windows.iter().rev().map(|w| w.mirrored(frame.sides[side]));
                    self.front.deliver(facing.corner, ends, mirrored);
                }
            });
        }
    }
}
