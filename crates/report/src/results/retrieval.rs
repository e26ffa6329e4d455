//! The record of retrieval by signatures and canonical forms.

use ::retrieval::{ScoreIntervals, Scores, SplitAccuracy};
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
    /// How scores were measured, one sentence an entry.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub protocol: Vec<String>,
    /// Published scores to stand beside these.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub published: Option<Published>,
}

/// Published scores on one collection, as `--compare` reads them from a TOML file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Published {
    /// The collection.
    pub collection: String,
    /// Number of its shapes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shapes: Option<usize>,
    /// Number of its classes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub classes: Option<usize>,
    /// The methods, one `[[method]]` each.
    pub method: Vec<PublishedMethod>,
}

/// Published scores of a method; those that were not published are left out.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PublishedMethod {
    /// Its name.
    pub name: String,
    /// Where the scores are published.
    pub source: String,
    /// Whether its ranking uses the rest of the collection, as the graph does.
    #[serde(default)]
    pub uses_collection: bool,
    /// Nearest neighbour.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub nn: Option<f64>,
    /// First tier.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ft: Option<f64>,
    /// Second tier.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub st: Option<f64>,
    /// E-measure.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub e: Option<f64>,
    /// Discounted cumulative gain.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dcg: Option<f64>,
    /// Mean average precision.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub map: Option<f64>,
}

/// Scores of one ranking.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RankedScores {
    /// Means over queries.
    pub micro: Scores,
    /// Their confidence intervals.
    pub micro_intervals: ScoreIntervals,
    /// Means over classes.
    pub macro_average: Scores,
    /// Their confidence intervals.
    pub macro_intervals: ScoreIntervals,
    /// Leave-one-out accuracy of the vote of the nearest neighbours.
    pub knn_accuracy: f64,
    /// 1-NN classification over random splits, where classes are large enough.
    pub splits: Vec<SplitAccuracy>,
}

/// Scores of the ranking by distance and of that on the neighbour graph.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BothRankings {
    /// By distance.
    pub plain: RankedScores,
    /// On the graph, which uses the rest of the collection without its classes.
    pub graph: RankedScores,
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
    /// Scores with intervals and classification, by distance and on the neighbour graph. The scores above are those by
    /// distance.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rankings: Option<BothRankings>,
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
