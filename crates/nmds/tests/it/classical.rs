use canonform_nmds::{classical, classical_full};
use linalg::DistanceMatrix;

use crate::support::Cloud;

#[test]
fn a_few_eigenpairs_equal_those_of_the_full_decomposition() {
    // Above the size of the Krylov iteration.
    let cloud = Cloud::new(601, 4, 5);
    let distances = DistanceMatrix::from_pairs(601, |i, j| cloud.distance(i, j).powf(1.2)).unwrap();
    let (few, all) = (classical(&distances, 4, &()).unwrap(), classical_full(&distances, 4).unwrap());
    assert!((few.coords - &all.coords).amax() < 1e-7 * all.coords.amax());
    assert!(all.negative_mass > 0.01 && all.eigenvalues.len() == 601);
}
