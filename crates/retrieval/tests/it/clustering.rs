use crate::line;
use canonform_retrieval::*;

#[test]
fn matches_its_definition() {
    let labels = Labels::new(&["a", "a", "b", "b"]);
    let value = silhouette(&line(&[0.0, 1.0, 10.0, 12.0]), &labels);
    let term = |a: f64, b: f64| (b - a) / a.max(b);
    let expected = (term(1.0, 11.0) + term(1.0, 10.0) + term(2.0, 9.5) + term(2.0, 11.5)) / 4.0;
    assert!((value - expected).abs() < 1e-15);
}

#[test]
fn degenerate_cases_are_zero() {
    assert_eq!(silhouette(&line(&[0.0, 1.0]), &Labels::new(&["a", "a"])), 0.0);
    assert_eq!(silhouette(&line(&[0.0, 0.0, 0.0]), &Labels::new(&["a", "a", "b"])), 0.0);
}
