//! Connectivity: edges, the faces on each edge, the corners at each vertex.

use std::ops::Range;

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
    n_vertices: usize,
    faces: Vec<[VertexId; 3]>,
    edges: Vec<[VertexId; 2]>,
    /// The number of edges whose lower end is below each vertex, and of all.
    first_edge: Vec<u32>,
    /// Edge opposite each corner, indexed by corner.
    corner_edge: Vec<EdgeId>,
    vertex_corners: Rows<CornerId>,
    edge_corners: Rows<CornerId>,
    has_duplicate_faces: bool,
}

/// Vertices and corners of a mesh are fewer: solvers keep flags beside their numbers, in the upper two of 32 bits.
const LIMIT: usize = 1 << 30;

/// A side of a face at the lower of its ends.
#[derive(Clone, Copy)]
struct Side {
    upper: VertexId,
    /// The corner opposite.
    corner: CornerId,
    /// The vertex in it.
    apex: VertexId,
}

/// Whether two faces at one edge have the same third vertex.
fn has_repeated_apex(around: &[Side]) -> bool {
    match around {
        [_] => false,
        [a, b] => a.apex == b.apex,
        _ => {
            let mut apices: Vec<VertexId> = around.iter().map(|side| side.apex).collect();
            apices.sort_unstable();
            apices.windows(2).any(|pair| pair[0] == pair[1])
        }
    }
}

impl Topology {
    /// The largest number of faces of a mesh.
    pub const MAX_FACES: usize = (LIMIT - 1) / 3;
    /// The largest number of vertices of a mesh.
    pub const MAX_VERTICES: usize = LIMIT - 1;

