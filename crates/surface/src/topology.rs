//! Who is next to whom: edges, the faces around them, the corners around a vertex.

use crate::{CornerId, EdgeId, VertexId};

/// Connectivity of a triangle mesh whose edges may carry any number of faces.
///
/// There are no half-edges, so an edge with three faces or with two faces of opposite orientation
/// is nothing special: an edge simply lists the corners that face it.
///
/// **Invariants.** Every face has three different vertices below `n_vertices`. Edge ends are sorted
/// (`ends[0] < ends[1]`); edges are in ascending order of their ends; the corners of a vertex and
/// of an edge are in ascending order.
#[derive(Debug, Clone, PartialEq)]
pub struct Topology {
    n_vertices: usize,
    faces: Vec<[VertexId; 3]>,
    edges: Vec<[VertexId; 2]>,
    /// Edge opposite each corner, indexed by corner.
    corner_edge: Vec<EdgeId>,
    vertex_corners: Rows<CornerId>,
    edge_corners: Rows<CornerId>,
}

/// Rows of unequal length stored back to back.
#[derive(Debug, Clone, PartialEq)]
struct Rows<T> {
    offsets: Vec<u32>,
    items: Vec<T>,
}

impl<T: Copy> Rows<T> {
    /// Counting sort of `(row, item)` pairs; items keep their order inside a row.
    fn collect(n_rows: usize, filler: T, pairs: impl Iterator<Item = (usize, T)> + Clone) -> Self {
        let mut offsets = vec![0u32; n_rows + 1];
        for (row, _) in pairs.clone() {
            offsets[row + 1] += 1;
        }
        for row in 0..n_rows {
            offsets[row + 1] += offsets[row];
        }
        let mut next = offsets.clone();
        let mut items = vec![filler; offsets[n_rows] as usize];
        for (row, item) in pairs {
            items[next[row] as usize] = item;
            next[row] += 1;
        }
        Self { offsets, items }
    }

    #[inline]
    fn row(&self, row: usize) -> &[T] {
        &self.items[self.offsets[row] as usize..self.offsets[row + 1] as usize]
    }
}

impl Topology {
    /// Builds the connectivity of `faces` over `n_vertices` vertices, in linear time.
    ///
    /// # Panics
    /// When a face names a vertex twice or one out of range; [`repair`](mesh::repair()) removes the
    /// former, every reader rejects the latter.
    #[must_use]
    pub fn new(n_vertices: usize, faces: Vec<[VertexId; 3]>) -> Self {
        for [a, b, c] in &faces {
            assert!(a != b && b != c && c != a, "degenerate face {a} {b} {c}: repair the mesh first");
            assert!(a.max(b).max(c).index() < n_vertices, "face {a} {b} {c} is out of range");
        }
        let corners = (0..3 * faces.len()).map(|c| CornerId(c as u32));
        let vertex_corners = Rows::collect(
            n_vertices,
            CornerId(0),
            corners.clone().map(|c| (faces[c.face().index()][c.slot()].index(), c)),
        );
        let ends = |c: CornerId| {
            let face = faces[c.face().index()];
            let (a, b) = (face[(c.slot() + 1) % 3], face[(c.slot() + 2) % 3]);
            [a.min(b), a.max(b)]
        };
        // Bucket the corners by the lower end of their edge, then sort each small bucket by the upper.
        let by_lower =
            Rows::collect(n_vertices, CornerId(0), corners.clone().map(|c| (ends(c)[0].index(), c)));
        let mut edges = Vec::with_capacity(faces.len() * 3 / 2 + 1);
        let mut corner_edge = vec![EdgeId(0); 3 * faces.len()];
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
        }
        let edge_corners =
            Rows::collect(edges.len(), CornerId(0), corners.map(|c| (corner_edge[c.index()].index(), c)));
        Self { n_vertices, faces, edges, corner_edge, vertex_corners, edge_corners }
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

    /// The vertex in a corner.
    #[inline]
    #[must_use]
    pub fn corner_vertex(&self, corner: CornerId) -> VertexId {
        self.faces[corner.face().index()][corner.slot()]
    }

    /// The edge opposite a corner in its face.
    #[inline]
    #[must_use]
    pub fn opposite_edge(&self, corner: CornerId) -> EdgeId {
        self.corner_edge[corner.index()]
    }

    /// The corners at a vertex, one for each face around it.
    #[inline]
    #[must_use]
    pub fn vertex_corners(&self, vertex: VertexId) -> &[CornerId] {
        self.vertex_corners.row(vertex.index())
    }

    /// The corners that face an edge, one for each face on it: one on a boundary, two on a
    /// manifold edge, more on a non-manifold one.
    #[inline]
    #[must_use]
    pub fn edge_corners(&self, edge: EdgeId) -> &[CornerId] {
        self.edge_corners.row(edge.index())
    }

    /// The corner on the other side of the edge that `corner` faces; `None` at a boundary and at a
    /// non-manifold edge, where "the other side" has no meaning.
    #[inline]
    #[must_use]
    pub fn across(&self, corner: CornerId) -> Option<CornerId> {
        match *self.edge_corners(self.opposite_edge(corner)) {
            [a, b] => Some(if a == corner { b } else { a }),
            _ => None,
        }
    }

    /// The edge between two vertices, if there is one.
    #[must_use]
    pub fn edge_between(&self, a: VertexId, b: VertexId) -> Option<EdgeId> {
        self.edges.binary_search(&[a.min(b), a.max(b)]).ok().map(EdgeId::from)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn faces(list: &[[u32; 3]]) -> Vec<[VertexId; 3]> {
        list.iter().map(|f| f.map(VertexId)).collect()
    }

    #[test]
    fn tetrahedron_has_six_edges_with_two_faces_each() {
        let t = Topology::new(4, faces(&[[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]]));
        assert_eq!(t.n_edges(), 6);
        for e in 0..6 {
            assert_eq!(t.edge_corners(EdgeId(e)).len(), 2);
        }
        for c in (0..12).map(CornerId) {
            let twin = t.across(c).unwrap();
            assert_eq!(t.across(twin), Some(c));
            assert_eq!(t.opposite_edge(twin), t.opposite_edge(c));
            assert_ne!(t.corner_vertex(twin), t.corner_vertex(c));
        }
        assert_eq!(t.edge_between(VertexId(3), VertexId(1)), Some(EdgeId(4)));
    }

    #[test]
    fn an_edge_with_three_faces_has_no_other_side() {
        let t = Topology::new(5, faces(&[[0, 1, 2], [0, 1, 3], [1, 0, 4]]));
        let shared = t.edge_between(VertexId(0), VertexId(1)).unwrap();
        assert_eq!(t.edge_corners(shared).len(), 3);
        assert_eq!(t.across(CornerId(2)), None);
        assert_eq!(t.vertex_corners(VertexId(1)).len(), 3);
    }
}
