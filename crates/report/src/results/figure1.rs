//! The record of Figure 1.

use serde::{Deserialize, Serialize};

/// Shapes and their canonical forms.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Figure1Results {
    /// One entry per embedded shape.
    pub shapes: Vec<Figure1Shape>,
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
