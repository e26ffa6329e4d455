//! Connectivity: edges, the faces on each edge, the corners at each vertex.

use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};

use rayon::prelude::*;

use crate::ids::{CornerId, EdgeId, FaceId, VertexId};
use crate::rows::Rows;

/// Connectivity of a triangle mesh, as a corner table whose edges may have any number of faces.
///
/// An edge lists the corners opposite it, so three faces on an edge, or faces of opposite orientation, need no
/// special treatment.
///
/// **Invariants.** Every face has three different vertices below `n_vertices`. The ends of an edge are sorted
/// (`ends[0] < ends[1]`), edges by their ends, and the corners of a vertex and of an edge by their numbers.
///
/// ```
/// use canonform_surface::{CornerId, Topology, VertexId};
///
/// // Two triangles that share the edge between vertices 1 and 2.
/// let faces = vec![[0, 1, 2].map(VertexId), [3, 2, 1].map(VertexId)];
/// let topology = Topology::new(4, faces);
/// assert_eq!(topology.n_edges(), 5);
///
/// let corner = CornerId(0);
/// assert_eq!(topology.edge_ends(corner), [VertexId(1), VertexId(2)]);
/// let opposite = topology.opposite(corner).unwrap();
/// assert_eq!(topology.corner_vertex(opposite), VertexId(3));
/// // The other two edges of that face are on the boundary.
/// assert_eq!(topology.opposite(corner.next()), None);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Topology {
    faces: Vec<[VertexId; 3]>,
    edges: Vec<[VertexId; 2]>,
    /// Edge opposite each corner, indexed by corner.
    corner_edge: Vec<EdgeId>,
    vertex_corners: Rows<CornerId>,
    edge_corners: Rows<CornerId>,
}

/// Vertices and corners of a mesh are fewer: solvers keep flags beside their numbers, in the upper two of 32 bits.
const LIMIT: usize = 1 << 30;

/// Number of vertices whose edges one thread collects at a time.
const BLOCK: usize = 512;

/// The edges from some successive vertices to higher ones.
struct EdgeBlock {
    edges: Vec<[VertexId; 2]>,
    /// Per edge, the number of corners opposite it and the edges before it.
    ends: Vec<u32>,
    corners: Vec<CornerId>,
}

impl EdgeBlock {
    fn of(vertices: Range<usize>, faces: &[[VertexId; 3]], vertex_corners: &Rows<CornerId>) -> Self {
        let n_corners =
            vertex_corners.range(vertices.end - 1).end - vertex_corners.range(vertices.start).start;
        let n_edges = n_corners / 2 + 1;
        let mut block = Self {
            edges: Vec::with_capacity(n_edges),
            ends: Vec::with_capacity(n_edges),
            corners: Vec::with_capacity(n_corners),
        };
        // The upper ends of all sides and the corners opposite, collected without a branch, so that many faces are
        // read at once.
        let (mut sides, mut n_sides) = (vec![(VertexId(0), CornerId(0)); 2 * n_corners + 1], 0);
        let mut sides_end = Vec::with_capacity(vertices.len());
        for lower in vertices.clone().map(|v| VertexId(v as u32)) {
            for corner in vertex_corners.row(lower.index()) {
                let (next, prev, face) = (corner.next(), corner.prev(), faces[corner.face().index()]);
                let ends = [face[next.slot()], face[prev.slot()]];
                sides[n_sides] = (ends[0], prev);
                n_sides += usize::from(ends[0] > lower);
                sides[n_sides] = (ends[1], next);
                n_sides += usize::from(ends[1] > lower);
            }
            sides_end.push(n_sides);
        }
        let mut start = 0;
        for (lower, end) in vertices.map(|v| VertexId(v as u32)).zip(sides_end) {
            let sides = &mut sides[std::mem::replace(&mut start, end)..end];
            sides.sort_unstable_by_key(|(upper, corner)| u64::from(upper.0) << 32 | u64::from(corner.0));
            for around in sides.chunk_by(|a, b| a.0 == b.0) {
                block.edges.push([lower, around[0].0]);
                block.corners.extend(around.iter().map(|(_, corner)| *corner));
                block.ends.push(block.corners.len() as u32);
            }
        }
        block
    }
}

