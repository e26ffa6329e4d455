//! Laws of the crate, through what it exports.

// Helper functions are test code too, which clippy cannot see.
#![allow(clippy::unwrap_used)]

mod budgets;
mod every_method;
mod hubs;
mod properties;
mod slivers;
mod support;
