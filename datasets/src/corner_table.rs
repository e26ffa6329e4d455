//! A closed triangle surface whose edges can be collapsed and flipped.
//!
//! `surface::Topology` provides the initial connectivity but cannot be edited.

use surface::{CornerId, Topology, VertexId};

pub(crate) const DEAD: u32 = u32::MAX;

/// Connectivity of a closed oriented manifold as corners and their twins.
///
/// Corner `c` belongs to face `c / 3`; `twin(c)` is the corner on the other side of the edge opposite to `c`.
///
/// **Invariants.** Twins of living corners are living and mutual. The corners of a vertex form one cycle
/// under [`around`](Self::around). The corners of removed faces have the vertex [`DEAD`].
#[derive(Debug, Clone)]
pub(crate) struct CornerTable {
    vertex: Vec<u32>,
    twin: Vec<u32>,
    /// One corner of each vertex, [`DEAD`] once the vertex is removed.
    corner: Vec<u32>,
}

pub(crate) fn next(c: u32) -> u32 {
    if c % 3 == 2 { c - 2 } else { c + 1 }
}

pub(crate) fn prev(c: u32) -> u32 {
    if c.is_multiple_of(3) { c + 2 } else { c - 1 }
}

impl CornerTable {
    /// `None` unless the faces form a closed, consistently oriented manifold that uses every vertex.
    pub(crate) fn new(n_vertices: usize, faces: &[[VertexId; 3]]) -> Option<Self> {
        let topology = Topology::new(n_vertices, faces.to_vec());
        let vertex: Vec<u32> = faces.iter().flatten().map(|v| v.0).collect();
        let n_corners = vertex.len() as u32;
        let twin = |c: u32| topology.opposite(CornerId(c)).map(|twin| twin.0);
        let twin = (0..n_corners).map(twin).collect::<Option<Vec<u32>>>()?;
        // The two faces at an edge traverse it in opposite directions.
        if (0..n_corners).any(|c| vertex[next(c) as usize] == vertex[next(twin[c as usize]) as usize]) {
            return None;
        }
        let corners = |v: usize| topology.vertex_corners(VertexId::from(v));
        let corner = (0..n_vertices).map(|v| corners(v).last().map(|c| c.0)).collect::<Option<_>>()?;
        let table = Self { vertex, twin, corner };
        (0..n_vertices).all(|v| table.around(v as u32).count() == corners(v).len()).then_some(table)
    }

    pub(crate) fn n_corners(&self) -> u32 {
        self.vertex.len() as u32
    }

    pub(crate) fn vertex(&self, c: u32) -> u32 {
        self.vertex[c as usize]
    }

    pub(crate) fn twin(&self, c: u32) -> u32 {
        self.twin[c as usize]
    }

    pub(crate) fn is_alive(&self, v: u32) -> bool {
        self.corner[v as usize] != DEAD
    }

