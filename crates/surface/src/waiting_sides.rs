//! The sides that wait for a test whether they are Delaunay.

use rayon::prelude::*;

use crate::ids::{CornerId, FaceId};

/// The bits of a word.
const WORD: usize = 64;

/// Triangles whose sides fill whole words.
const BLOCK: usize = 16 * WORD;

/// A stack of all sides of a triangulation, each by the lower of its two corners, in ascending order to begin with.
///
/// Sides that a test of all sides in parallel has cleared are passed over until a flip nearby makes them suspect
/// again. So the flips and their order are those of a stack that visits every side.
#[derive(Debug)]
pub(crate) struct WaitingSides {
    /// The sides to begin with, as bits.
    initial: Vec<u64>,
    /// The sides to test; it does not matter if there are others.
    suspects: Vec<u64>,
    /// The initial sides from here on have been visited.
    visited: usize,
    /// Sides that were pushed, and whether they are on the stack.
    pushed: Vec<CornerId>,
    is_pushed: Vec<u64>,
}

impl WaitingSides {
    /// The sides of triangles, given by the corners across them; `None` if none is to be flipped. Only sides opposite
    /// obtuse corners are tested.
    pub(crate) fn new(
        n_triangles: usize,
        opposite: impl Fn(CornerId) -> Option<CornerId> + Sync,
        is_obtuse: impl Fn(CornerId) -> bool + Sync,
        is_to_be_flipped: impl Fn(CornerId) -> bool + Sync,
    ) -> Option<Self> {
        let n_sides = 3 * n_triangles;
        let n_words = n_sides.div_ceil(WORD);
        let blocks: Vec<(Vec<u64>, Vec<CornerId>)> = (0..n_triangles.div_ceil(BLOCK))
            .into_par_iter()
            .map(|block| {
                let triangles = block * BLOCK..n_triangles.min((block + 1) * BLOCK);
                let mut initial = vec![0; (3 * triangles.len()).div_ceil(WORD)];
                // No branch depends on angles, which could not be predicted.
                let (mut obtuse, mut n_obtuse) = (vec![CornerId(0); 3 * triangles.len() + 1], 0);
                for corner in triangles.flat_map(|t| FaceId(t as u32).corners()) {
                    let Some(far) = opposite(corner) else { continue };
                    let bit = corner.index() - 3 * block * BLOCK;
                    initial[bit / WORD] |= u64::from(corner < far) << (bit % WORD);
                    obtuse[n_obtuse] = corner.min(far);
                    n_obtuse += usize::from(is_obtuse(corner));
                }
                obtuse.truncate(n_obtuse);
                obtuse.retain(|side| is_to_be_flipped(*side));
                (initial, obtuse)
            })
            .collect();
        let mut suspects = vec![0; n_words];
        blocks.iter().flat_map(|(_, crossed)| crossed).for_each(|side| set(&mut suspects, side.index()));
        suspects.iter().any(|word| *word != 0).then(|| Self {
            initial: blocks.iter().flat_map(|(initial, _)| initial).copied().collect(),
            suspects,
            visited: n_sides,
            pushed: Vec::new(),
            is_pushed: vec![0; n_words],
        })
    }

    /// Takes the side on top of the stack.
    pub(crate) fn pop(&mut self) -> Option<CornerId> {
        if let Some(side) = self.pushed.pop() {
            self.is_pushed[side.index() / WORD] &= !(1 << (side.index() % WORD));
            return Some(side);
        }
        let mut end = self.visited;
        while end > 0 {
            let word = (end - 1) / WORD;
            let below = u64::MAX >> (WORD - 1 - (end - 1) % WORD);
            let waiting = self.initial[word] & self.suspects[word] & below;
            if waiting != 0 {
                self.visited = word * WORD + waiting.ilog2() as usize;
                return Some(CornerId::from(self.visited));
            }
            end = word * WORD;
        }
        self.visited = 0;
        None
    }

    /// Puts a side onto the stack unless it is there.
    pub(crate) fn push(&mut self, side: CornerId) {
        let is_waiting = side.index() < self.visited && is_set(&self.initial, side.index());
        if !is_waiting && !is_set(&self.is_pushed, side.index()) {
            set(&mut self.is_pushed, side.index());
            self.pushed.push(side);
        }
    }

    /// Has a side tested when it is popped, if it is on the stack.
    pub(crate) fn suspect(&mut self, side: CornerId) {
        set(&mut self.suspects, side.index());
    }
}

#[inline]
fn set(words: &mut [u64], bit: usize) {
    words[bit / WORD] |= 1 << (bit % WORD);
}

#[inline]
fn is_set(words: &[u64], bit: usize) -> bool {
    words[bit / WORD] >> (bit % WORD) & 1 != 0
}
