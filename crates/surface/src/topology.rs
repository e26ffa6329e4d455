//! Connectivity: edges, the faces on each edge, the corners at each vertex.

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
}

impl Topology {
    /// Builds the connectivity of `faces` over `n_vertices` vertices, in linear time.
    ///
    /// # Panics
    /// If a face has a vertex twice (`mesh::repair` removes such faces) or out of range (readers reject such files).
    #[must_use]
    pub fn new(n_vertices: usize, faces: Vec<[VertexId; 3]>) -> Self {
        for [a, b, c] in &faces {
            assert!(a != b && b != c && c != a, "degenerate face {a} {b} {c}: repair the mesh first");
            assert!(a.max(b).max(c).index() < n_vertices, "face {a} {b} {c} is out of range");
        }
        let corners = (0..3 * faces.len()).map(|c| CornerId(c as u32));
        let vertex_corners = Rows::collect(
            n_vertices,
            corners.clone().map(|c| (faces[c.face().index()][c.slot()].index(), c)),
        );
        let ends = |c: CornerId| {
            let face = faces[c.face().index()];
            let [a, b] = [face[(c.slot() + 1) % 3], face[(c.slot() + 2) % 3]];
            [a.min(b), a.max(b)]
        };
        // Bucket the corners by the lower end of their edge, then sort each small bucket by the upper.
        let by_lower = Rows::collect(n_vertices, corners.clone().map(|c| (ends(c)[0].index(), c)));
        let mut edges = Vec::with_capacity(faces.len() * 3 / 2 + 1);
        let mut corner_edge = vec![EdgeId(0); 3 * faces.len()];
        let mut first_edge = Vec::with_capacity(n_vertices + 1);
        first_edge.push(0);
        let mut bucket = Vec::new();
        for lower in 0..n_vertices {
            bucket.clear();
            bucket.extend(by_lower.row(lower).iter().map(|&c| (ends(c)[1], c)));
            bucket.sort_unstable();
            for (i, &(upper, corner)) in bucket.iter().enumerate() {
                if i == 0 || bucket[i - 1].0 != upper {
                    edges.push([VertexId(lower as u32), upper]);
                }
                corner_edge[corner.index()] = EdgeId::from(edges.len() - 1);
            }
            first_edge.push(edges.len() as u32);
        }
        let edge_corners = Rows::collect(edges.len(), corners.map(|c| (corner_edge[c.index()].index(), c)));
        Self { n_vertices, faces, edges, first_edge, corner_edge, vertex_corners, edge_corners }
    }

    /// Number of vertices.
    #[must_use]
    pub fn n_vertices(&self) -> usize {
        self.n_vertices
    }

    /// Number of faces.
    #[must_use]
    pub fn n_faces(&self) -> usize {
        self.faces.len()
    }

    /// Number of undirected edges.
    #[must_use]
    pub fn n_edges(&self) -> usize {
        self.edges.len()
    }

    /// The vertices of every face.
    #[must_use]
    pub fn faces(&self) -> &[[VertexId; 3]] {
        &self.faces
    }

    /// The two ends of every edge, the lower first.
    #[must_use]
    pub fn edges(&self) -> &[[VertexId; 2]] {
        &self.edges
    }

    /// The edges from a vertex to higher ones, in ascending order.
    #[inline]
    #[must_use]
    pub fn edges_above(&self, vertex: VertexId) -> &[[VertexId; 2]] {
        &self.edges[self.range_above(vertex)]
    }

    fn range_above(&self, vertex: VertexId) -> std::ops::Range<usize> {
        let v = vertex.index();
        self.first_edge[v] as usize..self.first_edge[v + 1] as usize
    }

    /// The vertex in a corner.
    #[inline]
    #[must_use]
    pub fn corner_vertex(&self, corner: CornerId) -> VertexId {
        self.faces[corner.face().index()][corner.slot()]
    }

    /// The edge opposite a corner.
    #[inline]
    #[must_use]
    pub fn opposite_edge(&self, corner: CornerId) -> EdgeId {
        self.corner_edge[corner.index()]
    }

    /// The vertices at the ends of the edge opposite a corner: in the next and in the previous corner.
    #[inline]
    #[must_use]
    pub fn edge_ends(&self, corner: CornerId) -> [VertexId; 2] {
        [corner.next(), corner.prev()].map(|end| self.corner_vertex(end))
    }

    /// The edges from a corner to the vertices in the next and in the previous corner of its face.
    #[inline]
    #[must_use]
    pub fn corner_edges(&self, corner: CornerId) -> [EdgeId; 2] {
        [corner.prev(), corner.next()].map(|third| self.opposite_edge(third))
    }

    /// The corner of a face at one of its vertices; `None` for other vertices.
    #[must_use]
    pub fn corner_at(&self, face: FaceId, vertex: VertexId) -> Option<CornerId> {
        face.corners().into_iter().find(|corner| self.corner_vertex(*corner) == vertex)
    }

    /// The corners at a vertex, one for each face around it.
    #[inline]
    #[must_use]
    pub fn vertex_corners(&self, vertex: VertexId) -> &[CornerId] {
        self.vertex_corners.row(vertex.index())
    }

    /// The corners opposite an edge, one per face: one at the boundary, over two if it is non-manifold.
    #[inline]
    #[must_use]
    pub fn edge_corners(&self, edge: EdgeId) -> &[CornerId] {
        self.edge_corners.row(edge.index())
    }

    /// The corner opposite the same edge in the other face; `None` if the edge does not have exactly two faces.
    #[inline]
    #[must_use]
    pub fn opposite(&self, corner: CornerId) -> Option<CornerId> {
        match *self.edge_corners(self.opposite_edge(corner)) {
            [a, b] => Some(if a == corner { b } else { a }),
            _ => None,
        }
    }

    /// The edge between two vertices, if there is one.
    #[must_use]
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
}
