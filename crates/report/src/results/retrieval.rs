//! The record of retrieval by signatures and canonical forms.

use ::retrieval::Scores;
use serde::{Deserialize, Serialize};

use super::common::Scale;

/// Scores of several methods to compare the shapes of a collection.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct RetrievalResults {
    /// Names of the shapes.
    pub names: Vec<String>,
    /// Their classes.
    pub labels: Vec<String>,
    /// One entry per method and scale.
    pub rows: Vec<RetrievalRow>,
    /// The E-measure of a ranking without error; below 1 if classes are small.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub best_e: Option<f64>,
    /// The classification of every shape by one of the methods.
    pub classification: Classification,
}

/// One method at one scale.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RetrievalRow {
    /// Name of the method: a signature, several of them, or aligned forms.
    pub method: String,
    /// Whether shapes keep their size.
    pub scale: Scale,
    /// Means over queries.
    pub micro: Scores,
    /// Means over classes.
    pub macro_average: Scores,
    /// Leave-one-out accuracy of the vote of the nearest neighbours.
    pub knn_accuracy: f64,
    /// The lowest mean average precision when one class is left out of the collection.
    pub held_out_map: f64,
    /// Mean precision over queries at equally spaced recalls from 0 to 1.
    pub precision: Vec<f64>,
}

/// A leave-one-out classification in which a shape may also be unknown.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Classification {
    /// Name of the method.
    pub method: String,
    /// Neighbours that vote.
    pub voters: usize,
    /// Class names, sorted.
    pub classes: Vec<String>,
    /// `confusion[true class][predicted class]`: counts. The last column counts shapes classified as unknown.
    pub confusion: Vec<Vec<usize>>,
    /// The shapes that are not in the class that was predicted, in the order of the collection.
    #[serde(default)]
    pub misclassified: Vec<Misclassified>,
    /// A shape is unknown if its nearest neighbour is farther than this.
    pub threshold: f64,
    /// Share of shapes classified as unknown although others of their class are in the collection, by thresholds found
    /// without their class.
    pub missed: f64,
    /// Share of shapes assigned to a class although no other of their own is in the collection, by such thresholds.
    pub mistaken: f64,
}

/// A shape that was assigned to a class that is not its own, or to none.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Misclassified {
    /// Its name.
    pub name: String,
    /// Its class.
    pub label: String,
    /// The predicted class; `None` for unknown.
    pub predicted: Option<String>,
    /// The nearest other shape.
    pub nearest: String,
    /// The distance from it.
    pub distance: f64,
}
