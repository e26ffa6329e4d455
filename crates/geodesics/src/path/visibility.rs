//! The visible vertex over which the source is nearest.

use surface::{EdgeId, FaceId, NearestFirst, VertexId};

use super::field::PathField;
use super::plane::{Flat, faces_around};
use super::strip::{Gate, Portal, Strip};
use crate::plane::{GateSide, PlanePoint, between, beyond, cross, distance, dot, sub};
use surface::SurfacePoint;

/// Share of a length within which two are the same up to rounding.
const SAME: f64 = 1e-12;

/// The rays from a point that cross one edge after the same faces, in the plane with that point in the origin.
#[derive(Debug, Clone, Copy)]
struct Rays {
    /// The bundle that they are part of.
    before: Option<usize>,
    /// The face that they cross, and the edge they leave it by.
    face: FaceId,
    edge: EdgeId,
    gate: Gate,
    /// Points on the outermost rays on either side.
    left: PlanePoint,
    right: PlanePoint,
}

struct SightSearch<'a> {
    field: &'a PathField<'a>,
    rays: Vec<Rays>,
    /// The largest number of bundles allowed.
    most: usize,
    /// Bundles by the least length of a path along them.
    queue: NearestFirst<usize>,
    /// Length of the best path, its end, the face of its end, and the rays that lead there.
    best: (f64, Option<(SurfacePoint, FaceId, Option<usize>)>),
}

/// Searches in all directions for the visible vertex or source over which the path to a source is shortest, if it is
/// shorter than `known`: the end of a straight line, and the faces it crosses. Stops at the first that is no longer than
/// `enough`, and after `n_rays` bundles of rays.
///
/// Rays are followed only while they may improve the result: the distance at a point `P` of an edge with ends `A` and
/// `B` is at least `T(A) - |AP|` and `T(B) - |BP|`, which leaves a lens around the path. If `T` is exact, so is the
/// result.
pub(super) fn nearest_visible(
    field: &PathField,
    from: SurfacePoint,
    known: f64,
    enough: f64,
    n_rays: &mut usize,
) -> Option<(SurfacePoint, Strip)> {
    let best = (known * (1.0 - SAME), None);
    let mut search =
        SightSearch { field, rays: Vec::new(), most: *n_rays, queue: NearestFirst::default(), best };
    search.start(from);
    while let Some((least, at)) = search.queue.pop() {
        let best = search.best.0;
        if least >= best || best <= enough * (1.0 + SAME) {
            break;
        }
        search.follow(at);
    }
    *n_rays -= search.rays.len();
    let (end, face, mut at) = search.best.1?;
    let mut strip = Strip::within(face);
    while let Some(i) = at {
        let rays = &search.rays[i];
        strip.faces.push(rays.face);
        strip.portals.push(Portal { edge: rays.edge, t: 0.5 });
        at = rays.before;
    }
    strip.faces.reverse();
    strip.portals.reverse();
    Some((end, strip))
}

