//! The record of Figure 3.

use serde::{Deserialize, Serialize};

use super::{Expectation, Provenance};

/// The forms of a few shapes by several methods, and their stress.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Figure3Record {
    /// What made it.
    pub provenance: Provenance,
    /// One row of the picture each.
    pub shapes: Vec<Figure3Shape>,
    /// The stress of every shape and method over repeated runs, for each way of measuring distances.
    pub stresses: Vec<Figure3Stress>,
    /// What was expected.
    pub expectations: Vec<Expectation>,
    /// What the figure shows, in paragraphs of plain text separated by empty lines.
    pub analysis: String,
}

/// One row of the picture: a shape and its forms.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Figure3Shape {
    /// Its name, for example `david0`.
    pub name: String,
    /// Its class, for example `david`.
    pub label: String,
    /// Vertices that were embedded.
    pub n_vertices: usize,
    /// The forms that are drawn, in the order of the columns.
    pub forms: Vec<Figure3Form>,
}

/// One form of the picture: of the repeated runs the one of median stress.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Figure3Form {
    /// How it was made.
    pub method: String,
    /// Its stress, in squared mesh units.
    pub stress: f64,
    /// The stress that the paper prints, where this is the paper's shape.
    pub paper: Option<f64>,
}

/// The stress of one shape by one method over repeated runs.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Figure3Stress {
    /// Name of the shape.
    pub shape: String,
    /// How the distances were measured that were embedded and that the stress is measured against.
    pub distances: String,
    /// How the form was made.
    pub method: String,
    /// The median over the runs, in squared mesh units.
    pub median: f64,
    /// The least.
    pub low: f64,
    /// The greatest.
    pub high: f64,
    /// Number of runs, which differ in the first sample.
    pub runs: usize,
    /// The stress that the paper prints, where this is the paper's shape.
    pub paper: Option<f64>,
}
