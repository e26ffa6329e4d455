//! Connected components.

use crate::disjoint_sets::DisjointSets;
use crate::ids::VertexId;
use crate::intrinsic::IntrinsicMesh;

/// The connected components of a mesh.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Components {
    /// Number of components.
    pub count: usize,
    /// The component of every vertex, in the order of their lowest vertices; `None` for a vertex in no component.
    pub labels: Vec<Option<u32>>,
}

/// The components of any faces, degenerate ones included; vertices without faces are in none. Faces that share only a vertex are
/// connected, as paths along edges can pass through it.
pub fn components_of_faces(n_vertices: usize, faces: &[[VertexId; 3]]) -> Components {
    Components::joined(n_vertices, faces.iter().flat_map(|&[a, b, c]| [[a, b], [b, c]]))
}

/// The components along edges and links; a vertex without either is a component of its own.
pub fn components_with_links(mesh: &IntrinsicMesh) -> Components {
    let vertices = (0..mesh.n_vertices()).map(|v| [VertexId::from(v); 2]);
    let links = mesh.links().iter().map(|link| link.ends);
    let edges = mesh.topology().edges().iter().copied();
    Components::joined(mesh.n_vertices(), vertices.chain(edges).chain(links))
}

impl Components {
    /// The components along edges, of which each has two ends, in linear time; other vertices are in none.
    pub fn joined(n_vertices: usize, edges: impl Iterator<Item = [VertexId; 2]>) -> Self {
        let (mut sets, mut is_member) = (DisjointSets::new(n_vertices), vec![false; n_vertices]);
        for ends in edges {
            sets.union(ends[0].0, ends[1].0);
            ends.into_iter().for_each(|v| is_member[v.index()] = true);
        }
        let (mut count, mut labels) = (0, vec![None; n_vertices]);
        for v in (0..n_vertices).filter(|v| is_member[*v]) {
            // The root is the lowest member of its set, so it is numbered first.
            let root = sets.find(v as u32) as usize;
            if root == v {
                labels[v] = Some(count);
                count += 1;
            } else {
                labels[v] = labels[root];
            }
        }
        Self { count: count as usize, labels }
    }

    /// The component of a vertex; `None` if it is in none.
    pub fn of(&self, vertex: VertexId) -> Option<usize> {
        self.labels[vertex.index()].map(|label| label as usize)
    }

    /// The lowest vertex of every component.
    pub fn lowest_vertices(&self) -> Vec<VertexId> {
        let mut lowest = Vec::with_capacity(self.count);
        for (v, label) in self.labels.iter().enumerate() {
            if *label == Some(lowest.len() as u32) {
                lowest.push(VertexId::from(v));
            }
        }
        lowest
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::intrinsic::Link;
    use crate::topology::Topology;

    fn labels(components: &Components) -> Vec<i64> {
        components.labels.iter().map(|label| label.map_or(-1, i64::from)).collect()
    }

    #[test]
    fn components_are_numbered_by_their_lowest_vertices() {
        let faces = [[6, 5, 4], [1, 2, 3], [3, 8, 9]].map(|f| f.map(VertexId));
        let topology = Topology::new(10, faces.to_vec());
        let found = components_of_faces(10, topology.faces());
        assert_eq!((found.count, labels(&found)), (2, vec![-1, 0, 0, 0, 1, 1, 1, -1, 0, 0]));
        assert_eq!(found.lowest_vertices(), [1, 4].map(VertexId));

        let lengths = vec![1.0; topology.n_edges()];
        let link = Link { ends: [0, 6].map(VertexId), length: 1.0 };
        let found = components_with_links(&IntrinsicMesh::new(topology, lengths).with_links(vec![link]));
        assert_eq!((found.count, labels(&found)), (3, vec![0, 1, 1, 1, 0, 0, 0, 2, 1, 1]));
        assert_eq!(found.lowest_vertices(), [0, 1, 7].map(VertexId));
    }
}
