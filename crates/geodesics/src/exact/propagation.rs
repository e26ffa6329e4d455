//! The main loop: windows are propagated in the order of the vertices that they wait for.

use base::{Budget, Exceeded, Meter};
use surface::{CornerId, VertexKind};

use super::bearing::Bearing;
use super::envelope::trim;
use super::front::WindowFront;
use super::prepared::{Along, Arrival, FaceFrame, PreparedSurface};
use super::window::{Apex, Passes, PathWindow, Until};
use crate::plane::around;
use crate::source::Source;

/// Memory that runs share.
#[derive(Debug, Default)]
pub(super) struct ExactScratch<D = ()> {
    front: WindowFront<D>,
    /// Windows on the base of a face.
    arrived: Vec<PathWindow<D>>,
    /// Windows on its sides, left and right of its apex.
    left: Vec<PathWindow<D>>,
    right: Vec<PathWindow<D>>,
}

/// Share of the limit by which windows beyond it are propagated, for rounding.
const LIMIT_SLACK: f64 = 1e-9;

/// Share of a distance by which it may be longer than one along an edge, for rounding.
const EDGE_SLACK: f64 = 1e-13;

/// Operations that a window counts for in the meter of a budget.
const OPERATIONS: usize = 16;

/// Finds the distances, in units of the surface, of all vertices within `max_distance`, in mesh units, of the nearest source.
///
/// # Errors
/// [`Exceeded`]; windows have their share of the memory of the budget.
pub(super) fn run<'a, D: Bearing>(
    surface: &PreparedSurface,
    scratch: &'a mut ExactScratch<D>,
    max_distance: f64,
    (sources, around): (&[Source], &D::Source),
    limits: &Budget,
) -> Result<&'a WindowFront<D>, Exceeded> {
    let ExactScratch { front, arrived, left, right } = scratch;
    front.reset(surface.n_vertices(), 3 * surface.faces.all.len(), limits);
    let max_distance = max_distance / surface.faces.unit * (1.0 + LIMIT_SLACK);
    let (steps_left, meter) = (Some(surface.max_windows), limits.meter());
    let mut propagation =
        Propagation { surface, around, front, steps_left, left, right, max_distance, meter };
    sources.iter().for_each(|source| propagation.start_at(source));
    loop {
        let result = propagation.advance(arrived);
        if let Err(Exceeded::Memory { .. } | Exceeded::Allocation { .. }) = result {
            *propagation.front = WindowFront::default();
        }
        result?;
        limits.check()?;
        // Without the windows beyond, distances may be too long.
        if propagation.steps_left.is_none() {
            return Err(Exceeded::Steps { limit: surface.max_windows });
        }
        if !propagation.relax_edges() {
            break;
        }
    }
    Ok(front)
}

/// One run over a surface.
pub(super) struct Propagation<'a, D: Bearing> {
    pub(super) surface: &'a PreparedSurface,
    /// What is known of the source.
    pub(super) around: &'a D::Source,
    pub(super) front: &'a mut WindowFront<D>,
    /// How many windows may still be emitted or propagated; `None` once there were more.
    pub(super) steps_left: Option<usize>,
    left: &'a mut Vec<PathWindow<D>>,
    right: &'a mut Vec<PathWindow<D>>,
    /// Windows beyond this need not be propagated.
    max_distance: f64,
    meter: Meter<'a>,
}