    /// Builds the connectivity of `faces` over `n_vertices` vertices, in linear time.
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
        let n_corners = 3 * faces.len();
        let (mut edges, mut first_edge) =
            (Vec::with_capacity(n_corners / 2 + 1), Vec::with_capacity(n_vertices + 1));
        let mut edge_corners = Rows::with_capacity(n_corners / 2 + 1, n_corners);
        let mut corner_edge = vec![EdgeId(0); n_corners];
        let (mut sides, mut has_duplicate_faces) = (Vec::new(), false);
        for lower in (0..n_vertices).map(|v| VertexId(v as u32)) {
            first_edge.push(edges.len() as u32);
            sides.clear();
            for corner in vertex_corners.row(lower.index()) {
                let (next, prev, face) = (corner.next(), corner.prev(), faces[corner.face().index()]);
                let ends = [face[next.slot()], face[prev.slot()]];
                let both = [
                    Side { upper: ends[0], corner: prev, apex: ends[1] },
                    Side { upper: ends[1], corner: next, apex: ends[0] },
                ];
                sides.extend(both.into_iter().filter(|side| side.upper > lower));
            }
            sides.sort_unstable_by_key(|side| u64::from(side.upper.0) << 32 | u64::from(side.corner.0));
            for around in sides.chunk_by(|a, b| a.upper == b.upper) {
                around.iter().for_each(|side| corner_edge[side.corner.index()] = EdgeId(edges.len() as u32));
                edges.push([lower, around[0].upper]);
                edge_corners.push_row(around.iter().map(|side| side.corner));
                has_duplicate_faces |= has_repeated_apex(around);
            }
        }
        first_edge.push(edges.len() as u32);
        Self {
            n_vertices,
            faces,
            edges,
            first_edge,
            corner_edge,
            vertex_corners,
            edge_corners,
            has_duplicate_faces,
        }
    }

    /// The vertices of every face, without the connectivity.
    pub fn into_faces(self) -> Vec<[VertexId; 3]> {
        self.faces
    }

    /// Whether two faces have the same three vertices.
    pub fn has_duplicate_faces(&self) -> bool {
        self.has_duplicate_faces
    }

    /// Number of vertices.
    pub fn n_vertices(&self) -> usize {
        self.n_vertices
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

    /// The edges from a vertex to higher ones, in ascending order.
    #[inline]
    pub fn edges_above(&self, vertex: VertexId) -> &[[VertexId; 2]] {
        &self.edges[self.range_above(vertex)]
    }

    fn range_above(&self, vertex: VertexId) -> Range<usize> {
        let v = vertex.index();
        self.first_edge[v] as usize..self.first_edge[v + 1] as usize
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

    /// The edges from a corner to the vertices in the next and in the previous corner of its face.
    #[inline]
    pub fn corner_edges(&self, corner: CornerId) -> [EdgeId; 2] {
        [corner.prev(), corner.next()].map(|third| self.opposite_edge(third))
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
        if a.max(b).index() >= self.n_vertices {
            return None;
        }
        let above = self.range_above(a.min(b));
        let found = self.edges[above.clone()].binary_search_by_key(&a.max(b), |ends| ends[1]);
        found.ok().map(|i| EdgeId::from(above.start + i))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn faces(list: &[[u32; 3]]) -> Vec<[VertexId; 3]> {
        list.iter().map(|f| f.map(VertexId)).collect()
    }

    #[test]
    fn a_tetrahedron_has_six_edges_with_two_faces_each() {
        let t = Topology::new(4, faces(&[[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]]));
        assert_eq!(t.n_edges(), 6);
        for e in 0..6 {
            assert_eq!(t.edge_corners(EdgeId(e)).len(), 2);
        }
        for c in (0..12).map(CornerId) {
            let twin = t.opposite(c).unwrap();
            assert_eq!(t.opposite(twin), Some(c));
            assert_eq!(t.opposite_edge(twin), t.opposite_edge(c));
            assert_ne!(t.corner_vertex(twin), t.corner_vertex(c));
        }
        assert_eq!(t.edge_between(VertexId(3), VertexId(1)), Some(EdgeId(4)));
    }

    #[test]
    fn an_edge_with_three_faces_has_no_opposite_corners() {
        let t = Topology::new(5, faces(&[[0, 1, 2], [0, 1, 3], [1, 0, 4]]));
        let shared = t.edge_between(VertexId(0), VertexId(1)).unwrap();
        assert_eq!(t.edge_corners(shared).len(), 3);
        assert_eq!(t.opposite(CornerId(2)), None);
        assert_eq!(t.vertex_corners(VertexId(1)).len(), 3);
    }

    #[test]
    fn edges_above_a_vertex_are_sorted_and_complete() {
        let list = [[4, 1, 0], [1, 4, 2], [0, 3, 1], [6, 2, 1]];
        let t = Topology::new(8, faces(&list));
        let above: Vec<Vec<u32>> =
            (0..8).map(|v| t.edges_above(VertexId(v)).iter().map(|ends| ends[1].0).collect()).collect();
        let expected: [&[u32]; 8] = [&[1, 3, 4], &[2, 3, 4, 6], &[4, 6], &[], &[], &[], &[], &[]];
        assert_eq!(above, expected);
        assert_eq!(t.edge_between(VertexId(6), VertexId(4)), None);
        assert_eq!(t.edge_between(VertexId(6), VertexId(9)), None);
        assert_eq!(t.into_faces(), faces(&list));
    }

    #[test]
    fn duplicate_faces_are_noticed_among_two_faces_of_an_edge_and_among_more() {
        let book = [[0, 1, 2], [0, 1, 3], [1, 0, 4], [5, 0, 1]];
        for (more, expected) in [(None, false), (Some([4, 1, 0]), true), (Some([2, 3, 4]), false)] {
            let list: Vec<_> = book.into_iter().chain(more).collect();
            assert_eq!(Topology::new(6, faces(&list)).has_duplicate_faces(), expected, "{more:?}");
        }
        assert!(Topology::new(3, faces(&[[0, 1, 2], [2, 1, 0]])).has_duplicate_faces());
    }

    #[test]
    fn edges_and_corners_of_any_numbers_belong_together() {
        // More vertices than a block has, in an order without locality.
        let n = 1541u32;
        let list: Vec<_> = (0..n).map(|i| [i, i + 1, i + 2].map(|v| VertexId(v * 7919 % n))).collect();
        let t = Topology::new(n as usize, list.clone());
        assert!(t.edges().is_sorted() && t.edges().iter().all(|[a, b]| a < b));
        for corner in (0..3 * list.len()).map(CornerId::from) {
            let mut ends = t.edge_ends(corner);
            ends.sort_unstable();
            assert_eq!(t.edges()[t.opposite_edge(corner).index()], ends);
            assert!(t.vertex_corners(t.corner_vertex(corner)).contains(&corner));
        }
        for edge in (0..t.n_edges()).map(EdgeId::from) {
            let corners = t.edge_corners(edge);
            assert!(!corners.is_empty() && corners.is_sorted());
            assert!(corners.iter().all(|corner| t.opposite_edge(*corner) == edge));
        }
    }
}
