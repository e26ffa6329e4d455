//! Laws of the crate, through what it exports.

// Helper functions are test code too, which clippy cannot see.
#![allow(clippy::unwrap_used)]

mod budgets;
mod collections;
mod explained;
mod progress;
mod threads;
