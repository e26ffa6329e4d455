//! New windows, from sources and from vertices where paths bend.

use surface::{CornerId, FaceId, SurfacePoint, VertexId, Winding};

use super::bearing::Bearing;
use super::prepared::{Along, Arrival, FaceFrame, FanSector};
use super::propagation::Propagation;
use super::window::PathWindow;
use crate::plane::around;
use crate::source::Source;

impl<D: Bearing> Propagation<'_, D> {
    /// Starts at a source.
    pub(super) fn start_at(&mut self, source: &Source) {
        let surface = self.surface;
        let new = |vertex: VertexId| surface.new_vertices[vertex.index()];
        for (vertex, distance) in source.reach() {
            let bearing = match source.point() {
                SurfacePoint::Vertex(_) => D::default(),
                _ => D::default().along_edge(self.around, new(*vertex)),
            };
            self.front.reach(new(*vertex), distance / surface.faces.unit, Arrival::Anywhere, bearing);
        }
        let shares = match source.point() {
            SurfacePoint::Vertex(_) => return,
            SurfacePoint::Edge { t, .. } => vec![1.0 - t, t],
            SurfacePoint::Face { barycentric, .. } => barycentric.to_vec(),
        };
        // The vertices of its edge or face come first, and only faces that hold the point have them all.
        let own: Vec<u32> = source.reach().iter().take(shares.len()).map(|(v, _)| new(*v)).collect();
        for sector in surface.fans.around(own[0]) {
            let face = sector.corner.corner.face();
            let vertices = surface.faces.of(face).vertices;
            if own.iter().all(|v| vertices.contains(v)) {
                let share = |v| own.iter().position(|end| *end == v).map_or(0.0, |i| shares[i]);
                self.start_in_face(face, vertices.map(share));
            }
        }
    }

    /// Starts at a point of a face: reaches its vertices, and emits windows over the sides that the point is not on.
    fn start_in_face(&mut self, face: FaceId, barycentric: [f64; 3]) {
        for corner in face.corners() {
            let slot = corner.slot();
            if self.surface.face(corner).lengths[slot] == 0.0 {
                continue;
            }
            let frame = FaceFrame::new(&self.surface.faces, corner);
            let ([x, height], at) = (frame.apex, barycentric[slot]);
            let source = [at * x + barycentric[around(slot)[1]] * frame.base, at * height];
            let distance = (x - source[0]).hypot(height - source[1]);
            let apex = frame.vertices[2];
            self.front.reach(apex, distance, Arrival::Anywhere, D::default().along_edge(self.around, apex));
            if at > 0.0 {
                let [x, depth] = source;
                let bearing = D::default().emitted(self.around, corner, &frame);
                let window =
                    PathWindow { start: 0.0, end: frame.base, x, depth, offset: 0.0, turn: 0, bearing };
                self.emit_over_base(corner, &frame, window);
            }
        }
    }

    /// Emits windows from a vertex over links and the edges opposite it, where a path with this arrival may continue.
    pub(super) fn emit_from(&mut self, vertex: u32, distance: f64, arrival: Arrival, bearing: D) {
        let surface = self.surface;
        for link in surface.links.ways(VertexId(vertex)) {
            let distance = distance + link.length / surface.faces.unit;
            self.front.reach(link.to.0, distance, Arrival::Anywhere, bearing.over_link());
        }
        let fan = surface.fans.around(vertex);
        let Some(open) = surface.fans.open_angles(vertex, arrival) else {
            for sector in fan {
                self.emit_from_corner(sector.corner.corner, (distance, bearing), [0.0, f64::INFINITY]);
            }
            return;
        };
        for FanSector { corner, start, end } in fan {
            for [low, high] in open {
                if high > low && high > *start && low < *end {
                    let [low, high] = match corner.winding {
                        Winding::Forward => [low - start, high - start],
                        Winding::Backward => [end - high, end - low],
                    };
                    let high = if high < end - start { high } else { f64::INFINITY };
                    self.emit_from_corner(corner.corner, (distance, bearing), [low, high]);
                }
            }
        }
    }

    /// Emits a window from a corner onto its base, between angles from the side to the base's start; zero and
    /// infinity mean no bound.
    fn emit_from_corner(&mut self, corner: CornerId, (distance, bearing): (f64, D), [low, high]: [f64; 2]) {
        let face = self.surface.face(corner);
        let slot = corner.slot();
        let [a, b] = around(slot);
        let through = |at: usize, [sin, cos]: [f64; 2]| Arrival::Through {
            corner: CornerId::new(corner.face(), at),
            sin,
            cos,
        };
        // The vertex is at the end of the base of the corner at `a`, and at the start of that at `b`.
        let from_end = [face.twice_area, face.cosine(a)];
        let (at_a, at_b) = (face.vertices[a], face.vertices[b]);
        let [to_a, to_b] = [at_a, at_b].map(|end| bearing.along_edge(self.around, end));
        self.front.reach(at_a, distance + face.lengths[b], through(a, from_end), to_a);
        self.front.reach(at_b, distance + face.lengths[a], through(b, [0.0, 1.0]), to_b);
        if face.lengths[slot] == 0.0 {
            return;
        }
        let frame = FaceFrame::new(&self.surface.faces, corner);
        let [x, height] = frame.apex;
        let meet_base = |angle: f64| {
            let (sin, cos) = angle.sin_cos();
            let (along, down) = (height * sin - x * cos, x * sin + height * cos);
            // A ray that rounding keeps from descending passes the nearer end.
            let at = if down > 0.0 { x + height * along / down } else { along * f64::INFINITY };
            at.max(0.0).min(frame.base)
        };
        let bearing = bearing.emitted(self.around, corner, &frame);
        let start = if low > 0.0 { meet_base(low) } else { 0.0 };
        let end = if high < f64::INFINITY { meet_base(high) } else { frame.base };
        self.emit_over_base(
            corner,
            &frame,
            PathWindow { start, end, x, depth: height, offset: distance, turn: 0, bearing },
        );
    }

    /// Delivers a window on the base of a corner, given from inside its face, to the faces beyond.
    fn emit_over_base(&mut self, corner: CornerId, frame: &FaceFrame, window: PathWindow<D>) {
        if window.end <= window.start {
            return;
        }
        self.steps_left = self.steps_left.and_then(|left| left.checked_sub(1));
        if self.steps_left.is_none() {
            return;
        }
        let [a, b, _] = frame.vertices;
        self.surface.faces.for_each_facing(corner, |facing, along| {
            let window = match along {
                Along::Same => window,
                Along::Opposite => window.mirrored(frame.base),
            };
            self.front.deliver(facing, [a, b], std::iter::once(window));
        });
    }
}
