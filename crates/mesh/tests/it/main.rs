//! Laws of whole files and of repair, on built-in, foreign and real meshes.

// Helper functions are test code too, which clippy cannot see.
#![allow(clippy::unwrap_used)]

mod corpus;
mod files;
mod foreign;
mod hubs;
mod real_data;
mod repair;
mod t_junctions;
