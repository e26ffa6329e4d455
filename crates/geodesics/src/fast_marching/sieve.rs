//! Keeping some of many items.

/// A list that items are added to under a condition, without a branch: which of many candidates are worth
/// keeping is nothing that a processor could foresee.
#[derive(Debug)]
pub(super) struct Sieve<'a, T> {
    /// What was kept, and room for more.
    room: &'a mut [T],
    n: usize,
}

impl<'a, T: Copy> Sieve<'a, T> {
    /// An empty list for up to `most` items and one more. Allocates only to grow.
    pub(super) fn new(room: &'a mut Vec<T>, most: usize, blank: T) -> Self {
        if room.len() <= most {
            room.resize((most + 1).next_power_of_two(), blank);
        }
        Self { room, n: 0 }
    }

    /// Adds an item if it is `kept`.
    #[inline]
    pub(super) fn add(&mut self, item: T, kept: bool) {
        self.room[self.n] = item;
        self.n += usize::from(kept);
    }

    /// What was kept.
    pub(super) fn kept(self) -> &'a [T] {
        &self.room[..self.n]
    }
}
