//! The front: labels of vertices, their order, and the windows that wait at edges.

use std::collections::VecDeque;

use surface::CornerId;

use super::window::Window;
use crate::heap::VertexHeap;

/// No list of windows.
const NONE: u32 = u32::MAX;

/// How the shortest known path arrives at a vertex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Arrival {
    /// From a source or over a link: it may continue in any direction.
    Anywhere,
    /// Through the face of a corner at the vertex. The angle from the side to the start of the corner's base has this
    /// sine and cosine, times any factor.
    Through { corner: CornerId, sin: f64, cos: f64 },
}

/// Labels, the queue of vertices, and the windows to be propagated.
///
/// A window waits at the corner whose base it is about to cross, in no particular order. The corner waits for the end
/// of its base that was nearer when the first window came.
#[derive(Debug, Default)]
pub(super) struct Front {
    heap: VertexHeap,
    arrivals: Vec<Arrival>,
    /// The first list that waits for each vertex.
    waiting: Vec<u32>,
    /// The list of windows at the base of every corner.
    list_at: Vec<u32>,
    lists: Vec<List>,
    /// Lists at no corner.
    free: Vec<u32>,
    /// Lists whose vertex has left the heap.
    ready: VecDeque<u32>,
}

#[derive(Debug)]
struct List {
    windows: Vec<Window>,
    corner: CornerId,
    /// The next list that waits for the same vertex.
    next: u32,
}

impl Front {
    /// Prepares for a new run. Allocates only to grow.
    pub(super) fn reset(&mut self, n_vertices: usize, n_corners: usize) {
        self.heap.reset(n_vertices);
        self.arrivals.resize(n_vertices, Arrival::Anywhere);
        self.list_at.clear();
        self.list_at.resize(n_corners, NONE);
        self.waiting.clear();
        self.waiting.resize(n_vertices, NONE);
        self.ready.clear();
        self.free.clear();
        self.free.extend(0..self.lists.len() as u32);
        self.lists.iter_mut().for_each(|list| list.windows.clear());
    }

    #[inline]
    pub(super) fn distance(&self, vertex: u32) -> f64 {
        self.heap.distance(vertex)
    }

    #[inline]
    pub(super) fn arrival(&self, vertex: u32) -> Arrival {
        self.arrivals[vertex as usize]
    }

    /// Lowers the label of a vertex to `distance` and puts it (back) into the queue, if that is an improvement.
    #[inline]
    pub(super) fn reach(&mut self, vertex: u32, distance: f64, arrival: Arrival) {
        if self.heap.relax(vertex, distance) {
            self.arrivals[vertex as usize] = arrival;
        }
    }

    #[inline]
    pub(super) fn pop(&mut self) -> Option<(f64, u32)> {
        self.heap.pop()
    }

    /// Adds windows to those at the base of `corner`, which has the given ends.
    pub(super) fn deliver(
        &mut self,
        corner: CornerId,
        ends: [u32; 2],
        windows: impl Iterator<Item = Window>,
    ) {
        let list = match self.list_at[corner.index()] {
            NONE => self.open(corner, ends),
            list => list,
        };
        self.lists[list as usize].windows.extend(windows);
    }

    /// As [`deliver`](Self::deliver), but may exchange the memory of `windows` instead of copying it.
    #[inline]
    pub(super) fn deliver_all(&mut self, corner: CornerId, ends: [u32; 2], windows: &mut Vec<Window>) {
        match self.list_at[corner.index()] {
            NONE => {
                let list = self.open(corner, ends);
                std::mem::swap(&mut self.lists[list as usize].windows, windows);
            }
            list => {
                let before = &mut self.lists[list as usize].windows;
                // Both are in order, and one comes before the other except for overlaps.
                let start = |windows: &[Window]| windows.first().map(|window| window.start);
                if start(windows) < start(before) {
                    std::mem::swap(before, windows);
                }
                before.extend_from_slice(windows);
            }
        }
    }

    /// An empty list for the base of `corner`, which now waits for one of its ends.
    fn open(&mut self, corner: CornerId, [a, b]: [u32; 2]) -> u32 {
        let list = self.free.pop().unwrap_or_else(|| {
            self.lists.push(List { windows: Vec::new(), corner, next: NONE });
            (self.lists.len() - 1) as u32
        });
        let end = if self.distance(b) < self.distance(a) { b } else { a };
        let next = if self.heap.contains(end) {
            std::mem::replace(&mut self.waiting[end as usize], list)
        } else {
            self.ready.push_back(list);
            NONE
        };
        let opened = &mut self.lists[list as usize];
        opened.corner = corner;
        opened.next = next;
        self.list_at[corner.index()] = list;
        list
    }

    /// Makes the corners that wait for a vertex ready.
    pub(super) fn release(&mut self, vertex: u32) {
        let mut list = std::mem::replace(&mut self.waiting[vertex as usize], NONE);
        while list != NONE {
            self.ready.push_back(list);
            list = self.lists[list as usize].next;
        }
    }

    /// The next corner that is ready; its windows replace those in `windows`.
    pub(super) fn next_ready(&mut self, windows: &mut Vec<Window>) -> Option<CornerId> {
        let index = self.ready.pop_front()?;
        let list = &mut self.lists[index as usize];
        windows.clear();
        std::mem::swap(windows, &mut list.windows);
        self.list_at[list.corner.index()] = NONE;
        self.free.push(index);
        Some(list.corner)
    }
}
