//! Results are bitwise equal for any number of threads.

use canonform::embed::{FormOptions, Samples, StressChoice};
use canonform::{DescribeOptions, describe};
use datasets::Family;

use crate::support::{body, facts, measured, surface};

/// Runs work on pools of 1 and 3 threads.
fn on_each_pool<T: Send>(work: impl Fn() -> T + Sync) -> [T; 2] {
    [1, 3].map(|n| testkit::on_threads(n, &work))
}

#[test]
fn an_embedding_does_not_depend_on_threads() {
    let surface = surface(&body(Family::Centaur));
    let options = FormOptions { samples: Samples::Auto, ..FormOptions::default() };
    let [one, three] = on_each_pool(|| facts(&measured(&surface, &options, StressChoice::Estimate)));
    assert!(one == three);
}

#[test]
fn a_description_does_not_depend_on_threads() {
    let surface = surface(&body(Family::Cat));
    let [one, three] = on_each_pool(|| describe(&surface, &DescribeOptions::default(), &()).unwrap());
    assert!(one == three);
}
