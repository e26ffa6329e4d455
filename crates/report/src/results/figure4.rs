//! The record of Figure 4.

use ::retrieval::Evaluation;
use serde::{Deserialize, Serialize};

use super::common::Scale;

/// Distances between canonical forms, and their maps.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Figure4Results {
    /// Names of the `n` shapes, in the order of all rows below.
    pub names: Vec<String>,
    /// Their classes.
    pub labels: Vec<String>,
    /// The E-measure of a ranking without error; below 1 if classes are small.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub best_e: Option<f64>,
    /// One entry per method and scale.
    pub panels: Vec<Figure4Panel>,
}

/// One method at one scale.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Figure4Panel {
    /// Name of the method, for example `NMDS`.
    pub method: String,
    /// Whether forms keep their size.
    pub scale: Scale,
    /// Distances between the forms, n x n, in units of the forms.
    pub matrix: Vec<Vec<f64>>,
    /// The two-dimensional embedding of `matrix`, n points, in the same units.
    pub map: Vec<[f64; 2]>,
    /// Normalised stress of the map; 0 for a map without distortion.
    pub map_stress: f64,
    /// The negative share of the spectrum of the doubly centred matrix, in 0..=1; 0 for distances between points in a
    /// Euclidean space.
    pub negative_mass: f64,
    /// Retrieval scores of `matrix`.
    pub scores: Evaluation,
    /// Mean silhouette of the classes on the map, in -1..=1.
    pub map_silhouette: f64,
}
