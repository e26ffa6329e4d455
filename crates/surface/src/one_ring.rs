//! The faces around a vertex, in order.

use std::f64::consts::{PI, TAU};

use crate::disjoint_sets::DisjointSets;
use crate::ids::{CornerId, EdgeId, VertexId};
use crate::topology::Topology;

/// Which of the two sides of a face at a vertex comes first in a fan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Winding {
    /// The side to the vertex in the next corner.
    Forward,
    /// The side to the vertex in the previous corner.
    Backward,
}

/// A corner in a fan. Faces may have opposite orientations, so each has its own winding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FanCorner {
    /// The corner; all corners of a fan are at the same vertex.
    pub corner: CornerId,
    /// Which of its sides comes first.
    pub winding: Winding,
}

impl FanCorner {
    /// The corner of the same face opposite the first side. The last side ends at the vertex in it.
    #[inline]
    pub fn opposite_first(self) -> CornerId {
        if self.winding == Winding::Forward { self.corner.prev() } else { self.corner.next() }
    }

    /// The corner of the same face opposite the last side. The first side ends at the vertex in it.
    #[inline]
    pub fn opposite_last(self) -> CornerId {
        if self.winding == Winding::Forward { self.corner.next() } else { self.corner.prev() }
    }
}

/// Faces around a vertex, each sharing with the next an edge that only these two have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Fan<'a> {
    /// The corners at the vertex, in order.
    pub corners: &'a [FanCorner],
    /// Whether the last side is also the first.
    pub is_closed: bool,
}

impl Fan<'_> {
    /// The corners opposite the first and the last side, which are the same side in a closed fan.
    ///
    /// # Panics
    /// If the fan is empty, which no fan of a [`OneRing`] is.
    pub fn ends(self) -> [CornerId; 2] {
        [self.corners[0].opposite_first(), self.corners[self.corners.len() - 1].opposite_last()]
    }
}

/// What shortest paths may do at a vertex (Mitchell, Mount and Papadimitriou 1987, `mitchell1987`).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VertexKind {
    /// They pass straight through, if at all: the total angle is at most 360 degrees, or 180 on the boundary.
    Ordinary,
    /// They may bend: an interior vertex with more than 360 degrees. At least 180 are on either side of a path.
    Saddle,
    /// They may bend: a boundary vertex with more than 180 degrees.
    Boundary,
    /// They may bend anywhere: the faces do not form a single fan.
    Irregular,
}

/// The faces around one vertex, as fans.
///
/// An interior vertex has one closed fan, a boundary vertex one open fan. A vertex has several if parts of the
/// surface touch only there, and at the end of a non-manifold edge.
///
/// ```
/// use canonform_surface::{OneRing, Topology, VertexId};
///
/// // Three faces around vertex 0, one of them turned over.
/// let faces = [[0, 1, 2], [0, 3, 2], [0, 3, 1]].map(|face| face.map(VertexId));
/// let topology = Topology::new(4, faces.to_vec());
/// let mut ring = OneRing::default();
///
/// ring.collect(&topology, VertexId(0));
/// let fan = ring.fans().next().unwrap();
/// let neighbors = fan.corners.iter().map(|c| topology.corner_vertex(c.opposite_last()));
/// assert_eq!(neighbors.collect::<Vec<_>>(), [1, 2, 3].map(VertexId));
/// assert!(fan.is_closed);
///
/// ring.collect(&topology, VertexId(1));
/// let fan = ring.fans().next().unwrap();
/// assert_eq!((fan.corners.len(), fan.is_closed), (2, false));
/// ```
#[derive(Debug, Clone, Default)]
pub struct OneRing {
    corners: Vec<FanCorner>,
    /// Where each fan ends, and whether it is closed.
    fans: Vec<(usize, bool)>,
    /// Whether each corner of the vertex is in a fan.
    is_known: Vec<bool>,
}

impl OneRing {
    /// Replaces the fans by those of a vertex. Linear time, or `O(n log n)` in the number of corners where there is more than
    /// one fan.
    ///
    /// The first open fan starts at the first corner that can start one; a closed one with a forward corner.
    /// Allocates only to grow.
    pub fn collect(&mut self, topology: &Topology, vertex: VertexId) {
        let corners = topology.vertex_corners(vertex);
        self.corners.clear();
        self.fans.clear();
        let at = |winding| move |corner: &CornerId| FanCorner { corner: *corner, winding };
        let Some(first) = corners.first().map(at(Winding::Forward)) else { return };
        if self.walk(topology, first) && self.corners.len() == corners.len() {
            self.fans.push((corners.len(), true));
            return;
        }
        self.corners.clear();
        self.is_known.clear();
        self.is_known.resize(corners.len(), false);
        // The corners of a vertex ascend.
        let place = |corner: CornerId| corners.partition_point(|other| *other < corner);
        let sides = corners.iter().flat_map(|c| [Winding::Forward, Winding::Backward].map(|w| at(w)(c)));
        let begins_fan = |side: &FanCorner| topology.opposite(side.opposite_first()).is_none();
        // All that is left after the open fans is closed.
        for start in sides.filter(begins_fan).chain(corners.iter().map(at(Winding::Forward))) {
            if self.corners.len() == corners.len() {
                break;
            }
            if !self.is_known[place(start.corner)] {
                let n_before = self.corners.len();
                let is_closed = self.walk(topology, start);
                self.fans.push((self.corners.len(), is_closed));
                for known in &self.corners[n_before..] {
                    self.is_known[place(known.corner)] = true;
                }
            }
        }
    }

