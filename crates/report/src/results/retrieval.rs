//! The record of how well signatures and forms bring together what belongs together.

use ::retrieval::Scores;
use serde::{Deserialize, Serialize};

use super::{Expectation, Provenance, Scale};
use crate::ReportError;

/// Scores of every way to compare the shapes of a collection.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct RetrievalRecord {
    /// What made it.
    pub provenance: Provenance,
    /// Names of the shapes.
    pub names: Vec<String>,
    /// Their classes.
    pub labels: Vec<String>,
    /// One entry for each way to compare and each scale.
    pub rows: Vec<RetrievalRow>,
    /// What the last way to compare takes every shape for.
    pub classification: Classification,
    /// What was expected.
    pub expectations: Vec<Expectation>,
    /// What it shows, in paragraphs of plain text separated by empty lines.
    pub analysis: String,
}

/// One way to compare shapes, at one scale.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RetrievalRow {
    /// A signature, or several, or aligned forms.
    pub method: String,
    /// Whether size counts.
    pub scale: Scale,
    /// Means over queries.
    pub micro: Scores,
    /// Means over classes.
    pub macro_average: Scores,
    /// Leave-one-out accuracy of the vote of the nearest.
    pub knn_accuracy: f64,
    /// The least mean average precision when one class is left out of the collection.
    pub held_out_map: f64,
    /// Mean precision over queries at recalls spread evenly from 0 to 1.
    pub precision: Vec<f64>,
}

/// A leave-one-out classification in which a shape may also be unknown.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Classification {
    /// The way to compare.
    pub method: String,
    /// Neighbours that vote.
    pub voters: usize,
    /// Class names, sorted.
    pub classes: Vec<String>,
    /// `confusion[true class][predicted class]`, counts; the last column holds the unknown.
    pub confusion: Vec<Vec<usize>>,
    /// Beyond this distance of the nearest neighbour a shape is unknown.
    pub threshold: f64,
    /// Share of shapes called unknown although their class is there, by thresholds that were found without
    /// their class.
    pub missed: f64,
    /// Share of shapes given a class while their own is not there, by such thresholds.
    pub mistaken: f64,
}

impl RetrievalRecord {
    /// Checks that there is something to draw, that lists agree in length and that every number is finite.
    ///
    /// # Errors
    /// [`ReportError::Empty`], [`ReportError::Shape`] or [`ReportError::NotFinite`], naming the part of the record.
    pub fn validate(&self) -> Result<(), ReportError> {
        let Classification { classes, confusion, .. } = &self.classification;
        if self.rows.iter().all(|row| row.precision.is_empty()) || classes.is_empty() {
            return Err(ReportError::Empty { figure: "the figure of retrieval", unit: "class and curve" });
        }
        for row in &self.rows {
            for &value in &row.precision {
                if !value.is_finite() {
                    let what = format!("the precision of {} ({})", row.method, row.scale.name());
                    return Err(ReportError::NotFinite { what, value });
                }
            }
        }
        let shape = |what: &str, found: usize, expected: usize| match found == expected {
            true => Ok(()),
            false => Err(ReportError::Shape { what: what.to_owned(), found, expected, unit: "class" }),
        };
        shape("the confusion matrix", confusion.len(), classes.len())?;
        confusion
            .iter()
            .try_for_each(|row| shape("a row of the confusion matrix", row.len(), classes.len() + 1))
    }
}
