//! Limits on time and memory, and cancellation, of long computations.
//!
//! A program gives a computation a [`Budget`] and keeps a clone. The computation asks [`Budget::check`] every so often and
//! ends with [`Exceeded`] when its time is over or another thread has cancelled it. Before it allocates memory that
//! depends on the input it asks [`Budget::check_memory`].
//!
//! ```
//! use canonform_base::{Budget, Exceeded};
//!
//! fn sum(numbers: &[u64], budget: &Budget) -> Result<u64, Exceeded> {
//!     let mut sum = 0;
//!     for block in numbers.chunks(1024) {
//!         budget.check()?;
//!         sum += block.iter().sum::<u64>();
//!     }
//!     Ok(sum)
//! }
//! let budget = Budget::unlimited();
//! assert_eq!(sum(&[1, 2, 3], &budget)?, 6);
//! // Another thread that holds a clone stops the computation.
//! budget.clone().cancel();
//! assert_eq!(sum(&[1, 2, 3], &budget), Err(Exceeded::Cancelled));
//! # Ok::<(), Exceeded>(())
//! ```

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// What a computation may use. Clones share the cancellation.
#[derive(Debug, Clone, Default)]
pub struct Budget {
    cancelled: Arc<AtomicBool>,
    time: Option<(Duration, Instant)>,
    memory: Option<usize>,
    spill: Option<Arc<Path>>,
}

/// Why a computation ended early.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Exceeded {
    /// Another thread cancelled it.
    #[error("cancelled")]
    Cancelled,
    /// Its time is over.
    #[error("not finished within the time limit of {} seconds", limit.as_secs_f64())]
    Time {
        /// The limit.
        limit: Duration,
    },
    /// It took more steps than any ordinary input needs.
    #[error("not finished within {limit} steps; the surface has needles or slivers: remesh it")]
    Steps {
        /// The limit.
        limit: usize,
    },
    /// It needs more memory than allowed.
    #[error("{needed} bytes of memory are needed and {limit} are allowed")]
    Memory {
        /// Bytes needed so far.
        needed: usize,
        /// Bytes allowed.
        limit: usize,
    },
    /// The system does not give it the memory that it needs.
    #[error("{needed} bytes of memory are needed, and the system has no more")]
    Allocation {
        /// Bytes requested.
        needed: usize,
    },
}

impl Budget {
    /// No limits; only [`cancel`](Self::cancel) ends a computation.
    pub fn unlimited() -> Self {
        Self::default()
    }

    /// The same budget, ending `limit` from now.
    #[must_use]
    pub fn with_time(self, limit: Duration) -> Self {
        // A limit beyond what the clock can express is none.
        Self { time: Instant::now().checked_add(limit).map(|end| (limit, end)), ..self }
    }

    /// The same budget with a limit on memory, in bytes.
    #[must_use]
    pub fn with_memory(self, bytes: usize) -> Self {
        Self { memory: Some(bytes), ..self }
    }

    /// The limit on memory in bytes, if there is one.
    pub fn memory(&self) -> Option<usize> {
        self.memory
    }

    /// The same budget with a folder for temporary files, which hold what does not fit into memory.
    #[must_use]
    pub fn with_spill(self, folder: PathBuf) -> Self {
        Self { spill: Some(folder.into()), ..self }
    }

    /// The folder for temporary files; without one, everything has to fit into memory.
    pub fn spill(&self) -> Option<&Path> {
        self.spill.as_deref()
    }

    /// Ends every computation that uses this budget or a clone of it, at its next check.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// Whether the computation may go on. Reads the clock: call it every millisecond or so, not in innermost loops.
    ///
    /// # Errors
    /// [`Exceeded::Cancelled`] and [`Exceeded::Time`].
    pub fn check(&self) -> Result<(), Exceeded> {
        if self.cancelled.load(Ordering::Relaxed) {
            return Err(Exceeded::Cancelled);
        }
        match self.time {
            Some((limit, end)) if Instant::now() >= end => Err(Exceeded::Time { limit }),
            _ => Ok(()),
        }
    }

    /// Whether a computation may hold `needed` bytes at once.
    ///
    /// # Errors
    /// [`Exceeded::Memory`].
    pub fn check_memory(&self, needed: usize) -> Result<(), Exceeded> {
        match self.memory {
            Some(limit) if needed > limit => Err(Exceeded::Memory { needed, limit }),
            _ => Ok(()),
        }
    }

    /// A vector of `n` default values, such as zeros, if it may hold that many and the system has the memory.
    ///
    /// # Errors
    /// [`Exceeded::Memory`] and [`Exceeded::Allocation`].
    pub fn vector<T: Clone + Default>(&self, n: usize) -> Result<Vec<T>, Exceeded> {
        let mut vector = Vec::new();
        self.extend(&mut vector, n)?;
        Ok(vector)
    }

