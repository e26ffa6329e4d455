//! Closing T-junctions: vertices that lie on an edge of the face beside them.

use nalgebra::Point3;
use surface::{CornerId, EdgeId, Rows, Topology, VertexId};

use super::weld::SEAM_TOLERANCE;
use super::{Repair, Weld};
use crate::boundary::neighbors;

/// Rounding of coordinates, as a share of the farthest: many programs write six digits.
const ROUNDING: f64 = 1e-5;

/// Vertices of more boundary edges are left alone: comparing all of them would take quadratic time.
const MAX_BESIDE: usize = 64;

impl Repair<'_> {
    /// The faces split at the vertices that lie on one of their boundary edges, up to rounding or the width of gaps that are to be
    /// closed; `None` if there are no such vertices.
    ///
    /// Such an edge and the edges beside it leave a vertex in the same direction. The chain of boundary edges from there is
    /// followed as long as it stays on the edge, so that nothing is joined to an edge that it merely touches. Where the chain has
    /// gaps itself, later passes go on.
    pub(super) fn close_t_junctions(&mut self, topology: &Topology) -> Option<Vec<[VertexId; 3]>> {
        let edges: Vec<EdgeId> = topology.boundary_edges().collect();
        if edges.is_empty() {
            return None;
        }
        let gap = if let Weld::Within(tolerance) = self.weld { tolerance / self.unit } else { 0.0 };
        let boundary = Boundary { positions: &self.scaled, gap, beside: neighbors(topology) };
        let mut faces = topology.faces().to_vec();
        let mut n_joined = 0;
        for edge in edges {
            let corner = topology.edge_corners(edge)[0];
            let face = corner.face().index();
            // One edge of a face at a time.
            if faces[face] != topology.faces()[face] {
                continue;
            }
            let inner = boundary.vertices_on(topology, corner);
            n_joined += inner.len();
            if !inner.is_empty() {
                let (apex, [start, end]) = (topology.corner_vertex(corner), topology.edge_ends(corner));
                let parent = self.parents.get(&VertexId::sorted(faces[face])).copied().unwrap_or(faces[face]);
                let chain = [&[start], &inner[..], &[end]].concat();
                let mut parts = chain.windows(2).map(|pair| [apex, pair[0], pair[1]]);
                self.parents.extend(parts.clone().map(|part| (VertexId::sorted(part), parent)));
                faces[face] = parts.next().unwrap_or(faces[face]);
                faces.extend(parts);
            }
        }
        self.report.t_junctions += n_joined;
        (n_joined > 0).then_some(faces)
    }
}

struct Boundary<'a> {
    positions: &'a [Point3<f64>],
    gap: f64,
    /// The other ends of the boundary edges at every vertex.
    beside: Rows<VertexId>,
}

impl Boundary<'_> {
    /// The vertices inside the edge opposite a corner that chains of boundary edges from its ends lead to, in order.
    fn vertices_on(&self, topology: &Topology, corner: CornerId) -> Vec<VertexId> {
        let at = |v: VertexId| self.positions[v.index()];
        let (apex, [start, end]) = (topology.corner_vertex(corner), topology.edge_ends(corner));
        let sides = [at(end) - at(start), at(apex) - at(start), at(apex) - at(end)];
        let shortest = sides.iter().map(|side| side.norm()).fold(f64::INFINITY, f64::min);
        let farthest = [start, end, apex].map(|v| at(v).coords.amax()).into_iter().fold(0.0, f64::max);
        let rounding = f64::min(ROUNDING * farthest, SEAM_TOLERANCE * shortest);
        let width = rounding.max(self.gap);
        let length = sides[0].norm();
        let along = sides[0] / length;
        // The part of a face without area could not be told from one beside it.
        if sides[1].cross(&along).norm() <= width {
            return Vec::new();
        }
        // How far along the edge a vertex on it is.
        let place = |v: VertexId| {
            let from_start = at(v) - at(start);
            let along_edge = from_start.dot(&along);
            let is_on = (from_start - along * along_edge).norm() <= width;
            (is_on && along_edge > rounding && along_edge < length - rounding).then_some(along_edge)
        };
        let mut found: Vec<(f64, VertexId)> = Vec::new();
        for (first, sign) in [(start, 1.0), (end, -1.0)] {
            let (mut here, mut reached) = (first, if sign > 0.0 { 0.0 } else { length });
            loop {
                let beside = self.beside.row(here.index());
                let few = &beside[..if beside.len() <= MAX_BESIDE { beside.len() } else { 0 }];
                let onward = few.iter().filter_map(|v| Some((place(*v)?, *v)));
                let onward = onward.filter(|(to, _)| sign * (to - reached) > rounding);
                let Some(next) = onward.min_by(|a, b| (sign * a.0).total_cmp(&(sign * b.0))) else { break };
                (reached, here) = next;
                found.push(next);
            }
        }
        found.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        // Coincident vertices that were not welded are not joined either.
        found.dedup_by(|next, before| next.0 - before.0 <= rounding);
        found.into_iter().map(|(_, v)| v).collect()
    }
}
