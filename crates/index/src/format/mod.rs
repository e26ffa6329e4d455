//! The index file, from bytes (`codec`, `sealed`) to a database (`overlay` for readers, `work` for writers) and its tables
//! (`tables`, `stored_cells`, `refresh`).

mod codec;
mod error;
mod guard;
mod overlay;
mod refresh;
mod sealed;
mod stored_cells;
mod tables;
mod work;

pub use codec::CodecError;
pub use error::IndexError;
pub(crate) use guard::Guarded;
pub(crate) use overlay::Overlay;
pub(crate) use refresh::refresh_cells;
pub use sealed::FORMAT_VERSION;
pub(crate) use sealed::Sealed;
#[cfg(test)]
pub(crate) use sealed::{BLOCK, HEAD, seal, sealed_whole};
pub(crate) use stored_cells::{Heads, all_shapes};
#[cfg(test)]
pub(crate) use stored_cells::{make_format_1, write_header};
pub(crate) use tables::{BODIES, CACHE, CellState, Changes, ENTRIES, FUSED, Snapshot, Store, call};
pub(crate) use work::WorkFile;
