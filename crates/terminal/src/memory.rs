//! Peak memory, as the counting allocator of a program knows it.

use peak_alloc::PeakAlloc;

/// Runs `work` and returns its result with the most bytes on the heap at once while it ran, beyond those before.
///
/// Counts the whole program, so measure one thing at a time; 0 unless [`PeakAlloc`] is its global allocator.
pub fn with_peak_bytes<T>(work: impl FnOnce() -> T) -> (T, usize) {
    PeakAlloc.reset_peak_usage();
    let before = PeakAlloc.current_usage();
    let result = work();
    (result, PeakAlloc.peak_usage().saturating_sub(before))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[global_allocator]
    static ALLOCATOR: PeakAlloc = PeakAlloc;

    #[test]
    fn freed_memory_counts() {
        let ((), bytes) = with_peak_bytes(|| drop(std::hint::black_box(vec![1_u8; 50 << 20])));
        assert!((50 << 20..60 << 20).contains(&bytes), "{bytes}");
    }
}
