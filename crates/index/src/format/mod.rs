//! The index file, from bytes to tables.
//!
//! | module | contents |
//! |---|---|
//! | `codec` | values as bytes with a checksum |
//! | `error` | [`IndexError`] |
//! | `sealed` | a finished file: the database, checksums of its blocks, a footer |
//! | `overlay` | a sealed file as a database that keeps writes in memory |
//! | `tables` | the tables of the database, and how to read and write them |
//! | `stored_cells` | vectors divided into cells, in one of the tables |

mod codec;
mod error;
mod overlay;
mod sealed;
mod stored_cells;
mod tables;

pub use codec::CodecError;
pub use error::IndexError;
pub(crate) use overlay::Overlay;
pub use sealed::FORMAT_VERSION;
pub(crate) use sealed::{BLOCK, DATABASE_MAGIC, Sealed, seal, unseal};
pub(crate) use stored_cells::{StoredCells, vectors, write_cells};
pub(crate) use tables::{BODIES, CACHE, ENTRIES, FUSED, Snapshot, Store, database_error};
