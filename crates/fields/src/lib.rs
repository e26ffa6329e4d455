//! All pairs of distances in little memory, with bounds.
//!
//! `distance_field` (what a field holds), `metric` (what landmarks say about a pair), `build` (from a surface), `query` (pairs, rows,
//! nearest vertices) and `file` (the format).

mod build;
mod distance_field;
mod error;
mod file;
mod metric;
mod query;

pub use build::FieldOptions;
pub use distance_field::{DistanceField, FieldBounds, FieldFacts};
pub use error::{FieldError, FieldFault};
pub use query::{Finish, PairDistance, PairKind};
