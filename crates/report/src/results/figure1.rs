//! The record of Figure 1.

use serde::{Deserialize, Serialize};

use super::common::{Expectation, Provenance};

/// Shapes and their canonical forms.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Figure1Record {
    /// How it was made.
    pub provenance: Provenance,
    /// One entry per embedded shape.
    pub shapes: Vec<Figure1Shape>,
    /// What was expected.
    pub expectations: Vec<Expectation>,
    /// What the figure shows, in paragraphs of plain text separated by empty lines.
    pub analysis: String,
}

/// One shape of Figure 1.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Figure1Shape {
    /// Its name, for example `cat0`.
    pub name: String,
    /// Its class, for example `cat`.
    pub label: String,
    /// Vertices of the embedded surface.
    pub n_vertices: usize,
    /// Faces of the embedded surface.
    pub n_faces: usize,
    /// The paper's stress of the canonical form (Frobenius norm over the number of points), in squared mesh units.
    pub stress: f64,
    /// What was repaired in the input, one sentence each.
    pub repair: Vec<String>,
}
