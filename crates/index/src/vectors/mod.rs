//! All vectors of an index in memory: the nearest to a query. Knows no file.
//!
//! **Invariant.** Nothing depends on the number of threads, nor on the order or the history of insertions.

mod kernels;
mod table;
#[cfg(test)]
mod tests;

pub use table::VectorTable;