    /// The corners at `v`, one per face, counter-clockwise as seen from outside.
    pub(crate) fn around(&self, v: u32) -> impl Iterator<Item = u32> + '_ {
        let first = self.corner[v as usize];
        let mut c = Some(first);
        std::iter::from_fn(move || {
            let now = c?;
            let following = next(self.twin(next(now)));
            c = (following != first).then_some(following);
            Some(now)
        })
    }

    /// The neighbours of `v`, one for each corner of [`around`](Self::around).
    pub(crate) fn neighbors(&self, v: u32) -> impl Iterator<Item = u32> + '_ {
        self.around(v).map(|c| self.vertex(next(c)))
    }

    /// The corner opposite the edge from `u` to `w`, in the face that traverses it in that direction.
    pub(crate) fn facing(&self, u: u32, w: u32) -> Option<u32> {
        self.around(u).find(|&c| self.vertex(next(c)) == w).map(prev)
    }

    /// Whether the surface stays a manifold if the edge opposite `c` is collapsed: its ends have no common
    /// neighbours but the two apexes, and the apexes keep at least three neighbours.
    pub(crate) fn can_collapse(&self, c: u32) -> bool {
        let (u, w) = (self.vertex(next(c)), self.vertex(prev(c)));
        let apexes = [self.vertex(c), self.vertex(self.twin(c))];
        let n_common = self.neighbors(u).filter(|&x| self.neighbors(w).any(|y| x == y)).count();
        n_common == 2 && apexes.iter().all(|&p| self.neighbors(p).take(4).count() > 3)
    }

    /// Merges the vertex at `next(c)` into the one at `prev(c)` and removes the two faces of the edge.
    pub(crate) fn collapse(&mut self, c: u32) {
        let o = self.twin(c);
        let (u, w) = (self.vertex(next(c)), self.vertex(prev(c)));
        let moved: Vec<u32> = self.around(u).collect();
        for m in moved {
            self.vertex[m as usize] = w;
        }
        for apex in [c, o] {
            let (a, b) = (self.twin(next(apex)), self.twin(prev(apex)));
            self.twin[a as usize] = b;
            self.twin[b as usize] = a;
            // `a` and `b` are opposite the merged edge from w to the apex.
            let p = self.vertex(apex) as usize;
            let (at_w, at_p) =
                if self.vertex(next(a)) == w { (next(a), prev(a)) } else { (prev(a), next(a)) };
            self.corner[w as usize] = at_w;
            self.corner[p] = at_p;
        }
        for dead in [c, next(c), prev(c), o, next(o), prev(o)] {
            self.vertex[dead as usize] = DEAD;
        }
        self.corner[u as usize] = DEAD;
    }

    /// Whether the edge opposite `c` can be flipped: its apexes are not neighbours, and its ends keep at
    /// least three neighbours.
    pub(crate) fn can_flip(&self, c: u32) -> bool {
        let (p, q) = (self.vertex(c), self.vertex(self.twin(c)));
        let ends = [self.vertex(next(c)), self.vertex(prev(c))];
        p != q
            && ends.iter().all(|&v| self.neighbors(v).take(4).count() > 3)
            && !self.neighbors(p).any(|x| x == q)
    }

    /// Replaces the edge opposite `c` by the one between the two apexes; both faces keep their numbers.
    pub(crate) fn flip(&mut self, c: u32) {
        let o = self.twin(c);
        let (p, q) = (self.vertex(c), self.vertex(o));
        let (u, w) = (self.vertex(next(c)), self.vertex(prev(c)));
        let beyond_c = self.twin(next(c)); // across the edge w p
        let beyond_o = self.twin(next(o)); // across the edge u q
        // Face of c becomes (p, u, q), face of o becomes (q, w, p).
        self.vertex[prev(c) as usize] = q;
        self.vertex[prev(o) as usize] = p;
        self.link(c, beyond_o);
        self.link(o, beyond_c);
        self.link(next(c), next(o));
        self.corner[p as usize] = c;
        self.corner[q as usize] = o;
        self.corner[u as usize] = next(c);
        self.corner[w as usize] = next(o);
    }

    fn link(&mut self, a: u32, b: u32) {
        self.twin[a as usize] = b;
        self.twin[b as usize] = a;
    }

    /// The same surface without removed vertices and faces; the others keep their order.
    pub(crate) fn compacted(&self) -> Self {
        let mut corner_to = vec![DEAD; self.vertex.len()];
        let living: Vec<u32> = (0..self.n_corners()).filter(|&c| self.vertex(c) != DEAD).collect();
        for (i, &c) in living.iter().enumerate() {
            corner_to[c as usize] = i as u32;
        }
        let mut vertex_to = vec![DEAD; self.corner.len()];
        let mut corner = Vec::new();
        for (v, &c) in self.corner.iter().enumerate().filter(|&(_, &c)| c != DEAD) {
            vertex_to[v] = corner.len() as u32;
            corner.push(corner_to[c as usize]);
        }
        let vertex = living.iter().map(|&c| vertex_to[self.vertex(c) as usize]).collect();
        let twin = living.iter().map(|&c| corner_to[self.twin(c) as usize]).collect();
        Self { vertex, twin, corner }
    }

    /// The living faces, in their original order.
    pub(crate) fn faces(&self) -> impl Iterator<Item = [u32; 3]> + '_ {
        self.vertex.chunks_exact(3).filter(|f| f[0] != DEAD).map(|f| [f[0], f[1], f[2]])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn faces(list: &[[u32; 3]]) -> Vec<[VertexId; 3]> {
        list.iter().map(|f| f.map(VertexId)).collect()
    }

    /// A double pyramid over a polygon with `n` corners; the tips are `n` and `n + 1`.
    fn double_pyramid(n: u32) -> CornerTable {
        let sides = (0..n).flat_map(|i| [[i, (i + 1) % n, n], [(i + 1) % n, i, n + 1]]);
        CornerTable::new(n as usize + 2, &faces(&sides.collect::<Vec<_>>())).unwrap()
    }

    fn check(table: &CornerTable, n_vertices: usize) {
        let alive: Vec<u32> = (0..n_vertices as u32).filter(|&v| table.is_alive(v)).collect();
        let renumber = |v: u32| VertexId(alive.binary_search(&v).unwrap() as u32);
        let faces: Vec<_> = table.faces().map(|f| f.map(renumber)).collect();
        assert_eq!(faces.len(), 2 * alive.len() - 4, "a sphere");
        let again = CornerTable::new(alive.len(), &faces).unwrap();
        for (i, &v) in alive.iter().enumerate() {
            assert!(table.around(v).all(|c| table.vertex(c) == v));
            assert_eq!(table.around(v).count(), again.around(i as u32).count());
        }
    }

    #[test]
    fn a_fan_visits_every_neighbour_once() {
        let table = double_pyramid(5);
        assert_eq!(table.neighbors(5).collect::<std::collections::BTreeSet<_>>(), (0..5).collect());
        assert_eq!(table.neighbors(0).count(), 4);
        let c = table.facing(0, 5).unwrap();
        assert_eq!((table.vertex(next(c)), table.vertex(prev(c))), (0, 5));
        check(&table, 7);
    }

    #[test]
    fn flipping_twice_restores_the_edge() {
        let mut table = double_pyramid(6);
        let c = table.facing(0, 6).unwrap();
        assert!(table.can_flip(c));
        table.flip(c);
        check(&table, 8);
        assert!(table.facing(0, 6).is_none());
        table.flip(table.facing(1, 5).unwrap());
        check(&table, 8);
        assert!(table.facing(0, 6).is_some());
    }

    #[test]
    fn collapses_end_at_a_tetrahedron() {
        let mut table = double_pyramid(12);
        for _ in 0..100 {
            let Some(c) = (0..table.n_corners()).find(|&c| table.vertex(c) != DEAD && table.can_collapse(c))
            else {
                break;
            };
            table.collapse(c);
            check(&table, 14);
        }
        assert_eq!(table.faces().count(), 4);
    }

    #[test]
    fn only_closed_oriented_manifolds_have_a_corner_table() {
        let tetrahedron = [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]];
        assert!(CornerTable::new(4, &faces(&tetrahedron)).is_some());
        assert!(CornerTable::new(5, &faces(&tetrahedron)).is_none(), "an unused vertex");
        assert!(CornerTable::new(4, &faces(&tetrahedron[..3])).is_none(), "a hole");
        let mut flipped = tetrahedron;
        flipped[3] = [2, 0, 3];
        assert!(CornerTable::new(4, &faces(&flipped)).is_none(), "a flipped face");
        let twice = [tetrahedron.as_slice(), &tetrahedron.map(|f| f.map(|v| if v == 0 { 0 } else { v + 3 }))];
        assert!(CornerTable::new(7, &faces(&twice.concat())).is_none(), "two surfaces touching in a point");
    }
}
