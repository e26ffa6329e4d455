use linalg::DistanceMatrix;

use canonform_retrieval::*;

use crate::line;

/// Class `a` of four on the left; class `b` of three on the right, one of them among `a`.
fn example() -> (DistanceMatrix, Labels) {
    let positions = [0.0, 1.0, 2.0, 3.5, 1.4, 50.0, 51.5];
    (line(&positions), Labels::new(&["a", "a", "a", "a", "b", "b", "b"]))
}

fn of_first(positions: &[f64], names: &[&str]) -> Option<Scores> {
    Scores::for_query(&rank(&line(positions), 0), 0, &Labels::new(names))
}

#[test]
fn scores_follow_their_definitions_on_a_worked_example() {
    // From shape 0 the order is b a a b b a: relevant at ranks 2, 3 and 6 of 6.
    let positions = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
    let scores = of_first(&positions, &["a", "b", "a", "a", "b", "b", "a"]).unwrap();
    assert_eq!(scores.nn, 0.0);
    assert!((scores.ft - 2.0 / 3.0).abs() < 1e-15);
    assert_eq!(scores.st, 1.0);
    assert!((scores.map - (1.0 / 2.0 + 2.0 / 3.0 + 3.0 / 6.0) / 3.0).abs() < 1e-15);
    let gain = 1.0 + 1.0 / 3f64.log2() + 1.0 / 6f64.log2();
    let ideal = 1.0 + 1.0 + 1.0 / 3f64.log2();
    assert!((scores.dcg - gain / ideal).abs() < 1e-15);
    // At rank 6: precision 1/2, recall 1.
    assert!((scores.e - 2.0 / 3.0).abs() < 1e-15);
}

#[test]
fn e_measure_looks_at_a_page() {
    let positions: Vec<f64> = (0..40).map(f64::from).collect();
    let e = |is_relevant: fn(usize) -> bool| {
        let names: Vec<&str> = (0..40).map(|i| if is_relevant(i) { "a" } else { "b" }).collect();
        of_first(&positions, &names).unwrap().e
    };
    // The first 36 are relevant: of 32 all are, which is a recall of 8/9. And the last one only is.
    assert!((e(|i| i <= 36) - 16.0 / 17.0).abs() < 1e-15);
    assert_eq!(e(|i| i % 39 == 0), 0.0);
}

#[test]
fn a_class_of_one_has_no_scores() {
    assert_eq!(of_first(&[0.0, 1.0], &["a", "b"]), None);
}

#[test]
fn means_weigh_queries_alike() {
    let (distances, labels) = example();
    // Correct nearest neighbors: the first and last of a, the two distant ones of b.
    let found = QueryScores::new(&distances, &labels).unwrap().mean();
    assert!((found.nn - 4.0 / 7.0).abs() < 1e-15);
}

#[test]
fn precision_falls_with_recall() {
    let (distances, labels) = example();
    let curve = precision_recall(&distances, &labels, 11).unwrap();
    assert!(curve.windows(2).all(|w| w[0] >= w[1]) && curve[0] < 1.0 && curve[10] > 0.0);
    // The two outer ones of three find another shape second.
    let distance = |i: usize, j: usize| if j < 3 { (j - i) as f64 } else { 1.5 };
    let three = DistanceMatrix::from_pairs(4, distance).unwrap();
    let curve = precision_recall(&three, &Labels::new(&["a", "a", "a", "b"]), 2).unwrap();
    assert!(curve[0] == 1.0 && (curve[1] - 7.0 / 9.0).abs() < 1e-15);
}

#[test]
fn scores_need_a_large_class_and_a_label_per_shape() {
    let distances = DistanceMatrix::from_pairs(2, |_, _| 1.0).unwrap();
    let error = QueryScores::new(&distances, &Labels::new(&["a", "a"])).unwrap_err();
    assert_eq!(error, RetrievalError::NothingToScore { n_points: 2, n_classes: 1 });
    let error = precision_recall(&distances, &Labels::new(&["a"]), 11).unwrap_err();
    assert_eq!(error, RetrievalError::LabelCount { n_labels: 1, n_points: 2 });
}
