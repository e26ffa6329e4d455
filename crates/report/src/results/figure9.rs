//! The record of Figure 9.

use serde::{Deserialize, Serialize};

use super::{Expectation, Provenance};

/// Times and memory of whole embeddings, distances included.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Figure9Record {
    /// What made it.
    pub provenance: Provenance,
    /// Worker threads of every run.
    pub threads: usize,
    /// One row for each number of vertices and method.
    pub rows: Vec<Figure9Row>,
    /// What was expected.
    pub expectations: Vec<Expectation>,
    /// What the figure shows, in paragraphs of plain text separated by empty lines.
    pub analysis: String,
}

/// One method on one shape.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Figure9Row {
    /// Name of the shape.
    pub shape: String,
    /// Its vertices.
    pub n_vertices: usize,
    /// How it was embedded.
    pub method: String,
    /// What was measured; nothing when the method was not run.
    pub measured: Option<Figure9Measured>,
    /// The seconds that the paper prints for this number of vertices.
    pub paper_seconds: Option<f64>,
    /// Why the method was not run, or a remark; may be empty.
    pub note: String,
}

/// What one method took.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Figure9Measured {
    /// Wall-clock seconds for distances, in the fastest run.
    pub geodesics: f64,
    /// Wall-clock seconds for linear algebra, in the same run.
    pub embedding: f64,
    /// Number of runs.
    pub runs: usize,
    /// Most memory in use at once, in bytes, beyond what was in use before.
    pub peak_bytes: usize,
}

impl Figure9Measured {
    /// Seconds from the repaired mesh to the coordinates.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.geodesics + self.embedding
    }
}
