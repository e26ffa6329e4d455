//! The wave front: labels of vertices, their order, and the windows that wait at edges.

use std::collections::VecDeque;

use super::window::Window;
use crate::heap::VertexHeap;

/// No corner, no list.
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
    heap: VertexHeap,
    arrivals: Vec<Arrival>,
    /// The first queue that waits for each vertex.
    waiting: Vec<u32>,
    /// The queue of windows at the base of every corner.
    gates: Vec<u32>,
    queues: Vec<Queue>,
    /// Queues at no corner.
    free: Vec<u32>,
    /// Queues whose vertex has left the heap already.
    ready: VecDeque<u32>,
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
        self.heap.reset(n_vertices);
        self.arrivals.resize(n_vertices, Arrival::Anywhere);
        self.gates.clear();
        self.gates.resize(n_corners, NONE);
        self.waiting.clear();
        self.waiting.resize(n_vertices, NONE);
        self.ready.clear();
        self.free.clear();
        self.free.extend(0..self.queues.len() as u32);
        self.queues.iter_mut().for_each(|queue| queue.windows.clear());
    }

    #[inline]
    pub(super) fn distance(&self, vertex: u32) -> f64 {
        self.heap.distance(vertex)
    }

    #[inline]
    pub(super) fn arrival(&self, vertex: u32) -> Arrival {
        self.arrivals[vertex as usize]
    }

    /// Lowers the label of a vertex to `distance` if that is an improvement, and (re-)queues it.
    #[inline]
    pub(super) fn reach(&mut self, vertex: u32, distance: f64, arrival: Arrival) {
        if self.heap.relax(vertex, distance) {
            self.arrivals[vertex as usize] = arrival;
        }
    }

    /// The nearest vertex of the queue, which it leaves.
    #[inline]
    pub(super) fn pop(&mut self) -> Option<(f64, u32)> {
        self.heap.pop()
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
        let next = if self.heap.contains(end) {
            std::mem::replace(&mut self.waiting[end as usize], queue)
        } else {
            self.ready.push_back(queue);
            NONE
        };
        let opened = &mut self.queues[queue as usize];
        opened.corner = corner;
        opened.next = next;
        self.gates[corner as usize] = queue;
        queue
    }

    /// Lets the corners go that wait for a vertex.
    pub(super) fn release(&mut self, vertex: u32) {
        let mut queue = std::mem::replace(&mut self.waiting[vertex as usize], NONE);
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
}
