//! The index file, from bytes (`codec`, `sealed`) to a database (`overlay` for readers, `work` for writers) and its tables
//! (`tables`, `stored_cells`, `stored_graph`, `changed_cells`, `refresh`, `refresh_graph`).

mod changed_cells;
mod codec;
mod error;
mod guard;
mod overlay;
mod refresh;
mod refresh_graph;
mod sealed;
mod stored_cells;
mod stored_graph;
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
pub(crate) use stored_graph::Graph;
#[cfg(test)]
pub(crate) use stored_graph::{Node, drop_graph};
pub(crate) use tables::{
    BODIES, CACHE, CellState, Changes, ENTRIES, FUSED, FusedVectors, Snapshot, Store, call,
};
pub(crate) use work::WorkFile;
