//! A first path to the source, down the field of distances.

use std::collections::BTreeSet;

use surface::{EdgeId, FaceId, Triangle, VertexId, Way};

use super::field::PathField;
use super::plane::{Flat, faces_around, is_on, segment};
use super::strip::{PathSection, Portal, Strip, StripPath};
use crate::plane::{PlanePoint, between, distance};
use surface::SurfacePoint;

/// A point whose distances from the ends of an edge exceed its length by no more than this share is on it: rounding.
const ON_BASE: f64 = 1e-12;

/// Where a step ends.
#[derive(Debug, Clone, Copy)]
enum StepEnd {
    /// At a source or a vertex.
    Node(SurfacePoint),
    Portal(Portal),
}

/// What a step crosses.
#[derive(Debug, Clone, Copy)]
enum Over {
    Face(FaceId),
    Link(f64),
}

/// Descends from `target` to a source, always in the direction in which the source appears nearest: the distances at
/// the ends of an edge determine where the source would lie in the plane of a face. Passes no vertex and crosses no
/// edge twice; returns `None` if that blocks every step.
///
/// The path may be far from shortest near a ridge of the field, and if the values of the field are not distances.
pub(super) fn descend(field: &PathField, target: SurfacePoint) -> Option<StripPath> {
    let topology = field.mesh.topology();
    let mut descent = Descent { field, vertices: BTreeSet::new(), edges: BTreeSet::new() };
    let mut path = StripPath { nodes: vec![target], sections: Vec::new() };
    let mut strip = Strip::default();
    let mut here = target;
    let mut faces = faces_around(field.mesh, target);
    loop {
        if let SurfacePoint::Vertex(vertex) = here {
            if field.is_source(vertex) {
                return Some(path);
            }
            descent.vertices.insert(vertex);
        }
        let (stop, over) = descent.best(here, &faces)?;
        match over {
            Over::Face(face) => strip.faces.push(face),
            Over::Link(length) => path.sections.push(PathSection::Link(length)),
        }
        match stop {
            StepEnd::Portal(portal) => {
                descent.edges.insert(portal.edge);
                strip.portals.push(portal);
                here = portal.point();
                let last = strip.faces.last().copied();
                faces = topology.edge_corners(portal.edge).iter().map(|corner| corner.face()).collect();
                faces.retain(|face| Some(*face) != last);
            }
            StepEnd::Node(node) => {
                if !strip.faces.is_empty() {
                    path.sections.push(PathSection::Strip(std::mem::take(&mut strip)));
                }
                here = node;
                path.nodes.push(here);
                if !matches!(here, SurfacePoint::Vertex(_)) {
                    return Some(path);
                }
                faces = faces_around(field.mesh, here);
            }
        }
    }
}

struct Descent<'a> {
    field: &'a PathField<'a>,
    /// The vertices passed and the edges crossed.
    vertices: BTreeSet<VertexId>,
    edges: BTreeSet<EdgeId>,
}

impl Descent<'_> {
    /// The step over which the source is nearest.
    fn best(&self, here: SurfacePoint, faces: &[FaceId]) -> Option<(StepEnd, Over)> {
        let (mut least, mut best) = (f64::INFINITY, None);
        let mut offer = |total: f64, stop, over| {
            if total < least {
                (least, best) = (total, Some((stop, over)));
            }
        };
        for face in faces {
            self.steps_within(*face, here, &mut |total, stop| offer(total, stop, Over::Face(*face)));
        }
        if let SurfacePoint::Vertex(vertex) = here {
            for &Way { to, length, .. } in self.field.links(vertex) {
                if !self.vertices.contains(&to) {
                    let total = length + self.field.distances[to.index()];
                    offer(total, StepEnd::Node(SurfacePoint::Vertex(to)), Over::Link(length));
                }
            }
        }
        best
    }

    fn steps_within(&self, face: FaceId, here: SurfacePoint, offer: &mut impl FnMut(f64, StepEnd)) {
        let (mesh, at) = (self.field.mesh, |v: VertexId| self.field.distances[v.index()]);
        for source in self.field.sources_within(face) {
            offer(segment(mesh, face, here, *source), StepEnd::Node(*source));
        }
        let flat = Flat::of_face(mesh, face);
        let place = flat.point(mesh, here);
        for corner in face.corners() {
            let vertex = mesh.topology().corner_vertex(corner);
            if !self.vertices.contains(&vertex) {
                let node = SurfacePoint::Vertex(vertex);
                offer(segment(mesh, face, here, node) + at(vertex), StepEnd::Node(node));
            }
            let edge = mesh.topology().opposite_edge(corner);
            let ends = mesh.topology().edges()[edge.index()];
            if !is_on(mesh, here, edge) && !self.edges.contains(&edge) {
                let base = ends.map(|v| flat.vertex(v));
                if let Some((total, t)) = distance_through(place, base, ends.map(at)) {
                    offer(total, StepEnd::Portal(Portal { edge, t }));
                }
            }
        }
    }
}