    /// Appends the fan that begins with `start`; returns whether it is closed.
    #[inline]
    fn walk(&mut self, topology: &Topology, start: FanCorner) -> bool {
        let vertex = topology.corner_vertex(start.corner);
        let mut here = start;
        loop {
            self.corners.push(here);
            let Some(far) = topology.opposite(here.opposite_last()) else { return false };
            let next = far.next();
            here = if topology.corner_vertex(next) == vertex {
                FanCorner { corner: next, winding: Winding::Forward }
            } else {
                FanCorner { corner: far.prev(), winding: Winding::Backward }
            };
            if here.corner == start.corner {
                return true;
            }
        }
    }

    /// The fans.
    pub fn fans(&self) -> impl Iterator<Item = Fan<'_>> {
        let mut start = 0;
        self.fans.iter().map(move |&(end, is_closed)| {
            let corners = &self.corners[start..end];
            start = end;
            Fan { corners, is_closed }
        })
    }

    /// The fans as sets of those with common edges of more than two faces, except for edges that are to be `left_out`.
    pub fn joined(&self, topology: &Topology, left_out: impl Fn(EdgeId) -> bool) -> DisjointSets {
        let mut ends: Vec<(EdgeId, u32)> = Vec::new();
        for (i, fan) in (0..).zip(self.fans()).filter(|(_, fan)| !fan.is_closed) {
            let edges = fan.ends().map(|corner| topology.opposite_edge(corner));
            ends.extend(edges.into_iter().filter(|edge| !left_out(*edge)).map(|edge| (edge, i)));
        }
        ends.sort_unstable();
        let mut sets = DisjointSets::new(self.fans.len());
        for pair in ends.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
            sets.union(pair[0].1, pair[1].1);
        }
        sets
    }

    /// Whether there is a single fan and it is closed.
    pub fn is_closed(&self) -> bool {
        matches!(self.fans[..], [(_, true)])
    }

    /// Classifies the vertex. Paths may bend if its total angle exceeds the limit by over `excess`, both in radians.
    pub fn kind(&self, total_angle: f64, excess: f64) -> VertexKind {
        match self.fans[..] {
            [(_, true)] if total_angle > TAU + excess => VertexKind::Saddle,
            [(_, false)] if total_angle > PI + excess => VertexKind::Boundary,
            [] | [_] => VertexKind::Ordinary,
            _ => VertexKind::Irregular,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The fans around vertex 0: the vertices at the ends of the sides, in order.
    fn fans(faces: &[[u32; 3]]) -> (OneRing, Vec<Vec<u32>>) {
        let topology = Topology::new(9, faces.iter().map(|f| f.map(VertexId)).collect());
        let mut ring = OneRing::default();
        ring.collect(&topology, VertexId(0));
        let vertex = |corner| topology.corner_vertex(corner).0;
        let ends = |fan: Fan| {
            let firsts = fan.corners.iter().map(|c| vertex(c.opposite_last()));
            firsts.chain(fan.corners.last().map(|c| vertex(c.opposite_first()))).collect()
        };
        let all = ring.fans().map(ends).collect();
        (ring, all)
    }

    #[test]
    fn a_fan_is_followed_through_faces_of_either_orientation() {
        let closed: &[[u32; 3]] = &[[0, 1, 2], [4, 3, 0], [0, 2, 3], [1, 0, 4]];
        let open: &[[u32; 3]] = &[[2, 3, 0], [0, 1, 2], [0, 4, 3]];
        for (faces, fan, angles, wide) in [
            (closed, vec![1, 2, 3, 4, 1], [6.0, 6.3], VertexKind::Saddle),
            (open, vec![1, 2, 3, 4], [3.1, 3.2], VertexKind::Boundary),
        ] {
            let (ring, ends) = fans(faces);
            assert_eq!(ends, [fan]);
            assert_eq!(angles.map(|angle| ring.kind(angle, 1e-9)), [VertexKind::Ordinary, wide]);
        }
    }

    #[test]
    fn fans_end_at_edges_of_three_faces_and_a_vertex_may_have_several() {
        let (ring, mut ends) = fans(&[[0, 1, 2], [0, 1, 3], [0, 1, 4], [0, 4, 5]]);
        ends.iter_mut().for_each(|fan| fan.sort_unstable());
        assert_eq!(ends, [vec![1, 2], vec![1, 3], vec![1, 4, 5]]);
        assert_eq!(ring.kind(0.1, 1e-9), VertexKind::Irregular);
        let (ring, ends) = fans(&[[0, 1, 2], [0, 2, 3], [0, 3, 1], [0, 4, 5], [0, 5, 6], [0, 6, 4]]);
        assert_eq!(ends, [[1, 2, 3, 1], [4, 5, 6, 4]]);
        assert!(ring.fans().all(|fan| fan.is_closed));
        let (ring, ends) = fans(&[[1, 2, 3]]);
        assert_eq!((ring.kind(0.0, 0.0), ends.len()), (VertexKind::Ordinary, 0));
    }
}
