use canonform_retrieval::*;
use linalg::DistanceMatrix;

use crate::line;

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
fn shapes_in_classes_of_two_are_not_queries() {
    let matrix = line(&[0.0, 1.0, 2.0, 3.0, 4.0]);
    // Classes are sorted.
    let scores = evaluate(&matrix, &Labels::new(&["b", "b", "b", "a", "a"]), 1, RankBy::Plain).unwrap();
    assert_eq!(
        (scores.plain.confusion, scores.classes),
        (vec![vec![0, 0], vec![0, 3]], vec!["a".into(), "b".into()])
    );
    let error = evaluate(&matrix, &Labels::new(&["a", "a", "b", "b", "c"]), 1, RankBy::Plain).unwrap_err();
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
    assert_eq!(graph.mean, QueryScores::new(&rankings, &labels).unwrap().mean());
    assert_eq!(graph.confusion.iter().flatten().sum::<usize>(), 9);
    // One flat object.
    let json = serde_json::to_value(&both).unwrap();
    assert_eq!((&json["n"], &json["classes"]), (&9.into(), &serde_json::json!(["a", "b"])));
    assert_eq!((&json["graph"]["map"], &json["map"]), (&graph.mean.map.into(), &both.plain.mean.map.into()));
    assert_eq!(serde_json::from_value::<Evaluation>(json).unwrap(), both);
}

#[test]
fn votes_need_a_neighbor() {
    let (matrix, labels) = two_clusters(1.0);
    let none = evaluate(&matrix, &labels, 0, RankBy::Plain);
    assert_eq!(none, Err(RetrievalError::BadNeighborCount { k: 0, available: 8 }));
}
