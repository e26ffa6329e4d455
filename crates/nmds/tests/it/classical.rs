use canonform_nmds::{classical, classical_full};
use linalg::DistanceMatrix;

use crate::support::{Cloud, circle, procrustes_free_gap};

#[test]
fn euclidean_distances_are_exact_below_and_above_the_size_of_the_krylov_iteration() {
    for p in [40, 700] {
        let cloud = Cloud::new(p, 3, 5);
        let distances = DistanceMatrix::from_pairs(p, |i, j| cloud.distance(i, j)).unwrap();
        let embedding = classical(&distances, 3, &()).unwrap();
        assert!(procrustes_free_gap(&cloud, &embedding) < 1e-9);
    }
}

#[test]
fn a_few_eigenpairs_equal_those_of_the_full_decomposition() {
    let distances = circle(601);
    let (few, all) = (classical(&distances, 4, &()).unwrap(), classical_full(&distances, 4).unwrap());
    for j in 0..4 {
        assert!((few.eigenvalues[j] - all.eigenvalues[j]).abs() < 1e-8 * all.eigenvalues[0]);
    }
    assert!(all.negative_mass > 0.05 && all.eigenvalues.len() == 601);
}
