//! Retrieval, classification and clustering scores of a labelled distance matrix.

use linalg::DistanceMatrix;
use serde::{Deserialize, Serialize};

use crate::{
    GraphRankings, Labels, QueryScores, Rankings, RetrievalError, ScoreIntervals, Scores, bootstrap,
    silhouette, vote,
};

/// How shapes are ordered.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum RankBy {
    /// By distance
    #[default]
    Plain,
    /// Both this and by the neighbors that two shapes have in common
    ///
    /// See [`graph_rank`](crate::graph_rank).
    Graph,
}

/// How well the distances of a matrix separate labelled shapes; see [`evaluate`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Evaluation {
    /// Number of shapes.
    pub n: usize,
    /// Class names, sorted; rows and columns of `confusion`.
    pub classes: Vec<String>,
    /// Scores of the ranking by distance; in JSON keys of this object.
    #[serde(flatten)]
    pub plain: RankingEvaluation,
    /// The k of the vote.
    pub knn_k: usize,
    /// Mean silhouette of the classes, in -1..=1.
    pub silhouette: f64,
    /// Scores of the ranking on the neighbor graph, if they were asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub graph: Option<RankingEvaluation>,
}

/// Scores of a ranking. That on the neighbor graph uses the rest of the collection without its classes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RankingEvaluation {
    /// Mean retrieval scores over the queries; in JSON keys of this object.
    #[serde(flatten)]
    pub mean: Scores,
    /// Leave-one-out k-nearest-neighbor accuracy, in 0..=1.
    pub knn_accuracy: f64,
    /// `confusion[true class][predicted class]`: counts of the leave-one-out k-NN vote.
    pub confusion: Vec<Vec<usize>>,
    /// Confidence intervals of the mean scores.
    pub intervals: ScoreIntervals,
}

/// Scores a labelled distance matrix.
///
/// Every shape is a query against all others, ties by index. Shapes in classes of one or two are ranked but not
/// used as queries. Scores are means over queries (micro averages). Those of the neighbor graph stand beside those of the
/// distances if `rank_by` asks for them.
///
/// # Errors
/// [`RetrievalError::LabelCount`], [`RetrievalError::NothingToScore`], [`RetrievalError::BadNeighborCount`].
///
/// ```
/// # extern crate linalg as canonform_linalg;
/// use canonform_linalg::DistanceMatrix;
/// use canonform_retrieval::{Labels, RankBy, evaluate};
///
/// // The third cat is nearer to the dogs.
/// let positions = [0.0_f64, 1.0, 9.0, 10.0, 11.0, 12.0];
/// let distances = DistanceMatrix::from_pairs(6, |i, j| (positions[i] - positions[j]).abs())?;
/// let labels = Labels::new(&["cat", "cat", "cat", "dog", "dog", "dog"]);
/// let evaluation = evaluate(&distances, &labels, 1, RankBy::Plain)?;
/// assert_eq!(evaluation.plain.confusion, [[2, 1], [1, 2]]);
/// assert!((evaluation.plain.mean.nn - 4.0 / 6.0).abs() < 1e-12);
/// # Ok::<(), canonform_retrieval::RetrievalError>(())
/// ```
pub fn evaluate(
    distances: &DistanceMatrix,
    labels: &Labels,
    knn_k: usize,
    rank_by: RankBy,
) -> Result<Evaluation, RetrievalError> {
    let plain = RankingEvaluation::new(distances, labels, knn_k)?;
    let graph = match rank_by {
        RankBy::Plain => None,
        RankBy::Graph => Some(RankingEvaluation::new(&GraphRankings::new(distances), labels, knn_k)?),
    };
    Ok(Evaluation {
        n: distances.n_points(),
        classes: labels.classes().to_vec(),
        plain,
        knn_k,
        silhouette: silhouette(distances, labels),
        graph,
    })
}

impl RankingEvaluation {
    /// Classifies each shape whose class has more than two members by the first `knn_k` of all others.
    fn new(rankings: &impl Rankings, labels: &Labels, knn_k: usize) -> Result<Self, RetrievalError> {
        let scores = QueryScores::new(rankings, labels)?;
        let intervals = bootstrap(&scores, labels);
        let n_classes = labels.classes().len();
        let mut confusion = vec![vec![0; n_classes]; n_classes];
        let mut correct = 0;
        for (query, _) in &scores.of {
            let (class, found) = (labels.class(*query), knn_predict(rankings, labels, *query, knn_k)?);
            confusion[class][found] += 1;
            correct += usize::from(class == found);
        }
        let knn_accuracy = correct as f64 / scores.of.len() as f64;
        Ok(Self { mean: scores.mean(), knn_accuracy, confusion, intervals })
    }
}

/// The most frequent class among the `k` first other shapes; ties go to the class of the first of them.
fn knn_predict(
    rankings: &impl Rankings,
    labels: &Labels,
    query: usize,
    k: usize,
) -> Result<usize, RetrievalError> {
    let available = rankings.n_points() - 1;
    let winner = vote(&rankings.ranking(query), |i| labels.class(i), k, None).class();
    winner.ok_or(RetrievalError::BadNeighborCount { k, available })
}
