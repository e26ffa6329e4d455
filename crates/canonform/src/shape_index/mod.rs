//! Collections of meshes as an index: building, changing, searching and scoring it.
//!
//! ```text
//! files -> content hash -> unchanged? -> describe -> Shape -> index::IndexWriter -> index::Index
//! mesh -> describe -> Query -> bounds (robust distances of all vectors) -> rerank (aligned forms) -> vote -> Answer
//!                           -> neighbor graph | disc areas | spectra of all shapes -> aligned forms of the results
//! Query -> an Answer of every shard -> merge_answers -> Answer
//! ```

pub(crate) mod agreement;
mod ask;
pub(crate) mod build;
pub(crate) mod change;
mod components;
pub(crate) mod distances;
pub(crate) mod duplicates;
pub(crate) mod evaluate;
mod explain;
pub(crate) mod export;
pub(crate) mod found;
pub(crate) mod merge;
pub(crate) mod moves;
pub(crate) mod options;
pub(crate) mod place;
pub(crate) mod predict;
pub(crate) mod query;
mod record;
pub(crate) mod rerank;
pub(crate) mod search;
pub(crate) mod source;
