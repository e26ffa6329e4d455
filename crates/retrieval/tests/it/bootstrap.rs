use canonform_retrieval::*;

fn scored(nn: &[f64]) -> QueryScores {
    let of = nn.iter().enumerate().map(|(i, nn)| (i, Scores { nn: *nn, ..Scores::default() }));
    QueryScores { n_points: nn.len(), of: of.collect() }
}

#[test]
fn equal_scores_have_an_interval_of_one_point() {
    let labels = Labels::new(&["a", "a", "a", "b", "b", "b"]);
    let scores = scored(&[0.5; 6]);
    let found = bootstrap(&scores, &labels, &BootstrapOptions::default()).unwrap();
    assert!((found.low.nn - 0.5).abs() < 1e-12 && (found.high.nn - 0.5).abs() < 1e-12);
    let perfect = scored(&[1.0; 6]);
    let found = bootstrap(&perfect, &labels, &BootstrapOptions::default()).unwrap();
    assert!(found.low.nn <= found.high.nn && found.high.nn <= 1.0);
    // Classes that differ only from each other do not vary: resamples keep the sizes of classes.
    let scores = scored(&[0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
    let found = bootstrap(&scores, &labels, &BootstrapOptions::default()).unwrap();
    assert!((found.low.nn - 0.5).abs() < 1e-12 && (found.high.nn - 0.5).abs() < 1e-12);
}

#[test]
fn a_share_of_hits_has_the_interval_of_the_binomial_distribution() {
    let n = 400;
    let labels = Labels::new(&vec!["a"; n]);
    let hits: Vec<f64> = (0..n).map(|i| f64::from(u8::from(i % 10 != 0))).collect();
    let options = BootstrapOptions { resamples: 4000, ..BootstrapOptions::default() };
    let found = bootstrap(&scored(&hits), &labels, &options).unwrap();
    let deviation = (0.9f64 * 0.1 / n as f64).sqrt();
    for (end, sign) in [(found.low.nn, -1.0), (found.high.nn, 1.0)] {
        let expected = 0.9 + sign * 1.96 * deviation;
        assert!((end - expected).abs() < 0.2 * deviation, "{end} {expected}");
    }
    assert_eq!(found, bootstrap(&scored(&hits), &labels, &options).unwrap());
}

#[test]
fn nothing_scored_is_an_error() {
    let none = QueryScores { n_points: 2, of: Vec::new() };
    let labels = Labels::new(&["a", "b"]);
    let found = bootstrap(&none, &labels, &BootstrapOptions::default());
    assert_eq!(found, Err(RetrievalError::NothingToScore { n_points: 2, n_classes: 2 }));
}

#[test]
fn quantiles_lie_between_values() {
    let labels = Labels::new(&["a"; 6]);
    let scores = scored(&[0.02, 0.31, 0.44, 0.58, 0.77, 0.93]);
    let ends = |level, resamples| {
        let options = BootstrapOptions { resamples, level, ..BootstrapOptions::default() };
        let found = bootstrap(&scores, &labels, &options).unwrap();
        [found.low.nn, found.high.nn]
    };
    let ([least, most], [low, high]) = (ends(1.0, 2), ends(0.5, 2));
    assert!(least < most);
    let quarter = 0.25 * (most - least);
    assert!((low - least - quarter).abs() < 1e-12 && (most - high - quarter).abs() < 1e-12, "{low} {high}");
    assert!(ends(0.5, 0).iter().all(|end| end.is_nan()));
}
