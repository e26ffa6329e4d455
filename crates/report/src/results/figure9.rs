//! The record of Figure 9.

use serde::{Deserialize, Serialize};

/// Times and memory of whole embeddings, distances included.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Figure9Results {
    /// Worker threads of every run.
    pub threads: usize,
    /// One row per number of vertices and method.
    pub rows: Vec<Figure9Row>,
}

/// One method on one shape.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Figure9Row {
    /// Name of the shape.
    pub shape: String,
    /// Its vertices.
    pub n_vertices: usize,
    /// Name of the method.
    pub method: String,
    /// What was measured, if the method was run.
    pub measured: Option<Figure9Measured>,
    /// The seconds printed in the paper for this number of vertices.
    pub paper_seconds: Option<f64>,
    /// Why the method was not run, or a remark; may be empty.
    pub note: String,
}

/// Time and memory of one method.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Figure9Measured {
    /// Wall-clock seconds for distances, in the fastest run.
    pub geodesics: f64,
    /// Wall-clock seconds for linear algebra, in the same run.
    pub embedding: f64,
    /// Number of runs.
    pub runs: usize,
    /// Peak memory in bytes, in addition to that in use before.
    pub peak_bytes: usize,
}

impl Figure9Measured {
    /// Seconds from the repaired mesh to the coordinates.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.geodesics + self.embedding
    }
}
