//! Requesting memory before it is needed.
//!
//! A front reads each triangle once, in an order that the processor cannot predict: a quarter of the time was spent
//! waiting. No safe function of the standard library requests memory without reading it, hence the
//! `unsafe`. The instruction affects only time; other processors do without.

#![allow(unsafe_code)]

/// Size of a cache line on the processors that have the instruction, in bytes.
#[cfg(target_arch = "x86_64")]
const LINE: usize = 64;

/// Requests an item that is at most one cache line long, and aligned.
#[inline(always)]
pub(crate) fn prefetch<T>(item: &T) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};

        const { assert!(size_of::<T>() <= align_of::<T>() && align_of::<T>() <= LINE) };
        // SAFETY: SSE is part of the architecture; a prefetch of any address, valid or not, is defined to have no
        // effect that a program could observe.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(std::ptr::from_ref(item).cast::<i8>()) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = item;
}
