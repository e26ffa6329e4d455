//! Retrieval, classification and clustering scores of a labelled distance matrix.

use linalg::DistanceMatrix;
use serde::{Deserialize, Serialize};

use crate::{
    Averaging, BootstrapOptions, GraphRankings, Labels, QueryScores, Rankings, RetrievalError,
    ScoreIntervals, Scores, bootstrap, silhouette, vote,
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
    let plain = RankingEvaluation::of(distances, labels, knn_k)?;
    let graph = match rank_by {
        RankBy::Plain => None,
        RankBy::Graph => Some(RankingEvaluation::of(&GraphRankings::new(distances), labels, knn_k)?),
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
    fn of(rankings: &impl Rankings, labels: &Labels, knn_k: usize) -> Result<Self, RetrievalError> {
        let scores = QueryScores::new(rankings, labels)?;
        let intervals = bootstrap(&scores, labels, Averaging::Micro, &BootstrapOptions::default())?;
        let n_classes = labels.classes().len();
        let mut confusion = vec![vec![0; n_classes]; n_classes];
        let mut correct = 0;
        for (query, _) in &scores.of {
            let (class, found) = (labels.class(*query), knn_predict(rankings, labels, *query, knn_k)?);
            confusion[class][found] += 1;
            correct += usize::from(class == found);
        }
        let knn_accuracy = correct as f64 / scores.of.len() as f64;
        Ok(Self { mean: scores.mean(labels, Averaging::Micro), knn_accuracy, confusion, intervals })
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ranking::line;

    fn two_clusters(gap: f64) -> (DistanceMatrix, Labels) {
        let positions: Vec<f64> = (0..9).map(|i| f64::from(i) + if i < 4 { 0.0 } else { gap }).collect();
        let names: Vec<&str> = (0..9).map(|i| if i < 4 { "a" } else { "b" }).collect();
        (line(&positions), Labels::new(&names))
    }

    #[test]
    fn separate_clusters_score_one() {
        let (matrix, labels) = two_clusters(100.0);
        let scores = evaluate(&matrix, &labels, 3, RankBy::Plain).unwrap();
        let RankingEvaluation { mean, knn_accuracy, confusion, .. } = scores.plain;
        assert_eq!([mean.nn, mean.ft, mean.st, mean.map, knn_accuracy], [1.0; 5]);
        assert!((mean.dcg - 1.0).abs() < 1e-15 && scores.silhouette > 0.95);
        assert_eq!(confusion, [[4, 0], [0, 5]]);
    }

    #[test]
    fn scale_changes_no_score() {
        let (matrix, labels) = two_clusters(0.5);
        let scaled = DistanceMatrix::from_pairs(9, |i, j| 7.0 * matrix.get(i, j)).unwrap();
        let (a, b) = (
            evaluate(&matrix, &labels, 1, RankBy::Plain).unwrap(),
            evaluate(&scaled, &labels, 1, RankBy::Plain).unwrap(),
        );
        assert!((a.silhouette - b.silhouette).abs() < 1e-12);
        assert_eq!(Evaluation { silhouette: 0.0, ..a }, Evaluation { silhouette: 0.0, ..b });
    }

    #[test]
    fn shapes_in_classes_of_two_are_not_queries() {
        let matrix = line(&[0.0, 1.0, 2.0, 3.0, 4.0]);
        let scores = evaluate(&matrix, &Labels::new(&["a", "a", "a", "b", "b"]), 1, RankBy::Plain).unwrap();
        assert_eq!(scores.plain.confusion, [[3, 0], [0, 0]]);
        let error =
            evaluate(&matrix, &Labels::new(&["a", "a", "b", "b", "c"]), 1, RankBy::Plain).unwrap_err();
        assert_eq!(error, RetrievalError::NothingToScore { n_points: 5, n_classes: 3 });
    }

    #[test]
    fn the_graph_stands_beside_the_plain_ranking() {
        let (matrix, labels) = two_clusters(0.5);
        let plain = evaluate(&matrix, &labels, 1, RankBy::Plain).unwrap();
        let both = evaluate(&matrix, &labels, 1, RankBy::Graph).unwrap();
        assert_eq!(Evaluation { graph: None, ..both.clone() }, plain);
        let graph = both.graph.clone().unwrap();
        let rankings = GraphRankings::new(&matrix);
        assert_eq!(graph.mean, QueryScores::new(&rankings, &labels).unwrap().mean(&labels, Averaging::Micro));
        assert_eq!(graph.confusion.iter().flatten().sum::<usize>(), 9);
        let json = serde_json::to_value(&both).unwrap();
        assert_eq!(
            (&json["graph"]["map"], &json["map"]),
            (&graph.mean.map.into(), &both.plain.mean.map.into())
        );
        assert_eq!(serde_json::from_value::<Evaluation>(json).unwrap(), both);
    }

    #[test]
    fn json_is_one_flat_object() {
        let (matrix, labels) = two_clusters(100.0);
        let evaluation = evaluate(&matrix, &labels, 3, RankBy::Plain).unwrap();
        let json = serde_json::to_string(&evaluation).unwrap();
        assert!(json.starts_with(r#"{"n":9,"classes":["a","b"],"nn":1.0,"ft":1.0,"st":1.0,"e":"#), "{json}");
        assert_eq!(serde_json::from_str::<Evaluation>(&json).unwrap(), evaluation);
    }

    #[test]
    fn the_majority_wins_and_the_nearest_breaks_a_tie() {
        let distances = line(&[0.0, 1.0, 2.0, 3.0]);
        let labels = Labels::new(&["a", "a", "b", "b"]);
        assert_eq!(knn_predict(&distances, &labels, 0, 1), Ok(0));
        assert_eq!(knn_predict(&distances, &labels, 0, 2), Ok(0), "one vote each, and a is nearer");
        assert_eq!(knn_predict(&distances, &labels, 0, 3), Ok(1));
        assert_eq!(
            knn_predict(&distances, &labels, 0, 0),
            Err(RetrievalError::BadNeighborCount { k: 0, available: 3 })
        );
    }
}
