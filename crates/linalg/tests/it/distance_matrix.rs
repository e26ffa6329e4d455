use canonform_linalg::{DistanceMatrix, LinalgError};

#[test]
fn both_directions_are_averaged_and_the_diagonal_is_zero() {
    let d = DistanceMatrix::from_rows(2, vec![0.1, 1.0, 3.0, 0.0]).unwrap();
    assert_eq!(d.as_slice(), &[0.0, 2.0, 2.0, 0.0]);
    assert_eq!(d.max(), 2.0);
    assert_eq!(d.row(1), &[2.0, 0.0]);
}

#[test]
fn errors_name_the_entry() {
    assert_eq!(
        DistanceMatrix::from_rows(2, vec![0.0, 1.0, f64::INFINITY, 0.0]),
        Err(LinalgError::BadDistance { row: 1, column: 0, value: f64::INFINITY })
    );
    assert!(matches!(DistanceMatrix::from_rows(2, vec![0.0; 3]), Err(LinalgError::Shape { .. })));
    assert!(matches!(
        DistanceMatrix::from_pairs(3, |_, _| -1.0),
        Err(LinalgError::BadDistance { row: 0, column: 1, .. })
    ));
}
