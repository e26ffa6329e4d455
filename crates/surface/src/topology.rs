//! Connectivity: edges, the faces on each edge, the corners at each vertex.

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

/// Vertices and corners of a mesh are fewer: solvers keep flags beside their numbers, in the upper two of 32 bits.
const LIMIT: usize = 1 << 30;

/// Number of vertices whose edges one thread collects at a time.
const BLOCK: usize = 512;

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
        // The sides to higher vertices in the order of the edges, and the corners opposite.
        let sides_of = |first: usize| {
            let mut sides = Vec::new();
            for lower in (first..n_vertices.min(first + BLOCK)).map(|v| VertexId(v as u32)) {
                let start = sides.len();
                for corner in vertex_corners.row(lower.index()) {
                    let face = faces[corner.face().index()];
                    let ends = [(corner.next(), corner.prev()), (corner.prev(), corner.next())];
                    let ends = ends.map(|(end, opposite)| ([lower, face[end.slot()]], opposite));
                    sides.extend(ends.into_iter().filter(|([lower, upper], _)| lower < upper));
                }
                sides[start..].sort_unstable_by_key(|([_, upper], corner)| (*upper, *corner));
            }
            sides
        };
        let blocks = (0..n_vertices).into_par_iter().step_by(BLOCK).map(sides_of);
        let blocks: Vec<Vec<([VertexId; 2], CornerId)>> = blocks.collect();
        let (mut edges, mut first_edge) = (Vec::with_capacity(faces.len() * 3 / 2), vec![0; n_vertices + 1]);
        let (mut ends, mut corners) = (vec![0], Vec::with_capacity(3 * faces.len()));
        let mut corner_edge = vec![EdgeId(0); 3 * faces.len()];
        for around in blocks.iter().flat_map(|sides| sides.chunk_by(|a, b| a.0 == b.0)) {
            for (_, corner) in around {
                corner_edge[corner.index()] = EdgeId(edges.len() as u32);
                corners.push(*corner);
            }
            edges.push(around[0].0);
            ends.push(corners.len() as u32);
            first_edge[around[0].0[0].index() + 1] = edges.len() as u32;
        }
        // Vertices without higher neighbors.
        (0..n_vertices).for_each(|v| first_edge[v + 1] = first_edge[v + 1].max(first_edge[v]));
        let edge_corners = Rows::from_offsets(ends, corners);
        Self { n_vertices, faces, edges, first_edge, corner_edge, vertex_corners, edge_corners }
    }

    /// The vertices of every face, without the connectivity.
    pub fn into_faces(self) -> Vec<[VertexId; 3]> {
        self.faces
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
        let (low, high) = (a.min(b).index(), a.max(b));
        if high.index() >= self.n_vertices {
            return None;
        }
        let [start, end] = [low, low + 1].map(|v| self.first_edge[v] as usize);
        let found = self.edges[start..end].binary_search_by_key(&high, |ends| ends[1]);
        found.ok().map(|i| EdgeId::from(start + i))
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
