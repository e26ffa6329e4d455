//! A first way to the source, down the field of distances.

use std::collections::BTreeSet;

use surface::{EdgeId, FaceId, Triangle, VertexId};

use super::PathTracer;
use super::edges::faces_around;
use super::plane::{Flat, Point, between, distance, segment};
use super::strip::{Portal, Section, Strip, Way};
use crate::SurfacePoint;
use crate::fast_marching::Stencil;

/// The next stop on the way.
#[derive(Debug, Clone, Copy)]
enum Stop {
    Source(SurfacePoint),
    Vertex(VertexId),
    Portal(Portal),
}

/// How to get there.
#[derive(Debug, Clone, Copy)]
enum Over {
    Face(FaceId),
    Link(f64),
}

/// A step that may be taken, and how far the source then is in all.
#[derive(Debug, Clone, Copy)]
struct Step {
    total: f64,
    stop: Stop,
    over: Over,
}

/// Walks from `target` to a source, always into the direction in which the source seems nearest: the
/// distances at the ends of an edge say where in the plane of a face the source would lie. Passes no
/// vertex and crosses no edge twice; `None` when it is stuck.
///
/// Near a ridge of the field, and wherever the field is not that of distances, the way may be bad.
pub(super) fn descend(tracer: &PathTracer, target: SurfacePoint) -> Option<Way> {
    let topology = tracer.mesh.topology();
    let mut walker = Walker { tracer, vertices: BTreeSet::new(), edges: BTreeSet::new() };
    let mut way = Way { nodes: vec![target], sections: Vec::new() };
    let mut strip = Strip { faces: Vec::new(), portals: Vec::new() };
    let mut here = target;
    let mut faces = faces_around(tracer.mesh, target);
    loop {
        if let SurfacePoint::Vertex(vertex) = here {
            if tracer.is_source(vertex) {
                return Some(way);
            }
            walker.vertices.insert(vertex);
        }
        let step = walker.best(here, &faces)?;
        match step.over {
            Over::Face(face) => strip.faces.push(face),
            Over::Link(length) => way.sections.push(Section::Link(length)),
        }
        match step.stop {
            Stop::Portal(portal) => {
                walker.edges.insert(portal.edge);
                strip.portals.push(portal);
                here = portal.point();
                let last = strip.faces.last().copied();
                faces = topology.edge_corners(portal.edge).iter().map(|corner| corner.face()).collect();
                faces.retain(|face| Some(*face) != last);
            }
            Stop::Vertex(_) | Stop::Source(_) => {
                if !strip.faces.is_empty() {
                    let strip =
                        std::mem::replace(&mut strip, Strip { faces: Vec::new(), portals: Vec::new() });
                    way.sections.push(Section::Strip(strip));
                }
                here = match step.stop {
                    Stop::Vertex(vertex) => SurfacePoint::Vertex(vertex),
                    Stop::Source(point) => point,
                    Stop::Portal(portal) => portal.point(),
                };
                way.nodes.push(here);
                if matches!(step.stop, Stop::Source(_)) {
                    return Some(way);
                }
                faces = faces_around(tracer.mesh, here);
            }
        }
    }
}

struct Walker<'a> {
    tracer: &'a PathTracer<'a>,
    /// What has been passed.
    vertices: BTreeSet<VertexId>,
    edges: BTreeSet<EdgeId>,
}

impl Walker<'_> {
    /// The step after which the source is nearest.
    fn best(&self, here: SurfacePoint, faces: &[FaceId]) -> Option<Step> {
        let mut best: Option<Step> = None;
        let mut offer = |total: f64, stop, over| {
            if total < best.map_or(f64::INFINITY, |step| step.total) {
                best = Some(Step { total, stop, over });
            }
        };
        for face in faces {
            self.steps_within(*face, here, &mut |total, stop| offer(total, stop, Over::Face(*face)));
        }
        if let SurfacePoint::Vertex(vertex) = here {
            for (other, length) in self.tracer.links(vertex) {
                if !self.vertices.contains(&other) {
                    let total = length + self.tracer.distances[other.index()];
                    offer(total, Stop::Vertex(other), Over::Link(length));
                }
            }
        }
        best
    }

    fn steps_within(&self, face: FaceId, here: SurfacePoint, offer: &mut impl FnMut(f64, Stop)) {
        let (mesh, at) = (self.tracer.mesh, |v: VertexId| self.tracer.distances[v.index()]);
        for source in self.tracer.sources_within(face) {
            offer(segment(mesh, face, here, *source), Stop::Source(*source));
        }
        let flat = Flat::new(mesh, face, 0);
        let place = flat.point(mesh, here);
        for corner in face.corners() {
            let vertex = mesh.topology().corner_vertex(corner);
            if !self.vertices.contains(&vertex) {
                let step = segment(mesh, face, here, SurfacePoint::Vertex(vertex));
                offer(step + at(vertex), Stop::Vertex(vertex));
            }
            let edge = mesh.topology().opposite_edge(corner);
            let ends = mesh.topology().edges()[edge.index()];
            let is_on = match here {
                SurfacePoint::Vertex(v) => ends.contains(&v),
                SurfacePoint::Edge { edge: other, .. } => other == edge,
                SurfacePoint::Face { .. } => false,
            };
            if !is_on && !self.edges.contains(&edge) {
                let base = ends.map(|v| flat.vertex(v));
                if let Some((total, t)) = seen_through(place, base, ends.map(at)) {
                    offer(total, Stop::Portal(Portal { edge, t }));
                }
            }
        }
    }
}

/// The distance at `here` if the front comes from a single point beyond the base, and where it crosses
/// the base; `None` if the straight line misses it.
fn seen_through(here: Point, base: [Point; 2], [at_a, at_b]: [f64; 2]) -> Option<(f64, f64)> {
    let [a, b] = base;
    let (length, side) = (distance(a, b), distance(a, here));
    let above = Triangle::from_sides([length, side, distance(b, here)]);
    let stencil = Stencil { base: length, side, dot: above.x * length, cross: above.y * length };
    let total = stencil.point_source(at_a, at_b);
    if !total.is_finite() {
        return None;
    }
    // The crossing divides the line as the heights of its ends above the base do.
    let below = Triangle::from_sides([length, at_a, at_b]);
    let height = above.y + below.y;
    let t = if height > 0.0 { (below.x * above.y + above.x * below.y) / (height * length) } else { 0.5 };
    let crossing = between(a, b, t.clamp(0.0, 1.0));
    // Lengths of no triangle, or rounding in a flat one, may claim a source nearer than the base.
    (total >= distance(here, crossing)).then_some((total, t.clamp(0.0, 1.0)))
}
