//! Distances along edges.

use surface::{NearestFirst, Rows, VertexId};

use crate::tri_mesh::TriMesh;

/// The edges of a mesh with their lengths, for shortest paths along them (Dijkstra).
///
/// ```
/// use canonform_mesh::{EdgeGraph, shapes};
/// use surface::VertexId;
///
/// let mut graph = EdgeGraph::of(&shapes::grid(3, 3, 1.0));
/// assert_eq!(graph.between(&[VertexId(0)], &[VertexId(2)], f64::INFINITY), 2.0);
/// assert_eq!(graph.within(&[VertexId(0)], 1.0, |_| false).len(), 3);
/// ```
#[derive(Debug, Clone)]
pub struct EdgeGraph {
    /// The other ends of the edges at every vertex; inner edges come twice.
    edges: Rows<(VertexId, f64)>,
    /// Infinite between searches.
    distance: Vec<f64>,
}

impl EdgeGraph {
    /// The graph of all edges of a mesh.
    #[must_use]
    pub fn of(mesh: &TriMesh) -> Self {
        let sides = mesh.faces.iter().flat_map(|&[a, b, c]| [[a, b], [b, a], [b, c], [c, b], [c, a], [a, c]]);
        let pairs = sides.map(|[a, b]| {
            let length = (mesh.positions[b.index()] - mesh.positions[a.index()]).norm();
            (a.index(), (b, length))
        });
        let edges = Rows::collect(mesh.n_vertices(), pairs);
        Self { edges, distance: vec![f64::INFINITY; mesh.n_vertices()] }
    }

    /// The neighbours of a vertex; most come twice.
    pub fn neighbors(&self, v: VertexId) -> impl Iterator<Item = VertexId> + '_ {
        self.edges.row(v.index()).iter().map(|(w, _)| *w)
    }

    /// The vertices within `radius` of the sources with their distances, from the nearest to the farthest, up to the first
    /// one at which to `stop`. Takes time in proportion to the vertices that are reached.
    pub fn within(
        &mut self,
        sources: &[VertexId],
        radius: f64,
        mut stop: impl FnMut(VertexId) -> bool,
    ) -> Vec<(VertexId, f64)> {
        let mut reached = sources.to_vec();
        let mut queue: NearestFirst<VertexId> = sources.iter().map(|v| (0.0, *v)).collect();
        sources.iter().for_each(|v| self.distance[v.index()] = 0.0);
        let mut found: Vec<(VertexId, f64)> = Vec::new();
        while let Some((here, v)) = queue.pop() {
            // A source that was given twice is found once.
            if here > self.distance[v.index()] || found.last().is_some_and(|(last, _)| *last == v) {
                continue;
            }
            found.push((v, here));
            if stop(v) {
                break;
            }
            for &(w, length) in self.edges.row(v.index()) {
                let there = here + length;
                if there < self.distance[w.index()] && there <= radius {
                    if self.distance[w.index()].is_infinite() {
                        reached.push(w);
                    }
                    self.distance[w.index()] = there;
                    queue.push(there, w);
                }
            }
        }
        reached.into_iter().for_each(|v| self.distance[v.index()] = f64::INFINITY);
        found
    }

    /// The distance between two sets of vertices; infinite if it is more than `radius`, or there is no path.
    pub fn between(&mut self, sources: &[VertexId], targets: &[VertexId], radius: f64) -> f64 {
        let found = self.within(sources, radius, |v| targets.contains(&v));
        found.last().filter(|(v, _)| targets.contains(v)).map_or(f64::INFINITY, |(_, distance)| *distance)
    }

    /// The distance from a vertex to every vertex; infinite for another component.
    pub fn from(&mut self, source: VertexId) -> Vec<f64> {
        let mut distances = vec![f64::INFINITY; self.distance.len()];
        for (v, distance) in self.within(&[source], f64::INFINITY, |_| false) {
            distances[v.index()] = distance;
        }
        distances
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;

    #[test]
    fn searches_do_not_depend_on_earlier_ones() {
        let mesh = shapes::disjoint(&[shapes::icosphere(2), shapes::cube(1)]);
        let mut graph = EdgeGraph::of(&mesh);
        let whole = graph.from(VertexId(5));
        assert_eq!(whole[5], 0.0);
        assert!(whole.last().is_some_and(|far| far.is_infinite()));
        let near = graph.within(&[VertexId(5), VertexId(5)], 0.5, |_| false);
        let expected = whole.iter().filter(|distance| **distance <= 0.5).count();
        assert_eq!(near.len(), expected);
        assert!(near.iter().all(|(v, distance)| whole[v.index()] == *distance));
        assert!(near.windows(2).all(|pair| pair[0].1 <= pair[1].1));
        assert_eq!(graph.from(VertexId(5)), whole);
        let to = VertexId(17);
        assert_eq!(graph.between(&[to], &[VertexId(5)], 10.0), graph.from(to)[5]);
        assert!(graph.between(&[to], &[VertexId(5)], 0.5 * whole[17]).is_infinite());
    }
}
