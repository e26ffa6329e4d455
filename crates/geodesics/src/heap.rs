//! The front: a min-heap of tentative distances with decrease-key.

/// A vertex in no heap yet.
const FAR: u32 = u32::MAX;

/// Tentative distances of all vertices and a 4-ary heap over those in the front.
///
/// Four children share a cache line, which halves the depth of a binary heap for the same line
/// count; equal distances are ordered by vertex, so the order of removal never depends on the
/// order of insertion.
#[derive(Debug, Default)]
pub(crate) struct Front {
    /// Tentative distance and heap position of every vertex.
    nodes: Vec<Node>,
    heap: Vec<(f64, u32)>,
}

#[derive(Debug, Clone, Copy)]
struct Node {
    distance: f64,
    position: u32,
}

impl Front {
    /// Forgets everything: `n` vertices at infinity, none in the front. Allocates only to grow.
    pub(crate) fn reset(&mut self, n: usize) {
        self.nodes.clear();
        self.nodes.resize(n, Node { distance: f64::INFINITY, position: FAR });
        self.heap.clear();
    }

    /// The best distance known so far; infinite where the front has not been.
    #[inline]
    pub(crate) fn distance(&self, vertex: u32) -> f64 {
        self.nodes[vertex as usize].distance
    }

    /// Lowers the distance of `vertex` to `distance` if that is an improvement, putting it (back)
    /// into the front.
    #[inline]
    pub(crate) fn relax(&mut self, vertex: u32, distance: f64) {
        let node = &mut self.nodes[vertex as usize];
        if distance < node.distance {
            node.distance = distance;
            let mut position = node.position;
            if position == FAR {
                position = self.heap.len() as u32;
                self.heap.push((distance, vertex));
            }
            self.sift_up(position as usize, (distance, vertex));
        }
    }

    /// Removes the nearest vertex of the front.
    #[inline]
    pub(crate) fn pop(&mut self) -> Option<(f64, u32)> {
        let top = *self.heap.first()?;
        self.nodes[top.1 as usize].position = FAR;
        if let Some(last) = self.heap.pop()
            && !self.heap.is_empty()
        {
            self.sift_down(last);
        }
        Some(top)
    }

    #[inline]
    fn before(a: (f64, u32), b: (f64, u32)) -> bool {
        a.0 < b.0 || (a.0 == b.0 && a.1 < b.1)
    }

    #[inline]
    fn sift_up(&mut self, mut hole: usize, item: (f64, u32)) {
        while hole > 0 {
            let parent = (hole - 1) / 4;
            if !Self::before(item, self.heap[parent]) {
                break;
            }
            self.place(hole, self.heap[parent]);
            hole = parent;
        }
        self.place(hole, item);
    }

    #[inline]
    fn sift_down(&mut self, item: (f64, u32)) {
        let mut hole = 0;
        loop {
            let first = 4 * hole + 1;
            let Some(children) = self.heap.get(first..self.heap.len().min(first + 4)) else { break };
            let Some((offset, &child)) =
                children.iter().enumerate().reduce(|a, b| if Self::before(*b.1, *a.1) { b } else { a })
            else {
                break;
            };
            if !Self::before(child, item) {
                break;
            }
            self.place(hole, child);
            hole = first + offset;
        }
        self.place(hole, item);
    }

    #[inline]
    fn place(&mut self, hole: usize, item: (f64, u32)) {
        self.heap[hole] = item;
        self.nodes[item.1 as usize].position = hole as u32;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pops_in_order_of_distance_then_vertex_whatever_was_relaxed_when() {
        let n = 500u32;
        let mut front = Front::default();
        front.reset(n as usize);
        let key = |v: u32| f64::from((v * 7919) % 101);
        for v in 0..n {
            front.relax(v, key(v) + 50.0);
        }
        for v in (0..n).rev() {
            front.relax(v, key(v));
            front.relax(v, key(v) + 1.0);
        }
        let mut expected: Vec<(f64, u32)> = (0..n).map(|v| (key(v), v)).collect();
        expected.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let popped: Vec<_> = std::iter::from_fn(|| front.pop()).collect();
        assert_eq!(popped, expected);
    }

    #[test]
    fn a_popped_vertex_returns_when_it_improves() {
        let mut front = Front::default();
        front.reset(2);
        front.relax(0, 2.0);
        assert_eq!(front.pop(), Some((2.0, 0)));
        front.relax(0, 3.0);
        assert_eq!(front.pop(), None);
        front.relax(0, 1.0);
        assert_eq!(front.pop(), Some((1.0, 0)));
        assert_eq!(front.distance(1), f64::INFINITY);
    }
}
