//! The index file, from bytes (`codec`, `sealed`) to a database (`overlay`) and its tables (`tables`, `stored_cells`).

mod codec;
mod error;
mod guard;
mod overlay;
mod sealed;
mod stored_cells;
mod tables;

pub use codec::CodecError;
pub use error::IndexError;
pub(crate) use guard::Guarded;
pub(crate) use overlay::Overlay;
pub use sealed::FORMAT_VERSION;
pub(crate) use sealed::{BLOCK, DATABASE_MAGIC, Sealed, seal, unseal};
#[cfg(test)]
pub(crate) use stored_cells::write_header;
pub(crate) use stored_cells::{StoredCells, vectors, write_cells};
pub(crate) use tables::{BODIES, CACHE, ENTRIES, FUSED, Snapshot, Store, call};
