use canonform_retrieval::*;

/// The interval of the mean of these scores.
fn interval(classes: &[&str], nn: &[f64]) -> [f64; 2] {
    let of = nn.iter().enumerate().map(|(i, nn)| (i, Scores { nn: *nn, ..Scores::default() }));
    let found = bootstrap(&QueryScores { of: of.collect() }, &Labels::new(classes));
    [found.low.nn, found.high.nn]
}

#[test]
fn equal_scores_have_an_interval_of_one_point() {
    // Classes that differ only from each other do not vary: resamples keep the sizes of classes.
    for nn in [[0.5; 6], [1.0; 6], [0.0, 0.0, 0.0, 1.0, 1.0, 1.0]] {
        let [low, high] = interval(&["a", "a", "a", "b", "b", "b"], &nn);
        let mean = nn.iter().sum::<f64>() / 6.0;
        assert!((low - mean).abs() < 1e-12 && (high - mean).abs() < 1e-12 && low <= high && high <= 1.0);
    }
    assert_eq!(interval(&["a"; 117], &[1.0; 117]), [1.0; 2]);
}

#[test]
fn a_share_of_hits_has_the_interval_of_the_binomial_distribution() {
    let n = 400;
    let hits: Vec<f64> = (0..n).map(|i| f64::from(u8::from(i % 10 != 0))).collect();
    let deviation = (0.9f64 * 0.1 / n as f64).sqrt();
    for (end, sign) in interval(&vec!["a"; n], &hits).into_iter().zip([-1.0, 1.0]) {
        let expected = 0.9 + sign * 1.96 * deviation;
        assert!((end - expected).abs() < 0.2 * deviation, "{end} {expected}");
    }
}

#[test]
fn scores_that_are_turned_round_have_intervals_turned_round() {
    let nn: Vec<f64> = (0..9).map(|i| (f64::from(i) * 0.618).fract()).collect();
    let turned: Vec<f64> = nn.iter().map(|nn| 1.0 - nn).collect();
    let [[low, high], [other_low, other_high]] = [nn, turned].map(|nn| interval(&["a"; 9], &nn));
    assert!((low + other_high - 1.0).abs() < 1e-12 && (high + other_low - 1.0).abs() < 1e-12);
}