impl<D: Bearing> Propagation<'_, D> {
    fn advance(&mut self, arrived: &mut Vec<PathWindow<D>>) -> Result<(), Exceeded> {
        // The path to a vertex within the limit may cross an edge between two vertices beyond it.
        let last = self.max_distance + self.surface.faces.longest_edge;
        while let Some((distance, vertex)) = self.front.pop() {
            if distance > last {
                break;
            }
            let (arrival, bearing) = self.front.arrival(vertex);
            let kind = self.surface.fans.kind(vertex);
            if arrival == Arrival::Anywhere || kind != VertexKind::Ordinary {
                self.emit_from(vertex, distance, arrival, bearing);
            }
            self.front.release(vertex);
            while let Some(corner) = self.front.next_ready(arrived) {
                self.enter_face(corner, arrived);
                self.check()?;
            }
            self.check()?;
        }
        Ok(())
    }

    #[inline]
    fn check(&mut self) -> Result<(), Exceeded> {
        self.front.check_memory()?;
        self.meter.count(OPERATIONS * self.front.take_work())
    }

    /// Relaxes all edges; returns whether a label was lowered. Needed for faces that violate the triangle inequality,
    /// through which no window passes.
    fn relax_edges(&mut self) -> bool {
        let mut is_any = false;
        let front = &mut *self.front;
        for face in &self.surface.faces.all {
            for slot in 0..3 {
                let ends = around(slot).map(|end| face.vertices[end]);
                let [p, q] = ends.map(|v| front.distance(v));
                let (near, far, [from, to]) = if p < q { (p, q, ends) } else { (q, p, [ends[1], ends[0]]) };
                let along = near + face.lengths[slot];
                if along < far - EDGE_SLACK * far.min(f64::MAX) && along <= self.max_distance {
                    let bearing = front.arrival(from).1.along_edge(self.around, to);
                    front.reach(to, along, Arrival::Anywhere, bearing);
                    is_any = true;
                }
            }
        }
        is_any
    }

    /// Propagates the windows at the base of a corner across its face.
    fn enter_face(&mut self, corner: CornerId, windows: &mut Vec<PathWindow<D>>) {
        let Self { surface, around, front, steps_left, max_distance, .. } = &mut *self;
        let frame = FaceFrame::new(&surface.faces, corner);
        let [a, b, c] = frame.vertices;
        let ends = [front.distance(a), front.distance(b)];
        if *max_distance < f64::INFINITY {
            windows.retain(|window| window.least_distance() <= *max_distance);
        }
        trim(windows, frame.base, ends);
        *steps_left = steps_left.and_then(|left| left.checked_sub(windows.len()));
        if steps_left.is_none() {
            return;
        }

        let through = |[sin, cos]: [f64; 2]| Arrival::Through { corner, sin, cos };
        for (i, end) in [a, b].into_iter().enumerate() {
            let along = ends[i] + frame.sides[i];
            if along < front.distance(c) {
                let face = surface.face(corner);
                let angle = if i == 0 { [0.0, 1.0] } else { [face.twice_area, face.cosine(corner.slot())] };
                let bearing = front.arrival(end).1.along_edge(around, c);
                front.reach(c, along, through(angle), bearing);
            }
        }
        let apex = self.propagate(&frame, windows);
        let front = &mut *self.front;
        if let Some(nearest) = apex.nearest.filter(|_| apex.distance < front.distance(c)) {
            let bearing = windows[nearest].bearing.towards(apex.ray(&windows[nearest]));
            front.reach(c, apex.distance, through(apex.direction()), bearing);
        }
        self.deliver(corner, &frame);
    }

    /// Propagates windows, in order along the base, to the two sides of a face.
    fn propagate(&mut self, frame: &FaceFrame, windows: &[PathWindow<D>]) -> Apex {
        let mut apex = Apex::new(frame);
        self.left.clear();
        self.right.clear();
        // First the windows that reach only `ac`, ...
        let mut first = 0;
        while first < windows.len() && apex.passes(&windows[first]) == Passes::Left {
            self.push_left(frame, &windows[first], windows[first].end, Until::Ray);
            first += 1;
        }
        // ... then those with a path to `c`, of which the nearest must be known before any is split, ...
        if first > 0 {
            apex.consider(first - 1, &windows[first - 1]);
        }
        let mut rest = first;
        while rest < windows.len() {
            apex.consider(rest, &windows[rest]);
            if apex.passes(&windows[rest]) == Passes::Right {
                break;
            }
            rest += 1;
        }
        for (i, window) in windows.iter().enumerate().take(rest).skip(first) {
            self.split(frame, &apex, i, window);
        }
        // ... then those that reach only `bc`, except where windows overlap.
        for (i, window) in windows.iter().enumerate().skip(rest) {
            if apex.passes(window) == Passes::Right {
                self.push_right(frame, window, window.start, Until::Ray);
            } else {
                apex.consider(i, window);
                self.split(frame, &apex, i, window);
            }
        }
        apex
    }

    /// Propagates a window to whichever sides it reaches.
    fn split(&mut self, frame: &FaceFrame, apex: &Apex, index: usize, window: &PathWindow<D>) {
        match apex.passes(window) {
            Passes::Left => self.push_left(frame, window, window.end, Until::Ray),
            Passes::Right => self.push_right(frame, window, window.start, Until::Ray),
            Passes::Both => {
                let at = apex.crossing(window);
                // A path that crosses a shorter one to `c` is not the shortest.
                let nearest = apex.nearest.is_none_or(|nearest| nearest == index);
                let entry = if nearest { at } else { apex.entry };
                if entry < at {
                    self.push_left(frame, window, entry, Until::Ray);
                } else {
                    self.push_left(frame, window, at, Until::Apex);
                }
                if entry > at {
                    self.push_right(frame, window, entry, Until::Ray);
                } else {
                    self.push_right(frame, window, at, Until::Apex);
                }
            }
        }
    }

    /// A shortest path crosses no face twice, so it crosses at most all faces of a vertex in a row: `max_turn` bounds
    /// how often windows circle around the tip of a needle.
    #[inline]
    fn push_left(&mut self, frame: &FaceFrame, window: &PathWindow<D>, end: f64, until: Until) {
        if end > window.start && window.turn < self.surface.max_turn {
            let part = PathWindow { end, ..*window };
            self.left.extend(part.projected(frame.from_a, frame.sides[0], until));
        }
    }

    #[inline]
    fn push_right(&mut self, frame: &FaceFrame, window: &PathWindow<D>, start: f64, until: Until) {
        if start < window.end && -window.turn < self.surface.max_turn {
            // The apex is at the start of the side.
            let (part, side) = (PathWindow { start, ..*window }.mirrored(frame.base), frame.sides[1]);
            self.right.extend(part.projected(frame.from_b, side, until).map(|part| part.mirrored(side)));
        }
    }

    /// Delivers the windows on the sides of a face to the faces beyond.
    fn deliver(&mut self, corner: CornerId, frame: &FaceFrame) {
        let [a, b, c] = frame.vertices;
        let Self { surface, front, left, right, .. } = self;
        let sides = [(&*left, corner.prev(), [a, c]), (&*right, corner.next(), [b, c])];
        for ((windows, own, ends), length) in sides.into_iter().zip(frame.sides) {
            if windows.is_empty() {
                continue;
            }
            surface.faces.for_each_facing(own, |facing, along| match along {
                Along::Opposite => front.deliver(facing, ends, windows.iter().copied()),
                Along::Same => {
                    let mirrored = windows.iter().rev().map(|w| w.mirrored(length));
                    front.deliver(facing, ends, mirrored);
                }
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use mesh::shapes;
    use surface::VertexId;

    use super::*;

    #[test]
    fn a_run_that_lacks_windows_is_an_error() {
        let mut surface = PreparedSurface::new(&shapes::torus(12, 8, 2.0, 0.7).intrinsic());
        let source = [Source::vertex(VertexId(5))];
        let mut solve = |most| {
            surface.max_windows = most;
            let mut scratch = ExactScratch::<()>::default();
            let limits = Budget::unlimited();
            let front = run(&surface, &mut scratch, f64::INFINITY, (&source, &()), &limits)?;
            Ok::<Vec<f64>, Exceeded>((0..96).map(|v| front.distance(v)).collect())
        };
        let n_missing =
            (0..2_000).take_while(|most| solve(*most) == Err(Exceeded::Steps { limit: *most })).count();
        assert!((100..2_000).contains(&n_missing), "{n_missing}");
        assert!((n_missing..2_000).all(|most| solve(most) == solve(usize::MAX)));
    }
}
