//! The angle of a path at a vertex, and the faces on its inner side.

use std::f64::consts::PI;

use surface::{CornerId, EdgeGraph, EdgeId, FaceId, Frontier, IntrinsicMesh, Link, VertexId};

use super::plane::{Flat, is_on};
use super::strip::Portal;
use surface::SurfacePoint;

/// A path bends if the angle on one side is less than this: smaller bends are rounding.
const STRAIGHT: f64 = PI - 1e-8;

/// A direction at a vertex.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Direction {
    /// The face that it leads into; `None` along an edge.
    pub(super) face: Option<FaceId>,
    /// That edge, or the two edges of the face at the vertex, and the angles to them.
    edges: Vec<(EdgeId, f64)>,
}

impl Direction {
    /// The direction from `vertex` into a face, towards a portal or, without one, the point `end` in it.
    pub(super) fn of(
        mesh: &IntrinsicMesh,
        vertex: VertexId,
        face: FaceId,
        portal: Option<&Portal>,
        end: SurfacePoint,
    ) -> Option<Self> {
        let towards = portal.map_or(end, |portal| portal.point());
        let corner = mesh.topology().corner_at(face, vertex)?;
        let edges = mesh.topology().corner_edges(corner);
        if let Some(edge) = edges.into_iter().find(|edge| is_on(mesh, towards, *edge)) {
            return Some(Self { face: None, edges: vec![(edge, 0.0)] });
        }
        let [x, y] = Flat::new(mesh, corner).point(mesh, towards);
        // Rounding may put the point outside the face, but angles must not be negative.
        let first = y.atan2(x).abs();
        let rest = (angle(mesh, corner) - first).abs();
        Some(Self { face: Some(face), edges: vec![(edges[0], first), (edges[1], rest)] })
    }
}

/// The faces between two directions at a vertex, and the edges between these faces, on a side where the directions
/// are less than 180 degrees apart; `None` if both sides have more. A path is shorter past the vertex on that side.
///
/// Finds the shortest path in a graph whose nodes are the edges at the vertex and whose arcs are the angles of faces.
/// So edges may have any number of faces of any orientation, and the fan may be open.
pub(super) fn inner_side(
    mesh: &IntrinsicMesh,
    vertex: VertexId,
    from: &Direction,
    to: &Direction,
) -> Option<(Vec<FaceId>, Vec<EdgeId>)> {
    let topology = mesh.topology();
    if from.face.is_some() && from.face == to.face {
        return Some((from.face.into_iter().collect(), Vec::new()));
    }
    let corners = topology.vertex_corners(vertex);
    let mut edges: Vec<EdgeId> = corners.iter().flat_map(|corner| topology.corner_edges(*corner)).collect();
    edges.sort_unstable();
    edges.dedup();
    let node = |edge: EdgeId| VertexId::from(edges.partition_point(|other| *other < edge));
    let arc = |corner: &CornerId| Link {
        ends: topology.corner_edges(*corner).map(node),
        length: angle(mesh, *corner),
    };
    let (graph, mut front) = (EdgeGraph::new(edges.len(), corners.iter().map(arc)), Frontier::default());
    // For each edge: the one before it, and the face between.
    let mut before = vec![(None, None); edges.len()];
    front.reset(edges.len());
    for (edge, angle) in &from.edges {
        front.relax(node(*edge), *angle);
        before[node(*edge).index()] = (None, from.face);
    }
    graph.search(
        &mut front,
        STRAIGHT,
        |_, _| true,
        |edge, way| before[way.to.index()] = (Some(edge), Some(corners[way.number as usize].face())),
    );
    let totals = to.edges.iter().map(|(edge, rest)| (front.distance(node(*edge)) + rest, node(*edge)));
    let (_, last) = totals.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|(total, _)| *total < STRAIGHT)?;
    let (mut faces, mut crossed, mut at) = (Vec::from_iter(to.face), Vec::new(), Some(last));
    while let Some(node) = at {
        let (earlier, face) = before[node.index()];
        crossed.push(edges[node.index()]);
        faces.extend(face);
        at = earlier;
    }
    faces.reverse();
    crossed.reverse();
    // Edges along which the path arrives or leaves are not crossed.
    if to.face.is_none() {
        crossed.pop();
    }
    if from.face.is_none() && !crossed.is_empty() {
        crossed.remove(0);
    }
    if faces.is_empty() {
        // Back along the same edge.
        faces.push(topology.edge_corners(edges[last.index()]).first()?.face());
    }
    Some((faces, crossed))
}

fn angle(mesh: &IntrinsicMesh, corner: CornerId) -> f64 {
    let [_, _, [x, y]] = Flat::new(mesh, corner).at;
    y.atan2(x)
}
