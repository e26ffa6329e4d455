use crate::line;
use canonform_retrieval::*;

const ONCE: SplitOptions = SplitOptions { n_train: 2, runs: 50, seed: 7 };

#[test]
fn separate_classes_are_classified_without_error() {
    let positions: Vec<f64> = (0..12).map(|i| f64::from(i / 4 * 100 + i)).collect();
    let names: Vec<String> = (0..12).map(|i| (i / 4).to_string()).collect();
    let found = split_accuracy(&line(&positions), &Labels::new(&names), &ONCE).unwrap().unwrap();
    assert_eq!(found, [1.0, 0.0]);
}

#[test]
fn a_shape_far_from_its_class_is_wrong_whenever_it_is_tested() {
    // One of the four of `b` is at 10, nearer to `a` than to the others of `b`, but nearest to nothing.
    let positions = [0.0, 1.0, 2.0, 3.0, 10.0, 100.0, 101.0, 102.0];
    let labels = Labels::new(&["a", "a", "a", "a", "b", "b", "b", "b"]);
    let options = SplitOptions { n_train: 3, runs: 4000, seed: 1 };
    let found = split_accuracy(&line(&positions), &labels, &options).unwrap().unwrap();
    // It is one of the two test shapes in a quarter of the splits: a Bernoulli variable of mean 1/4, halved.
    let (mean, deviation) = (1.0 - 0.25 / 2.0, (0.25f64 * 0.75).sqrt() / 2.0);
    assert!((found[0] - mean).abs() < 4.0 * deviation / 4000f64.sqrt(), "{found:?}");
    assert!((found[1] - deviation).abs() < 0.01, "{found:?}");
    assert_eq!(split_accuracy(&line(&positions), &labels, &options).unwrap(), Some(found));
}

#[test]
fn classes_that_are_too_small_take_no_part() {
    let labels = Labels::new(&["a", "a", "a", "b", "b", "c", "c", "c"]);
    let positions = [0.0, 1.0, 2.0, 0.5, 1.5, 50.0, 51.0, 52.0];
    let found = split_accuracy(&line(&positions), &labels, &ONCE).unwrap().unwrap();
    assert_eq!(found, [1.0, 0.0]);
    let one = Labels::new(&["a", "a", "a", "b", "b", "b", "c", "c"]);
    let none = SplitOptions { n_train: 3, ..ONCE };
    assert_eq!(split_accuracy(&line(&positions), &one, &none), Ok(None));
    let short = Labels::new(&["a"]);
    assert!(matches!(
        split_accuracy(&line(&positions), &short, &ONCE),
        Err(RetrievalError::LabelCount { .. })
    ));
}
