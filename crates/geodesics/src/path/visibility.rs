//! The visible vertex over which the source is nearest.

use surface::{FaceId, NearestFirst, SurfacePoint, VertexId};

use super::field::PathField;
use super::step::Step;
use crate::flat::segment;
use crate::plane::{PlanePoint, distance};
use crate::sight::{Rays, SeenFace, faces_seen_from};

/// Share of a length within which two are the same up to rounding.
const SAME: f64 = 1e-12;

/// Where rays start.
const ORIGIN: PlanePoint = [0.0; 2];

/// The end of a straight line.
#[derive(Debug, Clone, Copy)]
struct End {
    point: SurfacePoint,
    at: PlanePoint,
    face: FaceId,
    /// The rays that it is seen through.
    before: Option<usize>,
}

struct SightSearch<'a> {
    field: &'a PathField<'a>,
    rays: Vec<Rays>,
    /// The largest number of bundles allowed.
    most: usize,
    /// Bundles by the least length of a path along them.
    queue: NearestFirst<usize>,
    /// Vertices are ends if their distance is less than this.
    below: f64,
    /// Length of the best path, and the end of its first straight line.
    best: (f64, Option<End>),
}

/// Searches in all directions for the source or the visible vertex nearer than `below` over which the path to a source is
/// shortest, if it is shorter than `known`: the steps of the straight line there. Stops at the first that is no longer than
/// `enough`, and after `n_rays` bundles of rays.
///
/// Rays are followed only while they may improve the result: the distance at a point `P` of an edge with ends `A` and
/// `B` is at least `T(A) - |AP|` and `T(B) - |BP|`, which leaves a lens around the path. If `T` is exact, so is the
/// result.
pub(super) fn nearest_visible(
    field: &PathField,
    from: SurfacePoint,
    [below, known, enough]: [f64; 3],
    n_rays: &mut usize,
) -> Option<Vec<Step>> {
    let best = (known * (1.0 - SAME), None);
    let (rays, queue) = (Vec::new(), NearestFirst::default());
    let mut search = SightSearch { field, rays, most: *n_rays, queue, below, best };
    faces_seen_from(field.mesh, from).iter().for_each(|seen| search.enter(seen, None));
    while let Some((least, number)) = search.queue.pop() {
        let best = search.best.0;
        if least >= best || best <= enough * (1.0 + SAME) {
            break;
        }
        let rays = search.rays[number];
        rays.faces_beyond(field.mesh, number).for_each(|seen| search.enter(&seen, Some(number)));
    }
    *n_rays -= search.rays.len();
    search.best.1.map(|end| search.steps(from, end))
}

impl SightSearch<'_> {
    /// Considers all that is seen in a face as ends, and keeps the rays beyond it.
    fn enter(&mut self, seen: &SeenFace, before: Option<usize>) {
        let SeenFace { face, flat, .. } = *seen;
        for ((vertex, at), is_visible) in flat.vertices.into_iter().zip(flat.at).zip(seen.is_visible) {
            let to_source = self.field.distances[vertex.index()];
            if is_visible && to_source < self.below {
                let point = SurfacePoint::Vertex(vertex);
                self.offer(distance(at, ORIGIN) + to_source, End { point, at, face, before });
            }
        }
        for source in self.field.sources_within(face) {
            let at = flat.point(self.field.mesh, source);
            if before.is_none_or(|number| self.rays[number].hold(at)) {
                self.offer(distance(at, ORIGIN), End { point: source, at, face, before });
            }
        }
        seen.onward.iter().flatten().for_each(|rays| self.send(*rays));
    }

    fn offer(&mut self, total: f64, end: End) {
        if total < self.best.0 {
            self.best = (total, Some(end));
        }
    }

    /// Keeps rays that may lead to a shorter path than the best so far.
    fn send(&mut self, rays: Rays) {
        let ([left, right], [p, q]) = (rays.gate, rays.span());
        // The length of a path over the edge decreases towards the farther end.
        let over = |(vertex, at): (VertexId, PlanePoint), far: PlanePoint| {
            self.field.distances[vertex.index()] + distance(far, ORIGIN) - distance(far, at)
        };
        let least = over(left, q).max(over(right, p)).max(0.0);
        if least < self.best.0 && self.rays.len() < self.most {
            self.queue.push(least, self.rays.len());
            self.rays.push(rays);
        }
    }

    /// The steps of the straight line to an end, over the edges that it crosses.
    fn steps(&self, from: SurfacePoint, end: End) -> Vec<Step> {
        let mut stops = vec![(end.face, end.point)];
        let mut before = end.before;
        while let Some(rays) = before.map(|number| self.rays[number]) {
            let crossing = SurfacePoint::Edge { edge: rays.edge, t: rays.crossing_to(end.at) };
            stops.push((rays.face, crossing));
            before = rays.before;
        }
        let mut here = from;
        let step = |(face, to): (FaceId, SurfacePoint)| {
            let length = segment(self.field.mesh, face, std::mem::replace(&mut here, to), to);
            Step { to, length }
        };
        stops.into_iter().rev().map(step).collect()
    }
}