impl Topology {
    /// The largest number of faces of a mesh.
    pub const MAX_FACES: usize = (LIMIT - 1) / 3;
    /// The largest number of vertices of a mesh.
    pub const MAX_VERTICES: usize = LIMIT - 1;

    /// Builds the connectivity of `faces` over `n_vertices` vertices, in linear time and in parallel.
    ///
    /// # Panics
    /// If a face has a vertex twice (`mesh::repair` removes such faces) or out of range (readers reject such files), or there
    /// are more vertices or faces than a mesh may have (`mesh::repair` rejects such meshes).
    pub fn new(n_vertices: usize, faces: Vec<[VertexId; 3]>) -> Self {
        assert!(
            n_vertices <= Self::MAX_VERTICES && faces.len() <= Self::MAX_FACES,
            "too many faces or vertices"
        );
        for [a, b, c] in &faces {
            assert!(a != b && b != c && c != a, "degenerate face {a} {b} {c}: repair the mesh first");
            assert!(a.max(b).max(c).index() < n_vertices, "face {a} {b} {c} is out of range");
        }
        let at_corner = faces.as_flattened().iter().enumerate();
        let vertex_corners =
            Rows::collect(n_vertices, at_corner.map(|(c, v)| (v.index(), CornerId(c as u32))));
        let blocks: Vec<EdgeBlock> = (0..n_vertices.div_ceil(BLOCK))
            .into_par_iter()
            .map(|block| {
                let vertices = block * BLOCK..n_vertices.min((block + 1) * BLOCK);
                EdgeBlock::of(vertices, &faces, &vertex_corners)
            })
            .collect();
        let n_edges = blocks.iter().map(|block| block.edges.len()).sum();
        let (mut edges, mut ends) = (Vec::with_capacity(n_edges), Vec::with_capacity(n_edges + 1));
        let mut corners = Vec::with_capacity(3 * faces.len());
        ends.push(0);
        for block in blocks {
            ends.extend(block.ends.iter().map(|end| corners.len() as u32 + end));
            edges.extend(block.edges);
            corners.extend(block.corners);
        }
        let edge_corners = Rows::from_offsets(ends, corners);
        // Every corner is written once, so the order of the writes does not matter.
        let corner_edge: Vec<AtomicU32> = faces.as_flattened().iter().map(|_| AtomicU32::new(0)).collect();
        (0..edges.len()).into_par_iter().with_min_len(BLOCK).for_each(|edge| {
            for corner in edge_corners.row(edge) {
                corner_edge[corner.index()].store(edge as u32, Ordering::Relaxed);
            }
        });
        let corner_edge = corner_edge.into_iter().map(|edge| EdgeId(edge.into_inner())).collect();
        Self { faces, edges, corner_edge, vertex_corners, edge_corners }
    }

    /// The vertices of every face, without the connectivity.
    pub fn into_faces(self) -> Vec<[VertexId; 3]> {
        self.faces
    }

    /// Number of vertices.
    pub fn n_vertices(&self) -> usize {
        self.vertex_corners.n_rows()
    }

    /// Number of faces.
    pub fn n_faces(&self) -> usize {
        self.faces.len()
    }

    /// Number of undirected edges.
    pub fn n_edges(&self) -> usize {
        self.edges.len()
    }

    /// The vertices of every face.
    pub fn faces(&self) -> &[[VertexId; 3]] {
        &self.faces
    }

    /// The two ends of every edge, the lower first.
    pub fn edges(&self) -> &[[VertexId; 2]] {
        &self.edges
    }

