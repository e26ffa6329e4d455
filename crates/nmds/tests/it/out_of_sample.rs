use canonform_nmds::*;
use linalg::{LandmarkDistances, LinalgError, Matrix};

use crate::support::{Cloud, landmark_distances};

#[test]
fn points_of_the_embedding_keep_their_places() {
    let distances = landmark_distances(&Cloud::new(400, 6, 3), 30);
    for regularization in Regularization::all() {
        let (embedding, extension) = nystrom_extended(&distances, regularization, 3).unwrap();
        let placed = extension.place(&distances.to_matrix().unwrap()).unwrap();
        let gap = (placed - &embedding.coords).amax();
        assert!(gap < 1e-9 * embedding.coords.amax(), "{regularization:?}: {gap:e}");
    }
}

#[test]
fn other_points_in_space_are_placed_exactly() {
    // Both halves of a cloud, embedded together and one after the other.
    let cloud = Cloud::new(200, 3, 5);
    let landmarks: Vec<usize> = (0..12).collect();
    let columns = |rows: std::ops::Range<usize>| {
        Matrix::from_fn(rows.len(), 12, |i, j| cloud.distance(rows.start + i, landmarks[j]))
    };
    let known = LandmarkDistances::new(landmarks.clone(), columns(0..100)).unwrap();
    let (embedding, extension) = nystrom_extended(&known, Regularization::default(), 3).unwrap();
    let placed = extension.place(&columns(100..200)).unwrap();
    for i in 0..100 {
        for j in 0..100 {
            let apart = (placed.row(i) - embedding.coords.row(j)).norm();
            assert!((apart - cloud.distance(100 + i, j)).abs() < 1e-7, "{i}, {j}");
        }
    }
}

#[test]
fn distances_that_do_not_fit_are_refused() {
    let distances = landmark_distances(&Cloud::new(50, 3, 1), 10);
    let (_, extension) = nystrom_extended(&distances, Regularization::default(), 3).unwrap();
    assert!(matches!(
        extension.place(&Matrix::zeros(2, 9)),
        Err(NmdsError::Linalg(LinalgError::Shape { .. }))
    ));
    let mut bad = Matrix::zeros(2, 10);
    bad[(1, 4)] = f64::NAN;
    let fault = extension.place(&bad).unwrap_err();
    assert!(matches!(fault, NmdsError::Linalg(LinalgError::BadDistance { row: 1, column: 4, .. })));
    assert_eq!(extension.place(&Matrix::zeros(0, 10)).unwrap().shape(), (0, 3));
}
