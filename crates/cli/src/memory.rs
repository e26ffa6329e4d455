//! Peak memory, measured by an allocator that counts what the program has on the heap.

use peak_alloc::PeakAlloc;

#[global_allocator]
static ALLOCATOR: PeakAlloc = PeakAlloc;

/// Runs `work` and returns its result with the most bytes on the heap at once while it ran, beyond those before.
///
/// The count is that of the whole program, so measure one thing at a time.
pub(crate) fn with_peak_bytes<T>(work: impl FnOnce() -> T) -> (T, usize) {
    ALLOCATOR.reset_peak_usage();
    let before = ALLOCATOR.current_usage();
    let result = work();
    (result, ALLOCATOR.peak_usage().saturating_sub(before))
}