impl SightSearch<'_> {
    /// Sends rays over all edges around a point that it does not lie on.
    fn start(&mut self, from: SurfacePoint) {
        let mesh = self.field.mesh;
        let topology = mesh.topology();
        for face in faces_around(mesh, from) {
            let flat = Flat::of_face(mesh, face);
            let origin = flat.point(mesh, from);
            let at = |v: VertexId| sub(flat.vertex(v), origin);
            let vertices = topology.faces()[face.index()];
            for v in vertices.into_iter().filter(|v| SurfacePoint::Vertex(*v) != from) {
                self.offer(distance(at(v), [0.0; 2]) + self.field.distances[v.index()], v, face, None);
            }
            self.offer_sources(face, &flat, origin, None);
            for corner in face.corners() {
                // Counter-clockwise, so that the first end is on the right from inside.
                let [right, left] = topology.edge_ends(corner).map(|v| (v, at(v)));
                // From the apex of a flat face, they lie in opposite directions.
                let turn = cross(right.1, left.1);
                if turn > 0.0 || (turn == 0.0 && dot(right.1, left.1) < 0.0) {
                    let edge = topology.opposite_edge(corner);
                    let gate = [left, right];
                    self.send(Rays { before: None, face, edge, gate, left: left.1, right: right.1 });
                }
            }
        }
    }

    /// Follows rays into the faces beyond their edge.
    fn follow(&mut self, index: usize) {
        let mesh = self.field.mesh;
        let topology = mesh.topology();
        let rays = self.rays[index];
        let [(left, at_left), (right, at_right)] = rays.gate;
        for facing in topology.edge_corners(rays.edge).iter().filter(|c| c.face() != rays.face) {
            let face = facing.face();
            let third = topology.corner_vertex(*facing);
            let edges = topology.corner_edges(*facing);
            let [to_left, to_right] =
                if topology.edges()[edges[0].index()].contains(&left) { edges } else { [edges[1], edges[0]] };
            let lengths = [rays.edge, to_left, to_right].map(|edge| mesh.length(edge));
            let at = beyond([at_left, at_right], lengths, GateSide::Ahead);
            let flat = Flat { vertices: [left, right, third], at: [at_left, at_right, at] };
            self.offer_sources(face, &flat, [0.0; 2], Some(index));
            let before = Some(index);
            let [from_left, from_right] = [cross(at, rays.left), cross(rays.right, at)];
            let is_visible = from_left >= 0.0 && from_right >= 0.0;
            if is_visible {
                let total = distance(at, [0.0; 2]) + self.field.distances[third.index()];
                self.offer(total, third, face, before);
            }
            if from_right > 0.0 {
                // Some rays pass on the right of the vertex.
                let gate = [(third, at), rays.gate[1]];
                let left = if is_visible { at } else { rays.left };
                self.send(Rays { before, face, edge: to_right, gate, left, right: rays.right });
            }
            if from_left > 0.0 {
                let gate = [rays.gate[0], (third, at)];
                let right = if is_visible { at } else { rays.right };
                self.send(Rays { before, face, edge: to_left, gate, left: rays.left, right });
            }
        }
    }

    /// Considers the sources in a face as ends.
    fn offer_sources(&mut self, face: FaceId, flat: &Flat, origin: PlanePoint, before: Option<usize>) {
        for source in self.field.sources_within(face) {
            let at = sub(flat.point(self.field.mesh, *source), origin);
            let is_visible = before.is_none_or(|i| {
                let rays = &self.rays[i];
                cross(at, rays.left) >= 0.0 && cross(rays.right, at) >= 0.0
            });
            let total = distance(at, [0.0; 2]);
            if is_visible && total < self.best.0 {
                self.best = (total, Some((*source, face, before)));
            }
        }
    }

    fn offer(&mut self, total: f64, vertex: VertexId, face: FaceId, before: Option<usize>) {
        if total < self.best.0 {
            self.best = (total, Some((SurfacePoint::Vertex(vertex), face, before)));
        }
    }

    /// Keeps rays that may lead to a shorter path than the best so far.
    fn send(&mut self, rays: Rays) {
        let [left, right] = rays.gate;
        // Where the outermost rays cross the edge.
        let [p, q] = [(rays.left, 0.0), (rays.right, 1.0)].map(|(ray, end)| {
            let (a, b) = (cross(ray, left.1), cross(ray, right.1));
            let share = a / (a - b);
            between(left.1, right.1, if share.is_nan() { end } else { share.clamp(0.0, 1.0) })
        });
        // The length of a path over the edge decreases towards the farther end.
        let over = |(vertex, at): (VertexId, PlanePoint), far: PlanePoint| {
            self.field.distances[vertex.index()] + distance(far, [0.0; 2]) - distance(far, at)
        };
        let least = over(left, q).max(over(right, p)).max(0.0);
        if least < self.best.0 && self.rays.len() < self.most {
            self.queue.push(least, self.rays.len());
            self.rays.push(rays);
        }
    }
}
