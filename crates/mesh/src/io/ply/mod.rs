//! PLY through `ply-rs-bw`, element by element: a fault then has a place, and nothing is stored that
//! is not needed.

mod elements;
mod read;
mod write;

pub(super) use read::parse;
pub(super) use write::{write, write_with_field};
