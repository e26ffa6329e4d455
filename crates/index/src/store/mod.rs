//! Where an index is stored: a sorted map from keys to values, in one file.
//!
//! | module | contents |
//! |---|---|
//! | `codec` | values as bytes |
//! | `records` | keys and values one after the other, in blocks with checksums |
//! | `segment` | a sorted run of blocks, with the first key of each |
//! | `file` | an index file: a head and segments, of which later ones count more |
//! | `log` | what a writer has put, removed or changed so far |
//! | `view` | tables: typed keys and values of a file, of a log, or of a log over a file |

mod codec;
mod file;
mod log;
mod records;
mod segment;
mod view;

pub(crate) use codec::{LIMIT, decode, encode};
pub(crate) use file::StoredFile;
#[cfg(test)]
pub(crate) use file::write_forged;
pub(crate) use log::Log;
pub(crate) use records::Changes;
pub(crate) use view::{Table, View};
