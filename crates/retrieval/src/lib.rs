//! Skeleton.
#![allow(rustdoc::broken_intra_doc_links)]
mod evaluation;
pub use evaluation::Evaluation;
