//! Connected pieces of a mesh.

use crate::disjoint_sets::DisjointSets;
use crate::{Topology, VertexId};

/// The connected components of a mesh: faces are connected when they share a vertex.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Components {
    /// Number of components.
    pub count: usize,
    /// The component of every vertex, numbered in the order of their lowest vertices; `None` for a
    /// vertex that no face names.
    pub labels: Vec<Option<u32>>,
}

/// The connected components of a mesh, in time linear in its faces.
///
/// Two faces that touch in one vertex only are connected: a walk along edges passes through it.
#[must_use]
pub fn components(topology: &Topology) -> Components {
    components_of_faces(topology.n_vertices(), topology.faces())
}

/// The same for any list of faces, degenerate ones included.
pub fn components_of_faces(n_vertices: usize, faces: &[[VertexId; 3]]) -> Components {
    let mut sets = DisjointSets::new(n_vertices);
    let mut named = vec![false; n_vertices];
    for [a, b, c] in faces {
        sets.union(a.0, b.0);
        sets.union(b.0, c.0);
        for v in [a, b, c] {
            named[v.index()] = true;
        }
    }
    let mut count = 0;
    let mut labels: Vec<Option<u32>> = vec![None; n_vertices];
    for v in (0..n_vertices).filter(|&v| named[v]) {
        let root = sets.find(v as u32) as usize;
        // The root is the lowest member of its set, so it gets its number first.
        if root == v {
            labels[v] = Some(count);
            count += 1;
        } else {
            labels[v] = labels[root];
        }
    }
    Components { count: count as usize, labels }
}

impl Components {
    /// The component of a vertex that a face names.
    pub fn of(&self, vertex: VertexId) -> usize {
        self.labels[vertex.index()].map_or(0, |label| label as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_are_numbered_by_their_lowest_vertex_and_loose_vertices_have_none() {
        let faces = [[6, 5, 4], [1, 2, 3], [3, 8, 9]].map(|f| f.map(VertexId));
        let c = components(&Topology::new(10, faces.to_vec()));
        assert_eq!(c.count, 2);
        let labels: Vec<i64> = c.labels.iter().map(|l| l.map_or(-1, i64::from)).collect();
        assert_eq!(labels, [-1, 0, 0, 0, 1, 1, 1, -1, 0, 0]);
    }

    #[test]
    fn without_faces_there_is_no_component() {
        let c = components(&Topology::new(3, Vec::new()));
        assert_eq!((c.count, c.labels), (0, vec![None; 3]));
    }
}
