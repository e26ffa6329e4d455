//! New windows: from vertices where paths bend, and from sources.

use surface::{VertexId, Winding};

use super::faces::{Along, next};
use super::fan::Sector;
use super::frame::Frame;
use super::front::Arrival;
use super::wave::Wave;
use super::window::Window;
use crate::{Source, SurfacePoint};

/// Barycentric coordinates below this are zero: the point lies on the edge.
const ON_EDGE: f64 = 1e-12;

impl Wave<'_> {
    /// Starts the front at a source.
    pub(super) fn leave_source(&mut self, source: &Source) {
        let exact = self.exact;
        let unit = exact.surface.unit;
        let inside = |vertex: VertexId| exact.vertices[vertex.index()];
        for (vertex, distance) in source.reach() {
            self.front.reach(inside(*vertex), distance / unit, Arrival::Anywhere);
        }
        match source.point() {
            SurfacePoint::Vertex(_) => {}
            SurfacePoint::Edge { t, .. } => {
                if let [(a, _), (b, _), ..] = source.reach() {
                    self.leave_edge([inside(*a), inside(*b)], [1.0 - t, t]);
                }
            }
            SurfacePoint::Face { face, barycentric } => {
                let face = exact.faces[face.index()];
                let vertices = exact.surface.faces[face as usize].vertices;
                // A face that repeats another may have its corners in another order.
                let slot_of = |v: u32| source.reach().iter().position(|(w, _)| inside(*w) == v);
                let shares = vertices.map(|v| slot_of(v).map_or(0.0, |slot| barycentric[slot]));
                match shares.iter().position(|share| *share < ON_EDGE) {
                    None => self.leave_face(face, shares),
                    Some(slot) => {
                        let [a, b] = [next(slot), next(next(slot))];
                        self.leave_edge([vertices[a], vertices[b]], [shares[a], shares[b]]);
                    }
                }
            }
        }
    }

    /// Starts the front at a point between two vertices, in all faces on their edge.
    fn leave_edge(&mut self, ends: [u32; 2], shares: [f64; 2]) {
        let exact = self.exact;
        for corner in exact.fans.around(ends[0]) {
            let face = corner.corner.corner.face().0;
            let vertices = exact.surface.faces[face as usize].vertices;
            if vertices.contains(&ends[1]) {
                let share = |v| {
                    if v == ends[0] {
                        shares[0]
                    } else if v == ends[1] {
                        shares[1]
                    } else {
                        0.0
                    }
                };
                self.leave_face(face, vertices.map(share));
            }
        }
    }

    /// Starts the front at a point of a face: at its vertices, and over the edges that the point is
    /// not on.
    fn leave_face(&mut self, face: u32, barycentric: [f64; 3]) {
        for slot in 0..3 {
            let corner = 3 * face + slot as u32;
            if self.exact.surface.face(corner).lengths[slot] == 0.0 {
                continue;
            }
            let frame = Frame::new(&self.exact.surface, corner);
            let ([x, height], at) = (frame.apex, barycentric[slot]);
            let source = [at * x + barycentric[next(next(slot))] * frame.base, at * height];
            let distance = (x - source[0]).hypot(height - source[1]);
            self.front.reach(frame.vertices[2], distance, Arrival::Anywhere);
            if at >= ON_EDGE {
                let [x, depth] = source;
                let window = Window { start: 0.0, end: frame.base, x, depth, offset: 0.0, turn: 0 };
                self.cross_base(corner, &frame, window);
            }
        }
    }

    /// Sends windows from a vertex over the edges opposite it, as far as a path with this arrival
    /// may go on there, and over links.
    pub(super) fn leave_vertex(&mut self, vertex: u32, distance: f64, arrival: Arrival) {
        let exact = self.exact;
        let links = exact.links.partition_point(|link| link.0 < vertex);
        for (_, end, length) in exact.links[links..].iter().take_while(|link| link.0 == vertex) {
            self.front.reach(*end, distance + length, Arrival::Anywhere);
        }
        let fan = exact.fans.around(vertex);
        let Some(open) = exact.fans.open_angles(vertex, arrival) else {
            for corner in fan {
                self.leave_corner(corner.corner.corner.0, distance, [0.0, f64::INFINITY]);
            }
            return;
        };
        for Sector { corner, start, end } in fan {
            for [low, high] in open {
                if high > low && high > *start && low < *end {
                    let [low, high] = match corner.winding {
                        Winding::Forward => [low - start, high - start],
                        Winding::Backward => [end - high, end - low],
                    };
                    let high = if high < end - start { high } else { f64::INFINITY };
                    self.leave_corner(corner.corner.0, distance, [low, high]);
                }
            }
        }
    }

    /// A window from a corner onto its base between two angles from the side to the base's start,
    /// all of it up to zero and from infinity on.
    fn leave_corner(&mut self, corner: u32, distance: f64, [low, high]: [f64; 2]) {
        let face = self.exact.surface.face(corner);
        let slot = corner as usize % 3;
        let (a, b) = (next(slot), next(next(slot)));
        let through = |at: usize, [sin, cos]: [f64; 2]| {
            let corner = corner - slot as u32 + at as u32;
            Arrival::Through { corner, sin, cos }
        };
        // The vertex lies at the end of the base of the corner at `a`, and at the start of that at `b`.
        let from_end = [face.double_area, face.cosine(a)];
        self.front.reach(face.vertices[a], distance + face.lengths[b], through(a, from_end));
        self.front.reach(face.vertices[b], distance + face.lengths[a], through(b, [0.0, 1.0]));
        if face.lengths[slot] == 0.0 {
            return;
        }
        let frame = Frame::new(&self.exact.surface, corner);
        let [x, height] = frame.apex;
        let fall = |angle: f64| {
            let (sin, cos) = angle.sin_cos();
            let (along, down) = (height * sin - x * cos, x * sin + height * cos);
            // A ray that does not come down, by rounding, goes past the end it is nearer to.
            let at = if down > 0.0 { x + height * along / down } else { along * f64::INFINITY };
            at.max(0.0).min(frame.base)
        };
        self.cross_base(
            corner,
            &frame,
            Window {
                start: if low > 0.0 { fall(low) } else { 0.0 },
                end: if high < f64::INFINITY { fall(high) } else { frame.base },
                x,
                depth: height,
                offset: distance,
                turn: 0,
            },
        );
    }

    /// Hands a window on the base of a corner, seen from inside its face, to the faces beyond.
    fn cross_base(&mut self, corner: u32, frame: &Frame, window: Window) {
        if window.end <= window.start || self.budget == 0 {
            return;
        }
        self.budget -= 1;
        let [a, b, _] = frame.vertices;
        let beyond = self.exact.surface.face(corner).beyond[corner as usize % 3];
        self.exact.surface.for_each_facing(beyond, |facing| {
            let window = match facing.along {
                Along::Same => window,
                Along::Opposite => window.mirrored(frame.base),
            };
            self.front.deliver(facing.corner, [a, b], std::iter::once(window));
        });
    }
}
