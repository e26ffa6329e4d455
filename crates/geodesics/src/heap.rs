//! The front of Dijkstra's method: a min-heap of tentative distances with decrease-key.

/// A vertex in no heap yet.
const FAR: u32 = u32::MAX;

/// Tentative distances of all vertices and a 4-ary heap over those in the front.
///
/// Four children share a cache line, which halves the depth of a binary heap for the same line
/// count, and the least of them is found without branches, which would be mispredicted.
#[derive(Debug, Default)]
pub(crate) struct Front {
    distances: Vec<f64>,
    /// Where a vertex stands in the heap.
    places: Vec<u32>,
    heap: Vec<(f64, u32)>,
}

impl Front {
    /// Forgets everything: `n` vertices at infinity, none in the front. Allocates only to grow.
    pub(crate) fn reset(&mut self, n: usize) {
        self.distances.clear();
        self.distances.resize(n, f64::INFINITY);
        self.places.clear();
        self.places.resize(n, FAR);
        self.heap.clear();
    }

    /// The best distance known so far; infinite where the front has not been.
    #[inline]
    pub(crate) fn distance(&self, vertex: u32) -> f64 {
        self.distances[vertex as usize]
    }

    /// Lowers the distance of `vertex` to `distance` if that is an improvement, putting it (back)
    /// into the front; whether it was.
    #[inline]
    pub(crate) fn relax(&mut self, vertex: u32, distance: f64) -> bool {
        let known = &mut self.distances[vertex as usize];
        let improves = distance < *known;
        if improves {
            *known = distance;
            let mut position = self.places[vertex as usize];
            if position == FAR {
                position = self.heap.len() as u32;
                self.heap.push((distance, vertex));
            }
            self.sift_up(position as usize, (distance, vertex));
        }
        improves
    }

    /// Removes the nearest vertex of the front.
    #[inline]
    pub(crate) fn pop(&mut self) -> Option<(f64, u32)> {
        let top = *self.heap.first()?;
        self.places[top.1 as usize] = FAR;
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

    /// Lets the hole sink to the bottom along the nearest children and the item rise from there: it came
    /// from the bottom and nearly always belongs there, so comparing it on the way down is no use.
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
        self.places[item.1 as usize] = hole as u32;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pops_in_order_of_distance_whatever_was_relaxed_when() {
        let n = 500u32;
        let mut front = Front::default();
        front.reset(n as usize);
        let key = |v: u32| f64::from((v * 7919) % 101);
        for v in 0..n {
            assert!(front.relax(v, key(v) + 50.0));
        }
        for v in (0..n).rev() {
            assert!(front.relax(v, key(v)));
            assert!(!front.relax(v, key(v) + 1.0));
        }
        let popped: Vec<_> = std::iter::from_fn(|| front.pop()).collect();
        assert!(popped.is_sorted_by_key(|(distance, _)| *distance));
        let mut vertices: Vec<u32> = popped.iter().map(|(_, v)| *v).collect();
        vertices.sort_unstable();
        assert!(vertices.into_iter().eq(0..n));
        assert!(popped.iter().all(|(distance, v)| *distance == key(*v)));
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
