use canonform_nmds::{Bandwidth, NmdsError, kernel_pca};
use linalg::{Matrix, symmetric_eigen};

use crate::support::{Cloud, landmark_distances};

#[test]
fn with_all_samples_equals_the_principal_components_of_the_centered_kernel() {
    let p = 40;
    let cloud = Cloud::new(p, 3, 11);
    let distances = landmark_distances(&cloud, p);
    let embedding = kernel_pca(&distances, Bandwidth::Value(4.0), Some(p), 3).unwrap();
    let kernel = Matrix::from_fn(p, p, |i, j| (-cloud.distance(i, j).powi(2) / 32.0).exp());
    let centering = Matrix::identity(p, p).add_scalar(-1.0 / p as f64);
    let kernel = &centering * kernel * &centering;
    let reference = symmetric_eigen(&((&kernel + kernel.transpose()) * 0.5)).unwrap();
    for j in 0..3 {
        assert!((embedding.eigenvalues[j] - reference.values[j]).abs() < 1e-9);
        let overlap = embedding.coords.column(j).dot(&reference.vectors.column(j)).abs();
        assert!((overlap - reference.values[j].sqrt()).abs() < 1e-8);
    }
}

#[test]
fn relative_widths_are_statistics_of_the_distances() {
    let distances = landmark_distances(&Cloud::new(101, 3, 14), 9);
    let mut sorted = distances.to_matrix().unwrap().as_slice().to_vec();
    sorted.sort_by(f64::total_cmp);
    let mean = sorted.iter().sum::<f64>() / sorted.len() as f64;
    let embed = |bandwidth| kernel_pca(&distances, bandwidth, None, 3).unwrap();
    let expected = [mean, sorted[sorted.len() / 2], sorted[sorted.len() - 1]];
    for (bandwidth, sigma) in [Bandwidth::Mean, Bandwidth::Median, Bandwidth::Max].into_iter().zip(expected) {
        let (by_name, by_value) = (embed(bandwidth), embed(Bandwidth::Value(sigma)));
        assert!((by_name.coords - by_value.coords).amax() < 1e-12, "{bandwidth:?}");
    }
}

#[test]
fn the_width_must_be_positive() {
    let distances = landmark_distances(&Cloud::new(30, 3, 13), 6);
    for sigma in [0.0, -1.0, f64::INFINITY] {
        let found = kernel_pca(&distances, Bandwidth::Value(sigma), None, 3);
        assert_eq!(found, Err(NmdsError::BadBandwidth(sigma)));
    }
}