    /// The edges of one face, in ascending order.
    pub fn boundary_edges(&self) -> impl Iterator<Item = EdgeId> {
        (0..self.n_edges()).map(EdgeId::from).filter(|edge| self.edge_corners(*edge).len() == 1)
    }

    /// The vertex in a corner.
    #[inline]
    pub fn corner_vertex(&self, corner: CornerId) -> VertexId {
        self.faces[corner.face().index()][corner.slot()]
    }

    /// The edge opposite a corner.
    #[inline]
    pub fn opposite_edge(&self, corner: CornerId) -> EdgeId {
        self.corner_edge[corner.index()]
    }

    /// The vertices at the ends of the edge opposite a corner: in the next and in the previous corner.
    #[inline]
    pub fn edge_ends(&self, corner: CornerId) -> [VertexId; 2] {
        [corner.next(), corner.prev()].map(|end| self.corner_vertex(end))
    }

    /// The corner of a face at one of its vertices; `None` for other vertices.
    pub fn corner_at(&self, face: FaceId, vertex: VertexId) -> Option<CornerId> {
        face.corners().into_iter().find(|corner| self.corner_vertex(*corner) == vertex)
    }

    /// The corners at a vertex, one for each face around it.
    #[inline]
    pub fn vertex_corners(&self, vertex: VertexId) -> &[CornerId] {
        self.vertex_corners.row(vertex.index())
    }

    /// The corners opposite an edge, one per face: one at the boundary, over two if it is non-manifold.
    #[inline]
    pub fn edge_corners(&self, edge: EdgeId) -> &[CornerId] {
        self.edge_corners.row(edge.index())
    }

    /// The corner opposite the same edge in the other face; `None` if the edge does not have exactly two faces.
    #[inline]
    pub fn opposite(&self, corner: CornerId) -> Option<CornerId> {
        match *self.edge_corners(self.opposite_edge(corner)) {
            // The other of the two; a branch would be mispredicted every second time.
            [a, b] => Some(CornerId(a.0 ^ b.0 ^ corner.0)),
            _ => None,
        }
    }

    /// The edge between two vertices, if there is one.
    pub fn edge_between(&self, a: VertexId, b: VertexId) -> Option<EdgeId> {
        self.edges.binary_search(&[a.min(b), a.max(b)]).ok().map(EdgeId::from)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_numbers_of_vertices_and_blocks_do_not_matter() {
        // More vertices than a block has, in an order without locality.
        let n = 3 * BLOCK as u32 + 5;
        let mut list: Vec<_> = (0..n).map(|i| [i, i + 1, i + 2].map(|v| VertexId(v * 7919 % n))).collect();
        // Edges of three faces.
        list.extend((0..99).map(|i| [i, i + 1, i + 500].map(|v| VertexId(v * 7919 % n))));
        let t = Topology::new(n as usize, list.clone());
        assert!(t.edges().is_sorted() && t.edges().iter().all(|[a, b]| a < b));
        assert_eq!([n - 1, n].map(|far| t.edge_between(VertexId(0), VertexId(far))), [None; 2]);
        for corner in (0..3 * list.len()).map(CornerId::from) {
            let mut ends = t.edge_ends(corner);
            ends.sort_unstable();
            assert_eq!(t.edges()[t.opposite_edge(corner).index()], ends);
            assert!(t.vertex_corners(t.corner_vertex(corner)).contains(&corner));
            let around = t.edge_corners(t.opposite_edge(corner)).iter().filter(|other| **other != corner);
            let others: Vec<_> = around.copied().collect();
            assert_eq!(t.opposite(corner), if others.len() == 1 { Some(others[0]) } else { None });
        }
        for edge in (0..t.n_edges()).map(EdgeId::from) {
            let corners = t.edge_corners(edge);
            assert!(!corners.is_empty() && corners.is_sorted());
            let [a, b] = t.edges()[edge.index()];
            assert_eq!(t.edge_between(b, a), Some(edge));
            assert!(corners.iter().all(|corner| t.opposite_edge(*corner) == edge));
        }
    }
}
