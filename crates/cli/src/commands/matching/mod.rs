//! `canonform match`.
//!
//! `pair` (the maps), `known` (landmarks and initial maps), `transfer` (values and labels), `files` (maps, pictures and functional
//! maps).

mod files;
mod known;
mod pair;
mod transfer;

pub(crate) use pair::match_meshes;
