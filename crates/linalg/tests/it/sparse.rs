use canonform_linalg::SparseSymmetric;

/// The product of a matrix with a vector.
pub(crate) fn product(a: &SparseSymmetric, x: &[f64]) -> Vec<f64> {
    let mut y = vec![0.0; x.len()];
    for (i, j, value) in a.entries() {
        y[i] += value * x[j];
        if i != j {
            y[j] += value * x[i];
        }
    }
    y
}

#[test]
fn entries_are_summed_mirrored_and_sorted_and_the_diagonal_is_stored() {
    let a = SparseSymmetric::from_entries(3, [(2, 0, 1.5), (0, 2, 0.5), (1, 1, 4.0), (1, 0, -1.0)]);
    let entries: Vec<_> = a.entries().collect();
    assert_eq!(entries, [(0, 0, 0.0), (1, 0, -1.0), (2, 0, 2.0), (1, 1, 4.0), (2, 2, 0.0)]);
    assert_eq!((a.order(), a.n_stored(), a.diagonal()), (3, 5, vec![0.0, 4.0, 0.0]));
}

#[test]
#[should_panic(expected = "outside of a matrix of order 2")]
fn entries_outside_the_matrix_panic() {
    let _ = SparseSymmetric::from_entries(2, [(0, 2, 1.0)]);
}
