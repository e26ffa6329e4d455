//! Distances along edges.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use surface::VertexId;

use crate::tri_mesh::TriMesh;

/// The edges of a mesh by their ends, with their lengths.
pub(super) struct Graph {
    start: Vec<usize>,
    ends: Vec<(u32, f64)>,
}

impl Graph {
    pub(super) fn of(mesh: &TriMesh) -> Self {
        let n = mesh.n_vertices();
        let sides = |face: &[VertexId; 3]| {
            let [a, b, c] = *face;
            [[a, b], [b, a], [b, c], [c, b], [c, a], [a, c]]
        };
        let mut start = vec![0; n + 1];
        for [a, _] in mesh.faces.iter().flat_map(sides) {
            start[a.index() + 1] += 1;
        }
        for v in 0..n {
            start[v + 1] += start[v];
        }
        let mut next = start.clone();
        let mut ends = vec![(0, 0.0); start[n]];
        for [a, b] in mesh.faces.iter().flat_map(sides) {
            let length = (mesh.positions[b.index()] - mesh.positions[a.index()]).norm();
            ends[next[a.index()]] = (b.0, length);
            next[a.index()] += 1;
        }
        Self { start, ends }
    }

    /// The vertices within `radius` of the sources with their distances, in order of distance, until `stop` says so.
    pub(super) fn within(
        &self,
        sources: &[VertexId],
        radius: f64,
        mut stop: impl FnMut(VertexId) -> bool,
    ) -> Vec<(VertexId, f64)> {
        let mut distance = vec![f64::INFINITY; self.start.len() - 1];
        // Nonnegative numbers are ordered as their bits are.
        let mut queue: BinaryHeap<Reverse<(u64, u32)>> = sources.iter().map(|v| Reverse((0, v.0))).collect();
        sources.iter().for_each(|v| distance[v.index()] = 0.0);
        let mut found = Vec::new();
        let mut is_final = vec![false; distance.len()];
        while let Some(Reverse((bits, v))) = queue.pop() {
            if std::mem::replace(&mut is_final[v as usize], true) {
                continue;
            }
            let here = f64::from_bits(bits);
            found.push((VertexId(v), here));
            if stop(VertexId(v)) {
                break;
            }
            for &(w, length) in &self.ends[self.start[v as usize]..self.start[v as usize + 1]] {
                let there = here + length;
                if there < distance[w as usize] && there <= radius {
                    distance[w as usize] = there;
                    queue.push(Reverse((there.to_bits(), w)));
                }
            }
        }
        found
    }

    /// The distance between two sets of vertices; infinite if there is no path.
    pub(super) fn between(&self, sources: &[VertexId], targets: &[VertexId]) -> f64 {
        self.between_within(sources, targets, f64::INFINITY)
    }

    /// The distance between two sets of vertices; infinite beyond `radius`.
    pub(super) fn between_within(&self, sources: &[VertexId], targets: &[VertexId], radius: f64) -> f64 {
        let found = self.within(sources, radius, |v| targets.contains(&v));
        found.last().filter(|(v, _)| targets.contains(v)).map_or(f64::INFINITY, |(_, distance)| *distance)
    }
}
