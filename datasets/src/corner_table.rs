//! A closed triangle surface whose edges can be collapsed and flipped.
//!
//! `surface::Topology` provides the initial connectivity but cannot be edited, and `surface::Triangulation`
//! flips edges by their lengths only.

use surface::{CornerId, Topology, VertexId};

/// Connectivity of a closed oriented manifold as corners and their twins.
///
/// The twin of a corner is the one on the other side of the edge opposite to it.
///
/// **Invariants.** Twins of living corners are living and mutual. The corners of a vertex form one cycle
/// under [`around`](Self::around). The corners of removed faces have no vertex.
#[derive(Debug, Clone)]
pub(crate) struct EditableCorners {
    /// The vertex of each corner, [`NO_VERTEX`] once its face is removed.
    vertex: Vec<VertexId>,
    twin: Vec<CornerId>,
    /// One corner of each vertex, [`NO_CORNER`] once the vertex is removed.
    corner: Vec<CornerId>,
    n_vertices: usize,
}

const NO_VERTEX: VertexId = VertexId(u32::MAX);
const NO_CORNER: CornerId = CornerId(u32::MAX);

impl EditableCorners {
    /// `None` unless every vertex has a face and every edge two. The faces are oriented consistently, and those of a vertex
    /// form one cycle.
    pub(crate) fn new(n_vertices: usize, faces: &[[VertexId; 3]]) -> Option<Self> {
        let topology = Topology::new(n_vertices, faces.to_vec());
        let twin =
            (0..3 * faces.len()).map(|c| topology.opposite(CornerId::from(c))).collect::<Option<_>>()?;
        let corner = |v: usize| topology.vertex_corners(VertexId::from(v)).last().copied();
        let corner = (0..n_vertices).map(corner).collect::<Option<_>>()?;
        Some(Self { vertex: faces.concat(), twin, corner, n_vertices })
    }

    /// The number of vertices that have not been removed.
    pub(crate) fn n_vertices(&self) -> usize {
        self.n_vertices
    }

    pub(crate) fn n_corners(&self) -> usize {
        self.vertex.len()
    }

    pub(crate) fn vertex(&self, c: CornerId) -> VertexId {
        self.vertex[c.index()]
    }

    pub(crate) fn twin(&self, c: CornerId) -> CornerId {
        self.twin[c.index()]
    }

