//! Nearest vectors in memory, among a hundred or millions.
//!
//! Up to [`EXACT_LIMIT`](cells::EXACT_LIMIT) vectors a search measures all of them. Larger sets are divided into
//! about `2 √n` cells by k-means (an inverted file). A search scans some of the cells whose centres are nearest to the
//! query: those whose border is near, compared with the neighbours found so far. How many and how near is calibrated
//! whenever the index is finished, so that searches for some of its own vectors find 99.4 % of the ten nearest. Vectors
//! are not quantised.
//!
//! The [graph] lists the nearest neighbours of every vector, found by such searches.
//!
//! New vectors join the nearest cells; centres are chosen again when the set has grown by half.
//!
//! **Invariant.** Nothing depends on the number of threads. Exact searches and the threshold of unknown classes depend on
//! the vectors only, not on the order or the history of insertions.

pub(crate) mod cells;
mod graph;
pub(crate) mod kernels;
mod kmeans;
mod nearest;
mod part;
#[cfg(test)]
mod testing;
mod trials;

pub(crate) use cells::{CellsHeader, Reach, divided, n_cells, nearest_cells, scan, search_cells};
pub(crate) use graph::{Divided, Link, Links};
pub(crate) use kernels::{padded, sq_distances_into};
pub(crate) use kmeans::Centroids;
pub(crate) use nearest::{Hit, Nearest};
pub(crate) use part::Part;
pub(crate) use trials::{NEIGHBORS, Trial, Trials, Visit};
