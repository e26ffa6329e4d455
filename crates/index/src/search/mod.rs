//! Nearest vectors, of a hundred or of millions.
//!
//! Up to [`EXACT_LIMIT`](plan::EXACT_LIMIT) vectors all of them are measured. More are cut into about
//! `2 √n` cells around centres (k-means; an inverted file), and a search looks into the cells nearest to
//! the query. How many is found by trial when the index is finished: searches for some of its vectors
//! must find 99.6 % of their ten nearest. Inside a cell everything is measured, in whole numbers: nothing
//! is quantised.
//!
//! **Invariant.** What is found depends on the vectors alone: not on threads, on the order in which
//! shapes came in, or on what the index held before.

mod kernels;
mod kmeans;
mod nearest;
mod plan;
mod searcher;
mod stored;
#[cfg(test)]
mod testing;
mod threshold;

pub use searcher::{Found, NearShape, SearchMode, Searcher};
pub(crate) use stored::{check, write};
