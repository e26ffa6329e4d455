//! All pairs of distances in little memory, with bounds.
//!
//! `distance_field` (what a field holds), `metric` (what landmarks say about a pair), `build` (from a surface), `query` (pairs, rows, nearest vertices), `file` (the
//! format) and `fault` (what is wrong with a file).

mod build;
mod distance_field;
mod error;
mod fault;
mod file;
mod metric;
mod query;
#[cfg(test)]
mod tests;

pub use build::FieldOptions;
pub use distance_field::{DistanceField, FieldBounds, FieldFacts};
pub use error::FieldError;
pub use fault::FieldFault;
pub use query::{Finish, PairDistance, PairKind};
