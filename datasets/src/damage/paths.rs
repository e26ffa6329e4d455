//! Lengths of shortest paths along edges.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use mesh::TriMesh;

/// The neighbours of every vertex with the lengths of the edges to them; those of inner edges come twice.
pub(super) struct Edges(Vec<Vec<(u32, f64)>>);

impl Edges {
    pub(super) fn of(mesh: &TriMesh) -> Self {
        let mut edges = vec![Vec::new(); mesh.n_vertices()];
        for face in &mesh.faces {
            for (a, b) in [(0, 1), (1, 2), (2, 0)].map(|(i, j)| (face[i], face[j])) {
                let length = (mesh.positions[a.index()] - mesh.positions[b.index()]).norm();
                edges[a.index()].push((b.0, length));
                edges[b.index()].push((a.0, length));
            }
        }
        Self(edges)
    }

    /// The neighbours of a vertex.
    pub(super) fn near(&self, v: usize) -> impl Iterator<Item = usize> + '_ {
        self.0[v].iter().map(|(w, _)| *w as usize)
    }

    /// Whether a vertex has a face.
    pub(super) fn is_used(&self, v: usize) -> bool {
        !self.0[v].is_empty()
    }

    /// The length of the shortest path from `source` to every vertex; infinite for another component.
    pub(super) fn lengths(&self, source: usize) -> Vec<f64> {
        let mut lengths = vec![f64::INFINITY; self.0.len()];
        lengths[source] = 0.0;
        // Nonnegative numbers are ordered as their bits are.
        let mut queue = BinaryHeap::from([Reverse((0u64, source as u32))]);
        while let Some(Reverse((bits, v))) = queue.pop() {
            let here = f64::from_bits(bits);
            if here > lengths[v as usize] {
                continue;
            }
            for &(w, edge) in &self.0[v as usize] {
                if here + edge < lengths[w as usize] {
                    lengths[w as usize] = here + edge;
                    queue.push(Reverse(((here + edge).to_bits(), w)));
                }
            }
        }
        lengths
    }
}

/// The largest of the finite lengths with its vertex.
pub(super) fn farthest(lengths: &[f64]) -> (usize, f64) {
    let finite = lengths.iter().copied().enumerate().filter(|(_, length)| length.is_finite());
    finite.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, 0.0))
}
