//! PLY, ASCII and binary.

mod header;
mod read;
mod write;

pub(super) use read::{check_start, parse};
pub(super) use write::{write, write_lines};