/// The distance at `here` of a front from a single point beyond the base, and where the straight line crosses the
/// base; `None` if it misses the base.
fn distance_through(here: PlanePoint, base: [PlanePoint; 2], [at_a, at_b]: [f64; 2]) -> Option<(f64, f64)> {
    let [a, b] = base;
    let (length, side) = (distance(a, b), distance(a, here));
    let above = Triangle::from_sides([length, side, distance(b, here)]);
    let below = Triangle::from_sides([length, at_a, at_b]);
    let total = point_source([length, side], [above.x * length, above.y * length], [at_a, at_b]);
    if !total.is_finite() {
        // The point may be on the base itself, as the apex of a face without area behind it is.
        let is_on_base = at_a + at_b <= length * (1.0 + ON_BASE) && (0.0..=length).contains(&below.x);
        let t = below.x / length;
        return is_on_base.then(|| (distance(here, between(a, b, t)), t));
    }
    // The crossing divides the line as the heights of its ends above and below the base do.
    let height = above.y + below.y;
    let t = if height > 0.0 { (below.x * above.y + above.x * below.y) / (height * length) } else { 0.5 };
    let crossing = between(a, b, t.clamp(0.0, 1.0));
    // In flat or impossible triangles, the source may appear nearer than the base.
    (total >= distance(here, crossing)).then_some((total, t.clamp(0.0, 1.0)))
}

/// If the squared height of the point source above the line through the base is below this share of its squared
/// distance, it lies on that line up to rounding. Edges carry the front as well, and rounding would decide between
/// the two.
const COLLINEAR: f64 = 1e-12;

/// Distance at `C` of a front that comes from a single point beyond the base `AB`, from the distances at `A` and `B`, the
/// lengths `|AB|` and `|AC|`, and the scalar and cross product of the two; infinite if the straight line from that point to
/// `C` misses the base, or without such a point. Edges carry the front.
///
/// Exact in the plane. Novotni and Klein 2002 (`novotni2002`), in coordinates that are multiples of `|AB|`.
fn point_source([base, side]: [f64; 2], [dot, cross]: [f64; 2], [at_a, at_b]: [f64; 2]) -> f64 {
    let sq_base = base * base;
    // The point lies at (along, -height) / |AB|: at distance `at_a` from A and `at_b` from B.
    let along = 0.5 * (sq_base + (at_a - at_b) * (at_a + at_b));
    let reach = base * at_a;
    let sq_height = (reach - along) * (reach + along);
    let height = sq_height.sqrt();
    // Where the line crosses the base, as a share of the base, times its positive denominator.
    let crossing = along * cross + dot * height;
    let distance = (side * side + at_a * at_a + 2.0 * (cross * height - dot * along) / sq_base).sqrt();
    let is_hit =
        (sq_height >= COLLINEAR * reach * reach) && (0.0..=sq_base * (height + cross)).contains(&crossing);
    if is_hit { distance } else { f64::INFINITY }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_source_is_exact_in_the_plane_and_infinite_if_the_line_misses_the_base() {
        let update = |known| point_source([2.0, 0.7f64.hypot(1.5)], [2.0 * 0.7, 2.0 * 1.5], known);
        for sx in [-3.0f64, -0.5, 0.1, 1.0, 1.9, 4.0] {
            for sy in [1e-9, 0.3, 2.0, 50.0] {
                let at_a = sx.hypot(sy);
                let at_b = (sx - 2.0).hypot(sy);
                let exact = (sx - 0.7).hypot(sy + 1.5);
                let crossing = sx + (0.7 - sx) * sy / (sy + 1.5);
                let t = update([at_a, at_b]);
                // The height of a source within rounding of the base's line cannot be recovered.
                let tolerance = if sy < 1e-6 { 1e-7 } else { 1e-12 };
                if (0.01..=1.99).contains(&crossing) && (sy > 1e-6 || t.is_finite()) {
                    assert!((t - exact).abs() < tolerance * exact.max(1.0), "{t} against {exact}");
                } else if !(-0.01..=2.01).contains(&crossing) {
                    assert_eq!(t, f64::INFINITY);
                }
            }
        }
    }

    #[test]
    fn a_base_without_length_never_updates() {
        for products in [[0.0, 0.0], [f64::NAN, f64::NAN]] {
            assert_eq!(f64::min(7.0, point_source([0.0, 1.0], products, [1.0, 1.0])), 7.0);
        }
    }
}
