use canonform_nmds::landmark_mds;
use linalg::{LandmarkDistances, Matrix, symmetric_eigen};

use crate::support::{Cloud, pairwise};

/// `x_a = -1/2 L# (δ_a - δ_μ)` point by point, as de Silva and Tenenbaum print it. Compares distances, which do not
/// depend on centering and rotation.
#[test]
fn equals_the_closed_form_for_non_euclidean_distances() {
    let cloud = Cloud::new(120, 4, 33);
    let (n, k) = (12, 3);
    let columns = Matrix::from_fn(120, n, |i, j| cloud.distance(i, j).powf(0.6));
    let distances = LandmarkDistances::new((0..n).collect(), columns).unwrap();
    let embedding = landmark_mds(&distances, k).unwrap();

    let squares = distances.sq_block();
    let columns = distances.to_matrix().unwrap();
    let centering = Matrix::identity(n, n).add_scalar(-1.0 / n as f64);
    let eigen = symmetric_eigen(&(&centering * &squares * &centering * -0.5)).unwrap();
    let position = |a: usize| -> Vec<f64> {
        let inner = |c: usize| -> f64 {
            let off = |j: usize| columns[(a, j)].powi(2) - squares.row(j).sum() / n as f64;
            (0..n).map(|j| eigen.vectors[(j, c)] * off(j)).sum()
        };
        (0..k).map(|c| -0.5 * inner(c) / eigen.values[c].sqrt()).collect()
    };
    let positions = Matrix::from_row_iterator(120, k, (0..120).flat_map(position));
    assert!((pairwise(&positions) - pairwise(&embedding.coords)).amax() < 1e-10);
}
