//! Results are bitwise equal for any number of threads.

use canonform::{DescribeOptions, describe};
use datasets::Family;

use crate::support::{body, surface};

#[test]
fn a_description_does_not_depend_on_threads() {
    let surface = surface(&body(Family::Cat));
    let described = || describe(&surface, &DescribeOptions::default(), &()).unwrap();
    let [one, three] = [1, 3].map(|n| testkit::on_threads(n, described));
    assert!(one == three);
}
