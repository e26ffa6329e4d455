//! Collections of meshes as an index: the order of the stages of making, changing and asking it.
//!
//! ```text
//! files -> content hash -> unchanged? -> describe -> retrieval::IndexWriter -> retrieval::Index
//! ```

mod build;
mod change;
mod record;
mod source;

pub use build::{BuildOptions, BuildReport, Failure, build_index};
pub use change::{MergeReport, add_to_index, merge_indexes, remove_from_index};
pub use source::{Inputs, Shard};