    /// Appends `n` default values to a vector, if it may hold that many and the system has the memory. The system clears a gigabyte
    /// in about a second, so the budget is checked in between.
    ///
    /// # Errors
    /// As [`vector`](Self::vector) and [`check`](Self::check); then the vector is as before.
    pub fn extend<T: Clone + Default>(&self, vector: &mut Vec<T>, n: usize) -> Result<(), Exceeded> {
        let before = vector.len();
        let length = before.saturating_add(n);
        let needed = length.saturating_mul(size_of::<T>());
        self.check_memory(needed)?;
        vector.try_reserve_exact(n).map_err(|_| Exceeded::Allocation { needed })?;
        while vector.len() < length {
            self.check().inspect_err(|_| vector.truncate(before))?;
            vector.resize(length.min(vector.len() + BLOCK), T::default());
        }
        Ok(())
    }

    /// Checks this budget once in a while.
    pub fn meter(&self) -> Meter<'_> {
        Meter { budget: self, left: INTERVAL }
    }
}

/// Values that are appended between two checks.
const BLOCK: usize = 1 << 20;

/// Operations between two checks by a [`Meter`]: a millisecond or less if each takes a few nanoseconds.
const INTERVAL: usize = 1 << 16;

/// Counts the operations of a loop and checks a budget once in 65,536 of them.
///
/// ```
/// use canonform_base::{Budget, Exceeded};
///
/// let budget = Budget::unlimited();
/// let mut meter = budget.meter();
/// for row in [[1, 2], [3, 4]] {
///     meter.count(row.len())?;
/// }
/// # Ok::<(), Exceeded>(())
/// ```
#[derive(Debug)]
pub struct Meter<'a> {
    budget: &'a Budget,
    left: usize,
}

impl Meter<'_> {
    /// Counts operations; checks the budget if it is time.
    ///
    /// # Errors
    /// As [`Budget::check`].
    #[inline]
    pub fn count(&mut self, operations: usize) -> Result<(), Exceeded> {
        match self.left.checked_sub(operations) {
            Some(left) => {
                self.left = left;
                Ok(())
            }
            None => self.renew(),
        }
    }

    #[cold]
    fn renew(&mut self) -> Result<(), Exceeded> {
        self.left = INTERVAL;
        self.budget.check()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clones_are_cancelled_together_and_keep_their_own_limits() {
        let whole = Budget::unlimited().with_memory(100);
        let part = whole.clone().with_time(Duration::from_secs(3600));
        assert_eq!((whole.check(), part.check()), (Ok(()), Ok(())));
        assert_eq!(part.memory(), Some(100));
        part.cancel();
        assert_eq!((whole.check(), part.check()), (Err(Exceeded::Cancelled), Err(Exceeded::Cancelled)));
    }

    #[test]
    fn time_and_memory_are_limited() {
        let limit = Duration::ZERO;
        assert_eq!(Budget::unlimited().with_time(limit).check(), Err(Exceeded::Time { limit }));
        assert_eq!(Budget::unlimited().with_time(Duration::MAX).check(), Ok(()));
        let small = Budget::unlimited().with_memory(10);
        assert_eq!(small.check_memory(10), Ok(()));
        assert_eq!(small.check_memory(11), Err(Exceeded::Memory { needed: 11, limit: 10 }));
        assert_eq!(Budget::unlimited().check_memory(usize::MAX), Ok(()));
    }

    #[test]
    fn a_vector_is_refused_by_the_limit_and_by_the_system() {
        assert_eq!(Budget::unlimited().vector::<u8>(3), Ok(vec![0; 3]));
        let (mut vector, cancelled) = (vec![7], Budget::unlimited());
        cancelled.extend(&mut vector, 2).unwrap();
        cancelled.cancel();
        assert_eq!((cancelled.extend(&mut vector, 1), vector), (Err(Exceeded::Cancelled), vec![7, 0, 0]));
        let small = Budget::unlimited().with_memory(10);
        assert_eq!(small.vector::<f64>(2), Err(Exceeded::Memory { needed: 16, limit: 10 }));
        let needed = usize::MAX;
        assert_eq!(Budget::unlimited().vector::<f64>(needed), Err(Exceeded::Allocation { needed }));
    }

    #[test]
    fn a_meter_sees_a_cancellation_within_its_interval() {
        let budget = Budget::unlimited();
        let mut meter = budget.meter();
        budget.cancel();
        let seen = (0..=INTERVAL).find(|_| meter.count(1).is_err());
        assert_eq!(seen, Some(INTERVAL));
        assert_eq!(budget.meter().count(usize::MAX), Err(Exceeded::Cancelled));
    }
}
