//! Shortest paths along edges.

use crate::frontier::Frontier;
use crate::ids::VertexId;
use crate::intrinsic::{IntrinsicMesh, Link};
use crate::rows::Rows;

/// A straight connection from a vertex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Way {
    /// Its other end.
    pub to: VertexId,
    /// Its place among the connections that the graph was made of.
    pub number: u32,
    /// Its length.
    pub length: f64,
}

/// Vertices and the straight connections between them.
///
/// ```
/// use canonform_surface::{EdgeGraph, Frontier, Link, VertexId};
///
/// let link = |a, b, length| Link { ends: [a, b].map(VertexId), length };
/// let graph = EdgeGraph::new(4, [link(0, 1, 1.0), link(1, 2, 1.0), link(2, 0, 1.5)].into_iter());
/// assert_eq!(graph.from(VertexId(0)), [0.0, 1.0, 1.5, f64::INFINITY]);
/// let near = graph.within(&mut Frontier::default(), &[VertexId(0)], 1.0, |_| false);
/// assert_eq!(near, [(VertexId(0), 0.0), (VertexId(1), 1.0)]);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct EdgeGraph(Rows<Way>);

impl EdgeGraph {
    /// The graph of some connections of `n_vertices` vertices.
    pub fn new(n_vertices: usize, links: impl Iterator<Item = Link> + Clone) -> Self {
        let both = |(number, Link { ends: [a, b], length }): (u32, Link)| {
            [(a.index(), Way { to: b, number, length }), (b.index(), Way { to: a, number, length })]
        };
        Self(Rows::collect(n_vertices, (0..).zip(links).flat_map(both)))
    }

    /// The edges of a surface in their order, then its links.
    pub fn of(mesh: &IntrinsicMesh) -> Self {
        let edges = mesh.topology().edges().iter().zip(mesh.edge_lengths());
        let edges = edges.map(|(ends, length)| Link { ends: *ends, length: *length });
        Self::new(mesh.n_vertices(), edges.chain(mesh.links().iter().copied()))
    }

    /// Number of vertices.
    pub fn n_vertices(&self) -> usize {
        self.0.n_rows()
    }

    /// The connections at a vertex.
    #[inline]
    pub fn ways(&self, v: VertexId) -> &[Way] {
        self.0.row(v.index())
    }

    /// Visits the vertices that wait in a frontier, and all within `radius` along the graph, from the nearest to the farthest,
    /// while `visit` says to go on (Dijkstra 1959). Tells of every connection that lowers the distance of its other end.
    pub fn search(
        &self,
        front: &mut Frontier,
        radius: f64,
        mut visit: impl FnMut(VertexId, f64) -> bool,
        mut lowers: impl FnMut(VertexId, &Way),
    ) {
        while let Some((distance, v)) = front.pop()
            && visit(v, distance)
        {
            for way in self.ways(v) {
                let there = distance + way.length;
                if there <= radius && front.relax(way.to, there) {
                    lowers(v, way);
                }
            }
        }
    }

    /// The vertices within `radius` of the sources with their distances, from the nearest to the farthest, up to the first one
    /// at which to `stop`. Takes time in proportion to the vertices that are reached.
    pub fn within(
        &self,
        front: &mut Frontier,
        sources: &[VertexId],
        radius: f64,
        mut stop: impl FnMut(VertexId) -> bool,
    ) -> Vec<(VertexId, f64)> {
        front.reset(self.n_vertices());
        sources.iter().for_each(|v| _ = front.relax(*v, 0.0));
        let mut found = Vec::new();
        let visit = |v, distance| {
            found.push((v, distance));
            !stop(v)
        };
        self.search(front, radius, visit, |_, _| ());
        found
    }

    /// The distance between two sets of vertices; infinite if it is more than `radius`, or there is no path.
    pub fn between(
        &self,
        front: &mut Frontier,
        sources: &[VertexId],
        targets: &[VertexId],
        radius: f64,
    ) -> f64 {
        let found = self.within(front, sources, radius, |v| targets.contains(&v));
        found.last().filter(|(v, _)| targets.contains(v)).map_or(f64::INFINITY, |(_, distance)| *distance)
    }

    /// The distance from a vertex to every vertex; infinite for another component.
    pub fn from(&self, source: VertexId) -> Vec<f64> {
        let mut front = Frontier::default();
        front.reset(self.n_vertices());
        front.relax(source, 0.0);
        self.search(&mut front, f64::INFINITY, |_, _| true, |_, _| ());
        front.into_distances()
    }
}

#[cfg(test)]
mod tests {
    use mesh::shapes;

    use super::*;
    use crate::testing::intrinsic;

    #[test]
    fn searches_do_not_depend_on_earlier_ones() {
        let mesh = intrinsic(&shapes::disjoint(&[shapes::icosphere(2), shapes::cube(1)]));
        let (graph, mut front) = (EdgeGraph::of(&mesh), Frontier::default());
        let whole = graph.from(VertexId(5));
        assert_eq!(whole[5], 0.0);
        assert!(whole.last().is_some_and(|far| far.is_infinite()));
        let near = graph.within(&mut front, &[VertexId(5), VertexId(5)], 0.5, |_| false);
        let expected = whole.iter().filter(|distance| **distance <= 0.5).count();
        assert_eq!(near.len(), expected);
        assert!(near.iter().all(|(v, distance)| whole[v.index()] == *distance));
        assert!(near.windows(2).all(|pair| pair[0].1 <= pair[1].1));
        let to = VertexId(17);
        assert_eq!(graph.between(&mut front, &[to], &[VertexId(5)], 10.0), graph.from(to)[5]);
        assert!(graph.between(&mut front, &[to], &[VertexId(5)], 0.5 * whole[17]).is_infinite());
    }
}
