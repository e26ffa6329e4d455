//! The record of Figure 3.

use serde::{Deserialize, Serialize};

/// Canonical forms of a few shapes by several methods, and their stress.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Figure3Results {
    /// The rows of the figure.
    pub shapes: Vec<Figure3Shape>,
    /// The stress of every shape and method over repeated runs, for each kind of distances.
    pub stresses: Vec<Figure3Stress>,
}

/// One row of the figure: a shape and its canonical forms.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Figure3Shape {
    /// Its name, for example `david0`.
    pub name: String,
    /// Its class, for example `david`.
    pub label: String,
    /// Vertices of the embedded surface.
    pub n_vertices: usize,
    /// The forms in the order of the columns.
    pub forms: Vec<Figure3Form>,
}

/// One form of the figure, from the run of median stress.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Figure3Form {
    /// Name of the method.
    pub method: String,
    /// Its stress, in squared mesh units.
    pub stress: f64,
    /// The stress printed in the paper, if this is the paper's shape.
    pub paper: Option<f64>,
}

/// The stress of one shape by one method over repeated runs.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Figure3Stress {
    /// Name of the shape.
    pub shape: String,
    /// The kind of the distances that were embedded and that the stress compares with.
    pub distances: String,
    /// Name of the method.
    pub method: String,
    /// The median of the runs, in squared mesh units.
    pub median: f64,
    /// The least of the runs.
    pub low: f64,
    /// The greatest of the runs.
    pub high: f64,
    /// Number of runs, which differ in the first sample.
    pub runs: usize,
    /// The stress printed in the paper, if this is the paper's shape.
    pub paper: Option<f64>,
}
