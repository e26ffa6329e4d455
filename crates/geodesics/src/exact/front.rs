//! The wave front: labels of vertices, their order, and the windows that wait at edges.

use std::collections::VecDeque;

use super::window::Window;

/// No corner, no position, no list.
const NONE: u32 = u32::MAX;

/// From where the shortest path known so far comes to a vertex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Arrival {
    /// A source or a link: it may go on in any direction.
    Anywhere,
    /// Through the face of a corner at the vertex, at an angle from the side to the start of the
    /// corner's base that has this sine and cosine, times any factor.
    Through { corner: u32, sin: f64, cos: f64 },
}

/// Labels, the queue of vertices, and the windows on their way.
///
/// A window waits at the corner whose base it is about to cross, in no particular order; the corner
/// waits for the end of its base that was nearer when the first window came.
#[derive(Debug, Default)]
pub(super) struct Front {
    nodes: Vec<Node>,
    arrivals: Vec<Arrival>,
    /// A 4-ary min-heap of vertices by distance.
    heap: Vec<(f64, u32)>,
    /// The queue of windows at the base of every corner.
    gates: Vec<u32>,
    queues: Vec<Queue>,
    /// Queues at no corner.
    free: Vec<u32>,
    /// Queues whose vertex has left the heap already.
    ready: VecDeque<u32>,
}

#[derive(Debug, Clone, Copy)]
struct Node {
    distance: f64,
    position: u32,
    /// The first queue that waits for this vertex.
    waiting: u32,
}

/// Windows that wait at the base of a corner.
#[derive(Debug)]
struct Queue {
    windows: Vec<Window>,
    corner: u32,
    /// The next queue that waits for the same vertex.
    next: u32,
}

impl Front {
    /// Forgets everything. Allocates only to grow.
    pub(super) fn reset(&mut self, n_vertices: usize, n_corners: usize) {
        self.nodes.clear();
        self.nodes.resize(n_vertices, Node { distance: f64::INFINITY, position: NONE, waiting: NONE });
        self.arrivals.resize(n_vertices, Arrival::Anywhere);
        self.gates.clear();
        self.gates.resize(n_corners, NONE);
        self.heap.clear();
        self.ready.clear();
        self.free.clear();
        self.free.extend(0..self.queues.len() as u32);
        self.queues.iter_mut().for_each(|queue| queue.windows.clear());
    }

    #[inline]
    pub(super) fn distance(&self, vertex: u32) -> f64 {
        self.nodes[vertex as usize].distance
    }

    #[inline]
    pub(super) fn arrival(&self, vertex: u32) -> Arrival {
        self.arrivals[vertex as usize]
    }

    /// Lowers the label of a vertex to `distance` if that is an improvement, and (re-)queues it.
    #[inline]
    pub(super) fn reach(&mut self, vertex: u32, distance: f64, arrival: Arrival) {
        let node = &mut self.nodes[vertex as usize];
        if distance < node.distance {
            node.distance = distance;
            self.arrivals[vertex as usize] = arrival;
            let mut position = node.position as usize;
            if node.position == NONE {
                position = self.heap.len();
                self.heap.push((distance, vertex));
            }
            self.sift_up(position, (distance, vertex));
        }
    }

    /// The nearest vertex of the queue, which it leaves.
    #[inline]
    pub(super) fn pop(&mut self) -> Option<(f64, u32)> {
        let top = *self.heap.first()?;
        self.nodes[top.1 as usize].position = NONE;
        if let Some(last) = self.heap.pop()
            && !self.heap.is_empty()
        {
            self.sift_down(last);
        }
        Some(top)
    }

    /// Adds windows to those at the base of `corner`, whose ends these are.
    pub(super) fn deliver(&mut self, corner: u32, ends: [u32; 2], windows: impl Iterator<Item = Window>) {
        let queue = match self.gates[corner as usize] {
            NONE => self.open(corner, ends),
            queue => queue,
        };
        self.queues[queue as usize].windows.extend(windows);
    }

    /// The same, leaving `windows` with other memory if that saves copying.
    #[inline]
    pub(super) fn deliver_all(&mut self, corner: u32, ends: [u32; 2], windows: &mut Vec<Window>) {
        match self.gates[corner as usize] {
            NONE => {
                let queue = self.open(corner, ends);
                std::mem::swap(&mut self.queues[queue as usize].windows, windows);
            }
            queue => {
                let before = &mut self.queues[queue as usize].windows;
                // Both are in order, and one before the other but for overlaps.
                let start = |windows: &[Window]| windows.first().map(|window| window.start);
                if start(windows) < start(before) {
                    std::mem::swap(before, windows);
                }
                before.extend_from_slice(windows);
            }
        }
    }

    /// An empty queue for the base of `corner`, which now waits for one of its ends.
    fn open(&mut self, corner: u32, [a, b]: [u32; 2]) -> u32 {
        let queue = self.free.pop().unwrap_or_else(|| {
            self.queues.push(Queue { windows: Vec::new(), corner, next: NONE });
            (self.queues.len() - 1) as u32
        });
        let end = if self.distance(b) < self.distance(a) { b } else { a };
        let node = &mut self.nodes[end as usize];
        let next = if node.position == NONE {
            self.ready.push_back(queue);
            NONE
        } else {
            std::mem::replace(&mut node.waiting, queue)
        };
        let opened = &mut self.queues[queue as usize];
        opened.corner = corner;
        opened.next = next;
        self.gates[corner as usize] = queue;
        queue
    }

    /// Lets the corners go that wait for a vertex.
    pub(super) fn release(&mut self, vertex: u32) {
        let mut queue = std::mem::replace(&mut self.nodes[vertex as usize].waiting, NONE);
        while queue != NONE {
            self.ready.push_back(queue);
            queue = self.queues[queue as usize].next;
        }
    }

    /// The next corner that waits for nothing; its windows replace those in `windows`.
    pub(super) fn next_ready(&mut self, windows: &mut Vec<Window>) -> Option<u32> {
        let index = self.ready.pop_front()?;
        let queue = &mut self.queues[index as usize];
        windows.clear();
        std::mem::swap(windows, &mut queue.windows);
        self.gates[queue.corner as usize] = NONE;
        self.free.push(index);
        Some(queue.corner)
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

    #[inline]
    fn sift_down(&mut self, item: (f64, u32)) {
        let nearer = |p: (usize, f64), q: (usize, f64)| if q.1 < p.1 { q } else { p };
        let mut hole = 0;
        loop {
            let first = 4 * hole + 1;
            let (child, nearest) = match self.heap.get(first..) {
                // All four without a branch, which would be mispredicted.
                Some([p, q, r, s, ..]) => nearer(nearer((0, p.0), (1, q.0)), nearer((2, r.0), (3, s.0))),
                Some(few) => {
                    let distances = few.iter().map(|child| child.0).enumerate();
                    distances.reduce(nearer).unwrap_or((0, f64::INFINITY))
                }
                None => break,
            };
            if nearest >= item.0 {
                break;
            }
            self.place(hole, self.heap[first + child]);
            hole = first + child;
        }
        self.place(hole, item);
    }

    #[inline]
    fn place(&mut self, hole: usize, item: (f64, u32)) {
        self.heap[hole] = item;
        self.nodes[item.1 as usize].position = hole as u32;
    }
}
