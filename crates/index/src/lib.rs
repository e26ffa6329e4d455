//! A durable index: shapes in one file, found by name or by nearest vectors.
//!
//! ```text
//! Shape -> IndexWriter -> NAME.work -> finish -> NAME -> Index -> nearest | each | verify | export
//! ```
//!
//! An index is a sorted map from keys to values. Its file holds the map as it was written first, followed by what additions
//! and removals have changed; nothing that a reader uses is ever modified. A writer logs every `put` in a file next to the
//! index, `NAME.work`. When it is done, it appends the changes to the index, or writes the index anew if they are many. So
//! readers need no lock, an addition takes time in proportion to what is added, and an interrupted writer loses nothing
//! that it has put. Each block has a checksum that is compared whenever the block is read.
//!
//! Vectors come from outside; the index does not know what they describe.
//!
//! ```
//! use canonform_index::{ContentHash, Index, IndexWriter, Job};
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
//! writer.finish(&())?;
//!
//! let index = Index::open(&path)?;
//! assert_eq!((index.len(), index.entry("cat0")?.path.as_str()), (2, "cat0.off"));
//! assert_eq!(index.nearest(&[4.0, 0.0], 1)?[0].id, "dog0");
//! # Ok::<(), canonform_index::IndexError>(())
//! ```
//!
//! Modules, each of which uses only those above it:
//!
//! | module | contents |
//! |---|---|
//! | `texts`, `floats`, `shape` | names, numbers, the record of one shape |
//! | `vectors` | all vectors in memory: the nearest, and the threshold of unknown classes. Knows no file |
//! | `store` | a sorted map in a file, a log of changes, and views of both. Knows no shapes |
//! | `tables`, `derived` | the tables of an index, and those that follow from its shapes |
//! | `reader`, `writer` | [`Index`], [`IndexWriter`] |
//! | `search` | [`Index::nearest`], [`Index::nearest_on_graph`], [`class_threshold`] |
//! | `verify`, `export` | [`verify`], [`Index::export`], [`Index::export_as`] |

mod derived;
mod error;
mod export;
mod floats;
mod reader;
mod search;
mod shape;
mod store;
mod tables;
mod texts;
mod vectors;
mod verify;
mod writer;

#[cfg(test)]
mod tests;

pub use base::ContentHash;
pub use error::{FORMAT_VERSION, IndexError};
pub use export::{ExportError, ExportFormat, csv_field, text_cell};
pub use reader::Index;
pub use search::{NearShape, RankedShape, class_threshold};
pub use shape::{Shape, ShapeEntry, ShapeVectors};
pub use vectors::VectorTable;
pub use verify::{Verification, verify};
pub use writer::{IndexWriter, Job, damaged_path, work_path};
