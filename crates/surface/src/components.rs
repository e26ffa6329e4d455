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

/// The components of any faces, degenerate ones included, in linear time; vertices without faces are in none. Faces
/// that share only a vertex are connected, as paths along edges can pass through it.
pub fn components_of_faces(n_vertices: usize, faces: &[[VertexId; 3]]) -> Components {
    let mut sets = DisjointSets::new(n_vertices);
    let mut has_face = vec![false; n_vertices];
    for [a, b, c] in faces {
        sets.union(a.0, b.0);
        sets.union(b.0, c.0);
        for v in [a, b, c] {
            has_face[v.index()] = true;
        }
    }
    Components::of_sets(sets, |v| has_face[v])
}

/// The components along edges and links; a vertex without either is a component of its own.
pub fn components_with_links(mesh: &IntrinsicMesh) -> Components {
    let mut sets = DisjointSets::new(mesh.n_vertices());
    let links = mesh.links().iter().map(|link| &link.ends);
    for [a, b] in mesh.topology().edges().iter().chain(links) {
        sets.union(a.0, b.0);
    }
    Components::of_sets(sets, |_| true)
}

impl Components {
    /// Numbers the sets of the vertices that are members.
    fn of_sets(mut sets: DisjointSets, is_member: impl Fn(usize) -> bool) -> Self {
        let mut count = 0;
        let mut labels: Vec<Option<u32>> = vec![None; sets.len()];
        for v in (0..sets.len()).filter(|v| is_member(*v)) {
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
