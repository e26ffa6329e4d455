//! The durable index: one file of shapes, found again by name or by what they look like.
//!
//! ```text
//! Shape -> IndexWriter (NAME.work, redb) -> finish -> NAME -> Index -> Searcher | each | verify | export
//! ```
//!
//! A finished file is never changed: a writer works on a copy beside it, every `put` a transaction, and
//! renames it. So readers need no lock, and whoever is killed loses nothing that was put. Every block of
//! a finished file has a checksum that is looked at whenever the block is read.
//!
//! Vectors come from outside; nothing here knows what they were made of.

mod codec;
mod error;
mod export;
mod overlay;
mod reader;
mod sealed;
mod search;
mod shape;
mod tables;
mod verify;
mod writer;

#[cfg(test)]
mod tests;

pub use codec::CodecError;
pub use error::IndexError;
pub use export::ExportError;
pub use reader::Index;
pub use sealed::FORMAT_VERSION;
pub use search::{Found, NearShape, SearchMode, Searcher};
pub use shape::{ContentHash, Shape, ShapeEntry, ShapeVectors};
pub use verify::{Verification, verify};
pub use writer::{IndexWriter, Job, work_path};
