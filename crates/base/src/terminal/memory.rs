//! Peak memory, and the limit that the system sets.

use std::alloc::System;

use peakmem_alloc::{INSTRUMENTED_SYSTEM, PeakMemAlloc, PeakMemAllocTrait};

/// Counts the heap of the program. Memory grows in place and comes zeroed where the system can do that.
#[global_allocator]
static ALLOCATOR: &PeakMemAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Runs `work` and returns its result with the most bytes on the heap at once while it ran, beyond those before.
///
/// Counts the whole program, so measure one thing at a time.
pub fn with_peak_bytes<T>(work: impl FnOnce() -> T) -> (T, usize) {
    ALLOCATOR.reset_peak_memory();
    let result = work();
    (result, ALLOCATOR.get_peak_memory())
}

/// The memory that the program may reserve, in bytes, if the user has limited it with `ulimit -v`; known on Linux only.
pub fn memory_limit() -> Option<usize> {
    parse_limit(&std::fs::read_to_string("/proc/self/limits").ok()?)
}

fn parse_limit(limits: &str) -> Option<usize> {
    let line = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    line.split_whitespace().next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_read_as_the_system_prints_them() {
        let text = |limit: &str| {
            format!(
                "Limit                     Soft Limit           Hard Limit           Units\nMax address space         {limit}           unlimited            bytes\n"
            )
        };
        assert_eq!(parse_limit(&text("4096000")), Some(4_096_000));
        assert_eq!(parse_limit(&text("unlimited")), None);
        assert_eq!(parse_limit(""), None);
    }

    #[test]
    fn freed_memory_counts() {
        let run = || with_peak_bytes(|| drop(std::hint::black_box(vec![1_u8; 50 << 20]))).1;
        // Tests beside this one allocate, too.
        let bytes = (0..20).map(|_| run()).min().unwrap();
        assert!((50 << 20..60 << 20).contains(&bytes), "{bytes}");
    }
}
