//! Laws of whole files, built-in, foreign and real.

// Helper functions are test code too, which clippy cannot see.
#![allow(clippy::unwrap_used)]

mod corpus;
mod files;
mod foreign;
mod made;
mod mutations;
mod polygons;
mod real_data;
