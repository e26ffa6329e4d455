//! An indexed min-heap: vertices by tentative distance, with decrease-key.

/// Marks a vertex that is not in the heap.
const NONE: u32 = u32::MAX;

/// Tentative distances of all vertices, and a 4-ary min-heap of those to be visited.
///
/// Four children share a cache line, so the heap is half as deep as a binary one. The least of them is found without
/// branches, which would be mispredicted.
#[derive(Debug, Default)]
pub(crate) struct VertexHeap {
    distances: Vec<f64>,
    /// Position of every vertex in the heap.
    positions: Vec<u32>,
    heap: Vec<(f64, u32)>,
}

impl VertexHeap {
    /// Empties the heap and sets the distances of `n` vertices to infinity. Allocates only to grow.
    pub(crate) fn reset(&mut self, n: usize) {
        self.distances.clear();
        self.distances.resize(n, f64::INFINITY);
        self.positions.clear();
        self.positions.resize(n, NONE);
        self.heap.clear();
    }

    /// The tentative distance of a vertex; infinite until it is relaxed.
    #[inline]
    pub(crate) fn distance(&self, vertex: u32) -> f64 {
        self.distances[vertex as usize]
    }

    #[inline]
    pub(crate) fn contains(&self, vertex: u32) -> bool {
        self.positions[vertex as usize] != NONE
    }

    /// If `distance` is less than that of the vertex, lowers it and puts the vertex into the heap; returns whether it
    /// was.
    #[inline]
    pub(crate) fn relax(&mut self, vertex: u32, distance: f64) -> bool {
        let known = &mut self.distances[vertex as usize];
        let improves = distance < *known;
        if improves {
            *known = distance;
            let mut position = self.positions[vertex as usize];
            if position == NONE {
                position = self.heap.len() as u32;
                self.heap.push((distance, vertex));
            }
            self.sift_up(position as usize, (distance, vertex));
        }
        improves
    }

    #[inline]
    pub(crate) fn pop(&mut self) -> Option<(f64, u32)> {
        let top = *self.heap.first()?;
        self.positions[top.1 as usize] = NONE;
        if let Some(last) = self.heap.pop()
            && !self.heap.is_empty()
        {
            self.sift_down(last);
        }
        Some(top)
    }

    #[inline]
    fn sift_up(&mut self, mut hole: usize, item: (f64, u32)) {
        while hole > 0 {
            let parent = (hole - 1) / 4;
            if item.0 >= self.heap[parent].0 {
                break;
            }
            self.place(hole, self.heap[parent]);
            hole = parent;
        }
        self.place(hole, item);
    }

    /// Moves the hole at the top down to the bottom along the least children and lets the item rise from there: it
    /// came from the bottom and nearly always returns there, so comparing it at every level would be wasteful.
    #[inline]
    fn sift_down(&mut self, item: (f64, u32)) {
        let mut hole = 0;
        loop {
            let first = 4 * hole + 1;
            let child = match self.heap.get(first..) {
                Some([p, q, r, s, ..]) => {
                    let near = usize::from(q.0 < p.0);
                    let far = 2 | usize::from(s.0 < r.0);
                    let is_far = usize::from(r.0.min(s.0) < p.0.min(q.0));
                    near ^ ((near ^ far) & is_far.wrapping_neg())
                }
                Some(few) => match (0..few.len()).min_by(|i, j| few[*i].0.total_cmp(&few[*j].0)) {
                    Some(child) => child,
                    None => break,
                },
                None => break,
            };
            self.place(hole, self.heap[first + child]);
            hole = first + child;
        }
        self.sift_up(hole, item);
    }

    #[inline]
    fn place(&mut self, hole: usize, item: (f64, u32)) {
        self.heap[hole] = item;
        self.positions[item.1 as usize] = hole as u32;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertices_are_popped_in_order_of_distance() {
        let n = 500u32;
        let mut heap = VertexHeap::default();
        heap.reset(n as usize);
        let key = |v: u32| f64::from((v * 7919) % 101);
        for v in 0..n {
            assert!(heap.relax(v, key(v) + 50.0));
        }
        for v in (0..n).rev() {
            assert!(heap.relax(v, key(v)));
            assert!(!heap.relax(v, key(v) + 1.0));
        }
        let popped: Vec<_> = std::iter::from_fn(|| heap.pop()).collect();
        assert!(popped.is_sorted_by_key(|(distance, _)| *distance));
        let mut vertices: Vec<u32> = popped.iter().map(|(_, v)| *v).collect();
        vertices.sort_unstable();
        assert!(vertices.into_iter().eq(0..n));
        assert!(popped.iter().all(|(distance, v)| *distance == key(*v)));
    }

    #[test]
    fn a_popped_vertex_returns_when_its_distance_is_lowered() {
        let mut heap = VertexHeap::default();
        heap.reset(2);
        heap.relax(0, 2.0);
        assert!(heap.contains(0));
        assert_eq!(heap.pop(), Some((2.0, 0)));
        heap.relax(0, 3.0);
        assert_eq!(heap.pop(), None);
        heap.relax(0, 1.0);
        assert_eq!(heap.pop(), Some((1.0, 0)));
        assert_eq!(heap.distance(1), f64::INFINITY);
    }
}
