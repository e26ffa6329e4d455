use canonform_linalg::{LandmarkDistances, LinalgError, Matrix};

fn line() -> LandmarkDistances {
    let columns = Matrix::from_columns(&[vec![0.0, 1.0, 2.0].into(), vec![2.2, 1.0, 0.0].into()]);
    LandmarkDistances::new(vec![0, 2], columns).unwrap()
}

#[test]
fn the_block_is_symmetric() {
    let d = line();
    let s = d.sq_block();
    assert_eq!(s[(0, 1)], s[(1, 0)]);
    assert!((s[(0, 1)] - 0.5 * (4.0 + 2.2 * 2.2)).abs() < 1e-15);
    assert_eq!(d.column(1).unwrap()[..], [2.2, 1.0, 0.0]);
    assert_eq!(d.at(&[2, 1, 2]).unwrap().column(0).as_slice(), [2.0, 1.0, 2.0]);
}

#[test]
fn unreachable_points_and_bad_landmarks_are_rejected() {
    let columns = Matrix::from_columns(&[vec![0.0, f64::INFINITY].into()]);
    assert_eq!(
        LandmarkDistances::new(vec![0], columns).unwrap_err(),
        LinalgError::BadDistance { row: 1, column: 0, value: f64::INFINITY }
    );
    let zeros = Matrix::zeros(2, 2);
    assert!(matches!(
        LandmarkDistances::new(vec![1, 1], zeros.clone()),
        Err(LinalgError::BadLandmark { landmark: 1, n_points: 2 })
    ));
    assert!(matches!(LandmarkDistances::new(vec![0], zeros), Err(LinalgError::Shape { .. })));
}
