//! The one road from a surface to its form and its description.
//!
//! ```text
//! Surface -> Measurement (distances) -> EmbedMethod -> Embedded -> CanonicalForm, index::Shape
//! ```

mod as_text;
mod describe;
mod distances;
mod embed;
mod embedded;
mod extend;
mod method;
mod options;
mod outcome;
mod part;
mod plan;
mod report;
pub mod settings;
mod stress;

pub use describe::{MeasuredSurface, describe, signature};
pub use distances::Samples;
pub use embed::{EmbedInput, EmbedOptions, embed};
pub use embedded::Embedded;
pub use method::EmbedMethod;
pub use options::{DescribeOptions, FormOptions};
pub use part::describe_part;
pub(crate) use part::from_cut;
pub use plan::DISTANCES_LIMIT;
pub use report::{EmbedReport, SecondsReport};
pub use stress::{SharedStress, StressChoice, StressKind, StressOptions, StressReport};
