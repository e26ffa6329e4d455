//! Laws of forms of many dimensions.

use canonform_descriptors::{DescriptorError, SampledForm};
use linalg::{LandmarkDistances, Matrix};
use nmds::landmark_mds;

const LANDMARKS: usize = 40;

/// Points in a box of five dimensions, denser towards one corner.
fn cloud() -> Matrix {
    let wave =
        |i: usize, j: usize| (0.5 + 0.5 * (f64::from(((i + 1) * (7 * j + 11)) as u32)).sin()).powf(1.5);
    Matrix::from_fn(400, 5, |i, j| wave(i, j) * [2.0, 1.0, 0.7, 0.5, 0.3][j])
}

fn distances(points: &Matrix) -> LandmarkDistances {
    let between = |i: usize, j: usize| (points.row(i) - points.row(j)).norm();
    let columns = Matrix::from_fn(points.nrows(), LANDMARKS, between);
    LandmarkDistances::new((0..LANDMARKS).collect(), columns).unwrap()
}

fn masses() -> Vec<f64> {
    (0..400).map(|i| 1.0 + f64::from(i % 7)).collect()
}

#[test]
fn straight_distances_have_the_spectrum_of_their_points() {
    let form = SampledForm::by_least_squares(&distances(&cloud()), &masses(), &()).unwrap();
    let direct = SampledForm::new(&landmark_mds(&distances(&cloud()), 5).unwrap().coords, &masses()).unwrap();
    let gap = form.spectrum(1.0).unwrap().distance(&direct.spectrum(1.0).unwrap());
    assert!(gap < 1e-6, "{gap}");
}

#[test]
fn scale_motions_and_mirror_images_change_no_spectrum() {
    let own = SampledForm::new(&cloud(), &masses()).unwrap();
    // A turn in a plane and a reflection.
    let mut turn = Matrix::identity(5, 5) * -3.0;
    let (sine, cosine) = 0.7f64.sin_cos();
    let plane = Matrix::from_row_slice(2, 2, &[cosine, sine, -sine, cosine]) * 3.0;
    turn.view_mut((0, 0), (2, 2)).copy_from(&plane);
    let moved = SampledForm::new(&(cloud() * turn), &masses()).unwrap();
    let gap = own.spectrum(0.5).unwrap().distance(&moved.spectrum(1.5).unwrap());
    assert!(gap < 1e-9, "{gap}");
    assert!(own.spectrum(0.5).unwrap().distance(&own.spectrum(0.6).unwrap()) > 0.1);
}

#[test]
fn the_spectrum_of_two_points_is_that_of_their_matrix() {
    // The kernel falls by a factor of e within a fifth of the unit.
    let form = SampledForm::new(&Matrix::from_row_slice(2, 1, &[-1.0, 1.0]), &[1.0, 1.0]).unwrap();
    let values = form.spectrum(10.0).unwrap().values;
    let expected = [0.5 * (1.0 + (-1f64).exp()), 0.5 * (1.0 - (-1f64).exp())];
    assert!(values.iter().zip(expected).all(|(value, e)| (value - e.ln()).abs() < 1e-12), "{values:?}");
}

#[test]
fn what_has_no_extent_is_refused() {
    let fault = SampledForm::new(&cloud(), &[1.0]).unwrap_err();
    assert_eq!(fault, DescriptorError::SizeMismatch { n_points: 400, n_vertices: 1 });
    assert_eq!(SampledForm::new(&cloud(), &[0.0; 400]), Err(DescriptorError::NoExtent { n_points: 400 }));
}
