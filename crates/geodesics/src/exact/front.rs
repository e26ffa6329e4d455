//! The front: labels of vertices, their order, and the windows that wait at edges.

use std::collections::VecDeque;

use base::{Budget, Exceeded};

use surface::{CornerId, Frontier, VertexId};

use super::bearing::Bearing;
use super::prepared::Arrival;
use super::window::PathWindow;

/// No list of windows.
const NONE: u32 = u32::MAX;

/// Labels, the queue of vertices, and the windows to be propagated.
///
/// A window waits at the corner whose base it is about to cross, in no particular order. The corner waits for the end
/// of its base that was nearer when the first window came.
#[derive(Debug, Default)]
pub(super) struct WindowFront<D = ()> {
    labels: Frontier,
    /// How the shortest known path to each vertex arrives, and how it left the source.
    arrivals: Vec<(Arrival, D)>,
    /// The first list that waits for each vertex.
    waiting: Vec<u32>,
    /// The list of windows at the base of every corner.
    list_at: Vec<u32>,
    lists: Vec<WaitingList<D>>,
    /// Lists at no corner.
    free: Vec<u32>,
    /// Lists whose vertex has been visited.
    ready: VecDeque<u32>,
    /// Room in all lists, in windows, and how much there may be.
    held: usize,
    limit: usize,
    /// What was needed when that exceeded the limit, or when the system had no more.
    missing: Option<usize>,
    /// Windows delivered, and lists opened, since the last call of [`take_work`](Self::take_work).
    work: usize,
}

/// Bytes for the windows of one run if the budget has no limit: the front of a real surface of a million vertices has
/// a hundredth.
const MAX_BYTES: usize = 1 << 30;

#[derive(Debug)]
struct WaitingList<D> {
    windows: Vec<PathWindow<D>>,
    corner: CornerId,
    /// The next list that waits for the same vertex.
    next: u32,
}

impl<D: Bearing> WindowFront<D> {
    /// Prepares for a new run. Allocates only to grow.
    ///
    /// Runs on all threads share the memory of the budget.
    pub(super) fn reset(&mut self, n_vertices: usize, n_corners: usize, budget: &Budget) {
        let bytes = budget.memory().map_or(MAX_BYTES, |bytes| bytes / rayon::current_num_threads());
        (self.limit, self.missing) = (bytes / size_of::<PathWindow<D>>(), None);
        // Room that earlier runs left must not hinder this one.
        if self.held > self.limit / 2 {
            (self.lists, self.held) = (Vec::new(), 0);
        }
        self.work = 0;
        self.labels.reset(n_vertices);
        self.arrivals.resize(n_vertices, (Arrival::Anywhere, D::default()));
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
        self.labels.distance(VertexId(vertex))
    }

    #[inline]
    pub(super) fn arrival(&self, vertex: u32) -> (Arrival, D) {
        self.arrivals[vertex as usize]
    }

    /// Lowers the label of a vertex to `distance` and puts it (back) into the queue, if that is an improvement.
    #[inline]
    pub(super) fn reach(&mut self, vertex: u32, distance: f64, arrival: Arrival, bearing: D) {
        if self.labels.relax(VertexId(vertex), distance) {
            self.arrivals[vertex as usize] = (arrival, bearing);
        }
    }

    #[inline]
    pub(super) fn pop(&mut self) -> Option<(f64, u32)> {
        self.labels.pop().map(|(distance, vertex)| (distance, vertex.0))
    }

    /// Adds windows to those at the base of `corner`, which has the given ends.
    pub(super) fn deliver(
        &mut self,
        corner: CornerId,
        ends: [u32; 2],
        windows: impl ExactSizeIterator<Item = PathWindow<D>>,
    ) {
        let list = match self.list_at[corner.index()] {
            NONE => self.open(corner, ends),
            list => list,
        };
        self.work += windows.len();
        self.append(list, windows);
    }

    /// Adds windows to a list, unless there is no memory for them.
    #[inline]
    fn append(&mut self, list: u32, windows: impl ExactSizeIterator<Item = PathWindow<D>>) {
        let room = &mut self.lists[list as usize].windows;
        let (count, before) = (windows.len(), room.capacity());
        if count > before - room.len() {
            let needed = self.held.saturating_add(count);
            if needed > self.limit || room.try_reserve(count).is_err() {
                self.missing = Some(needed);
                return;
            }
        }
        room.extend(windows);
        self.held += room.capacity() - before;
    }

    /// The operations since the last call.
    #[inline]
    pub(super) fn take_work(&mut self) -> usize {
        std::mem::take(&mut self.work)
    }

    /// Whether all windows found room.
    ///
    /// # Errors
    /// [`Exceeded::Memory`] or [`Exceeded::Allocation`].
    #[inline]
    pub(super) fn check_memory(&self) -> Result<(), Exceeded> {
        let bytes = |windows: usize| windows.saturating_mul(size_of::<PathWindow<D>>());
        match self.missing {
            None => Ok(()),
            Some(needed) if needed <= self.limit => Err(Exceeded::Allocation { needed: bytes(needed) }),
            Some(needed) => Err(Exceeded::Memory { needed: bytes(needed), limit: bytes(self.limit) }),
        }
    }

    /// An empty list for the base of `corner`, which now waits for one of its ends.
    fn open(&mut self, corner: CornerId, [a, b]: [u32; 2]) -> u32 {
        let list = self.free.pop().unwrap_or_else(|| {
            self.lists.push(WaitingList { windows: Vec::new(), corner, next: NONE });
            (self.lists.len() - 1) as u32
        });
        self.work += 1;
        let end = if self.distance(b) < self.distance(a) { b } else { a };
        let next = if self.labels.is_waiting(VertexId(end)) {
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
    pub(super) fn next_ready(&mut self, windows: &mut Vec<PathWindow<D>>) -> Option<CornerId> {
        let index = self.ready.pop_front()?;
        let list = &mut self.lists[index as usize];
        windows.clear();
        self.held = self.held + windows.capacity() - list.windows.capacity();
        std::mem::swap(windows, &mut list.windows);
        self.list_at[list.corner.index()] = NONE;
        self.free.push(index);
        Some(list.corner)
    }
}
