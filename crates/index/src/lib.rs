//! A durable index: shapes in one file, found by name or by nearest vectors.
//!
//! ```text
//! Shape -> IndexWriter -> NAME.work -> finish -> NAME -> Index -> Searcher | each | verify | export
//! ```
//!
//! A finished file is never modified. A writer works on a copy next to it, `NAME.work`, commits every `put` in a
//! transaction, and renames the copy when it is done. So readers need no lock, and an interrupted writer loses
//! nothing that it has put. Each block of a finished file has a checksum that is compared whenever the block is read.
//!
//! Vectors come from outside; the index does not know what they describe.
//!
//! ```
//! use canonform_index::{ContentHash, Index, IndexWriter, Job, SearchMode, Searcher};
//! use canonform_index::{Shape, ShapeEntry, ShapeVectors};
//!
//! # let folder = tempfile::tempdir().unwrap();
//! let path = folder.path().join("animals.canonform");
//! let shape = |id: &str, label: &str, vector: [f32; 2]| Shape {
//!     id: id.to_owned(),
//!     entry: ShapeEntry {
//!         label: label.to_owned(),
//!         path: format!("{id}.off"),
//!         content: ContentHash::of(&[id]),
//!         facts: vec![],
//!     },
//!     vectors: ShapeVectors { fused: vector.to_vec(), ..ShapeVectors::default() },
//! };
//! let mut writer = IndexWriter::open(&path, Job::Build, Some("how the vectors were made"))?;
//! writer.put(&[shape("cat0", "cat", [0.0, 0.1]), shape("dog0", "dog", [5.0, 0.2])])?;
//! writer.finish()?;
//!
//! let index = Index::open(&path)?;
//! assert_eq!((index.len(), index.entry("cat0")?.path.as_str()), (2, "cat0.off"));
//! let found = index.nearest(&[4.0, 0.0], 1, SearchMode::Auto)?; // in the file
//! assert_eq!(found.shapes[0].id, "dog0");
//! assert_eq!(found, Searcher::load(&index)?.nearest(&[4.0, 0.0], 1, SearchMode::Auto)?); // in memory
//! # Ok::<(), canonform_index::IndexError>(())
//! ```
//!
//! Modules, each of which uses only those above it:
//!
//! | module | contents |
//! |---|---|
//! | `vectors` | nearest vectors in memory: kernels, k-means, cells, the threshold of unknown classes. Knows no file |
//! | `shape` | the record of one shape |
//! | `format` | the file: errors, encoding, checksummed blocks, tables, stored cells |
//! | `reader`, `writer` | [`Index`], [`IndexWriter`] |
//! | `search` | [`Index::nearest`], [`Searcher`] |
//! | `verify`, `export` | [`verify`], [`Index::export`] |

mod export;
mod format;
mod reader;
mod search;
mod shape;
mod vectors;
mod verify;
mod writer;

#[cfg(test)]
mod tests;

pub use export::ExportError;
pub use format::{CodecError, FORMAT_VERSION, IndexError};
pub use reader::Index;
pub use search::{Found, NearShape, SearchMode, Searcher};
pub use shape::{ContentHash, Shape, ShapeEntry, ShapeVectors};
pub use verify::{Verification, verify};
pub use writer::{IndexWriter, Job, damaged_path, work_path};
