//! Laws of the crate, through what it exports.

// Helper functions are test code too, which clippy cannot see.
#![allow(clippy::unwrap_used)]

mod classical;
mod every_method;
mod kernel_pca;
mod landmark;
mod nystrom;
mod out_of_sample;
mod reconstruction;
mod sample_search;
mod smacof;
mod spectral;
mod stress;
mod support;
