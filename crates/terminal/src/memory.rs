//! How much memory a piece of work takes.

use peak_alloc::PeakAlloc;

/// Counts what the program has on the heap.
#[global_allocator]
static ALLOCATOR: PeakAlloc = PeakAlloc;

/// Watches the memory of the whole program from where it begins; one at a time.
#[derive(Debug)]
pub struct PeakMemory {
    before: usize,
}

impl PeakMemory {
    /// Begins to watch.
    #[must_use]
    pub fn begin() -> Self {
        ALLOCATOR.reset_peak_usage();
        Self { before: ALLOCATOR.current_usage() }
    }

    /// The most bytes on the heap at once since then, beyond those there at the beginning.
    #[must_use]
    pub fn bytes(&self) -> usize {
        ALLOCATOR.peak_usage().saturating_sub(self.before)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_that_came_and_went_counts() {
        let memory = PeakMemory::begin();
        drop(std::hint::black_box(vec![1_u8; 50 << 20]));
        let bytes = memory.bytes();
        assert!((50 << 20..60 << 20).contains(&bytes), "{bytes}");
    }
}