    /// The vertices that have not been removed, in ascending order.
    pub(crate) fn vertices(&self) -> impl Iterator<Item = VertexId> + '_ {
        (0..self.corner.len()).map(VertexId::from).filter(|&v| self.is_alive(v))
    }

    pub(crate) fn is_alive(&self, v: VertexId) -> bool {
        self.corner[v.index()] != NO_CORNER
    }

    /// The corners at `v`, one per face, counter-clockwise as seen from outside.
    pub(crate) fn around(&self, v: VertexId) -> impl Iterator<Item = CornerId> + '_ {
        let first = self.corner[v.index()];
        let mut c = Some(first);
        std::iter::from_fn(move || {
            let now = c?;
            let following = self.twin(now.next()).next();
            c = (following != first).then_some(following);
            Some(now)
        })
    }

    /// The neighbors of `v`, one for each corner of [`around`](Self::around).
    pub(crate) fn neighbors(&self, v: VertexId) -> impl Iterator<Item = VertexId> + '_ {
        self.around(v).map(|c| self.vertex(c.next()))
    }

    /// Whether the surface stays a manifold if the edge opposite `c` is collapsed: its ends have no common
    /// neighbors but the two apexes, and the apexes keep at least three neighbors.
    pub(crate) fn can_collapse(&self, c: CornerId) -> bool {
        let (u, w) = (self.vertex(c.next()), self.vertex(c.prev()));
        let apexes = [self.vertex(c), self.vertex(self.twin(c))];
        let n_common = self.neighbors(u).filter(|&x| self.neighbors(w).any(|y| x == y)).count();
        n_common == 2 && apexes.iter().all(|&p| self.neighbors(p).take(4).count() > 3)
    }

    /// Merges the vertex at `c.next()` into the one at `c.prev()` and removes the two faces of the edge.
    pub(crate) fn collapse(&mut self, c: CornerId) {
        let o = self.twin(c);
        let (u, w) = (self.vertex(c.next()), self.vertex(c.prev()));
        let moved: Vec<CornerId> = self.around(u).collect();
        for m in moved {
            self.vertex[m.index()] = w;
        }
        for apex in [c, o] {
            let (a, b) = (self.twin(apex.next()), self.twin(apex.prev()));
            self.link(a, b);
            // `a` and `b` are opposite the merged edge from w to the apex.
            let p = self.vertex(apex).index();
            let (at_w, at_p) =
                if self.vertex(a.next()) == w { (a.next(), a.prev()) } else { (a.prev(), a.next()) };
            self.corner[w.index()] = at_w;
            self.corner[p] = at_p;
        }
        for dead in [c, c.next(), c.prev(), o, o.next(), o.prev()] {
            self.vertex[dead.index()] = NO_VERTEX;
        }
        self.corner[u.index()] = NO_CORNER;
        self.n_vertices -= 1;
    }

    /// Whether the edge opposite `c` can be flipped: its apexes are not neighbors, and its ends keep at
    /// least three neighbors.
    pub(crate) fn can_flip(&self, c: CornerId) -> bool {
        let (p, q) = (self.vertex(c), self.vertex(self.twin(c)));
        let ends = [self.vertex(c.next()), self.vertex(c.prev())];
        p != q
            && ends.iter().all(|&v| self.neighbors(v).take(4).count() > 3)
            && !self.neighbors(p).any(|x| x == q)
    }

    /// Replaces the edge opposite `c` by the one between the two apexes; both faces keep their numbers.
    pub(crate) fn flip(&mut self, c: CornerId) {
        let o = self.twin(c);
        let (p, q) = (self.vertex(c), self.vertex(o));
        let (u, w) = (self.vertex(c.next()), self.vertex(c.prev()));
        let beyond_c = self.twin(c.next()); // across the edge w p
        let beyond_o = self.twin(o.next()); // across the edge u q
        // Face of c becomes (p, u, q), face of o becomes (q, w, p).
        self.vertex[c.prev().index()] = q;
        self.vertex[o.prev().index()] = p;
        self.link(c, beyond_o);
        self.link(o, beyond_c);
        self.link(c.next(), o.next());
        self.corner[p.index()] = c;
        self.corner[q.index()] = o;
        self.corner[u.index()] = c.next();
        self.corner[w.index()] = o.next();
    }

    fn link(&mut self, a: CornerId, b: CornerId) {
        self.twin[a.index()] = b;
        self.twin[b.index()] = a;
    }

    /// The same surface without removed vertices and faces; the others keep their order.
    pub(crate) fn compacted(&self) -> Self {
        let living: Vec<usize> = (0..self.n_corners()).filter(|&c| self.vertex[c] != NO_VERTEX).collect();
        let mut corner_to = vec![NO_CORNER; self.n_corners()];
        for (i, &c) in living.iter().enumerate() {
            corner_to[c] = CornerId::from(i);
        }
        let mut vertex_to = vec![NO_VERTEX; self.corner.len()];
        for (i, v) in self.vertices().enumerate() {
            vertex_to[v.index()] = VertexId::from(i);
        }
        Self {
            vertex: living.iter().map(|&c| vertex_to[self.vertex[c].index()]).collect(),
            twin: living.iter().map(|&c| corner_to[self.twin[c].index()]).collect(),
            corner: self.vertices().map(|v| corner_to[self.corner[v.index()].index()]).collect(),
            n_vertices: self.n_vertices,
        }
    }

    /// The living faces, in their original order.
    pub(crate) fn faces(&self) -> impl Iterator<Item = [VertexId; 3]> + '_ {
        self.vertex.as_chunks().0.iter().copied().filter(|face| face[0] != NO_VERTEX)
    }
}
