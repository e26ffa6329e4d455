//! A durable index: shapes in one SQLite file, found by name or by nearest vectors.
//!
//! ```text
//! Shape -> IndexWriter -> commit, commit, ... finish -> NAME -> Index -> nearest | each | verify | export
//! ```
//!
//! Everything that speaks SQL can read the file; the module `database` has the schema. A writer commits what it has every so
//! often, so that an interrupted one loses nothing and goes on where it was. Readers keep the state that they opened.
//! Every row has a checksum that is compared whenever it is read.
//!
//! Vectors come from outside; the index does not know what they describe.
//!
//! ```
//! use canonform_index::{Entry, Index, IndexWriter, Shape};
//!
//! # let folder = tempfile::tempdir().unwrap();
//! let path = folder.path().join("animals.canonform");
//! let shape = |id: &str, label: &str, vector: [f32; 2]| {
//!     let entry = Entry { id: id.into(), label: label.into(), path: format!("{id}.off"), ..Entry::default() };
//!     Shape { entry, fused: vector.to_vec(), ..Shape::default() }
//! };
//! let mut writer = IndexWriter::build(&path, "how the vectors were made")?;
//! writer.put(&[shape("cat0", "cat", [0.0, 0.1]), shape("dog0", "dog", [5.0, 0.2])])?;
//! writer.finish()?;
//!
//! let index = Index::open(&path)?;
//! assert_eq!((index.len(), index.entry("cat0")?.path.as_str()), (2, "cat0.off"));
//! assert_eq!(index.nearest(&[4.0, 0.0], 1)?[0].0, "dog0");
//! # Ok::<(), canonform_index::IndexError>(())
//! ```
//!
//! Modules, each of which uses only those above it:
//!
//! | module | contents |
//! |---|---|
//! | `shape` | the record of one shape |
//! | `vectors` | all vectors in memory, and the nearest of them. Knows no file |
//! | `database` | the schema, and how the file is opened |
//! | `reader`, `writer` | [`Index`], [`IndexWriter`] |
//! | `search` | [`Index::nearest`] |
//! | `verify`, `export` | [`verify`], [`Index::export`], [`Index::export_as`] |

mod database;
mod error;
mod export;
mod reader;
mod search;
mod shape;
mod vectors;
mod verify;
mod writer;

#[cfg(test)]
mod tests;

pub use base::ContentHash;
pub use database::{damaged_path, log_path};
pub use error::{FORMAT_VERSION, IndexError};
pub use export::{ExportFormat, csv_field, text_cell};
pub use reader::Index;
pub use shape::{Entry, Facts, Shape};
pub use vectors::VectorTable;
pub use verify::{Verification, verify};
pub use writer::IndexWriter;
