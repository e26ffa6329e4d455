//! Landmark multidimensional scaling: the projection of Landmark Isomap.

use linalg::{LandmarkDistances, symmetric_eigen};

use crate::embedding::{center_columns, negative_mass};
use crate::{Embedding, NmdsError};

/// Landmark MDS: embeds the n landmarks by classical scaling and places every other point by its distances
/// to them.
///
/// | symbol | here | shape | meaning |
/// |---|---|---|---|
/// | `S` | `sq_block` | n x n | squared distances between landmarks |
/// | `V L V'` | `kept` | n x k | largest positive eigenpairs of `-1/2 J S J` |
/// | `δ_a - μ` | `columns` | p x n | squared distances of point a to the landmarks, less the mean row of `S` |
/// | `x_a` | result | p x k | `-1/2 L^(-1/2) V' (δ_a - μ)`, then centred and turned to its principal axes |
///
/// * Cost `O(p n k)` time, `O(p n)` memory.
/// * Exact for Euclidean distances in `R^k` from landmarks in general position (`n >= k + 1`). Otherwise the
///   subspace is that of the landmarks alone, so the stress stays above the optimum however many there are.
/// * `eigenvalues` of the result are the k of its coordinates; `negative_mass` is that of the landmarks.
///
/// After de Silva and Tenenbaum 2002 (`desilva2002` in `REFERENCES.bib`).
///
/// # Errors
/// [`NmdsError::BadDimension`], [`NmdsError::NoExtent`], [`NmdsError::Linalg`].
pub fn landmark_mds(distances: &LandmarkDistances, dim: usize) -> Result<Embedding, NmdsError> {
    let n = distances.n_landmarks();
    // Centring takes one dimension away.
    let limit = n.saturating_sub(1);
    if dim == 0 || dim > limit {
        return Err(NmdsError::BadDimension { dim, limit });
    }
    let unit = distances.max();
    if unit <= 0.0 {
        return Err(NmdsError::NoExtent { n_points: distances.n_points() });
    }
    let mut sq_block = distances.sq_block() / (unit * unit);
    let means = sq_block.row_mean();
    center_columns(&mut sq_block);
    let mut gram = sq_block.transpose() * -0.5;
    center_columns(&mut gram);
    let eigen = symmetric_eigen(&((&gram + gram.transpose()) * 0.5))?;
    let floor = n as f64 * f64::EPSILON * eigen.values[0].abs();
    let positive: Vec<usize> = (0..dim).filter(|&i| eigen.values[i] > floor).collect();
    let kept = eigen.select(&positive);

    let mut columns = distances.matrix().map(|d| (d / unit).powi(2));
    for (mut column, mean) in columns.column_iter_mut().zip(means.iter()) {
        column.add_scalar_mut(-mean);
    }
    let mut placed = columns * &kept.vectors * -0.5;
    for (mut column, value) in placed.column_iter_mut().zip(&kept.values) {
        column /= value.sqrt();
    }
    let coords = placed.resize_horizontally(dim, 0.0);
    let embedding = Embedding::along_principal_axes(coords, unit, positive.len())?;
    Ok(Embedding { negative_mass: negative_mass(&eigen.values), ..embedding })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Cloud, landmark_distances, procrustes_free_gap, scaled};
    use linalg::{DistanceMatrix, Matrix};

    #[test]
    fn points_in_space_come_back_exactly_from_four_landmarks() {
        let cloud = Cloud::new(200, 3, 31);
        for n in [4, 9] {
            let embedding = landmark_mds(&landmark_distances(&cloud, n), 3).unwrap();
            assert!(procrustes_free_gap(&cloud, &embedding) < 1e-9);
            assert_eq!((embedding.rank, embedding.dim()), (3, 3));
        }
    }

    #[test]
    fn all_points_as_landmarks_are_classical_scaling() {
        let p = 50;
        let cloud = Cloud::new(p, 5, 32);
        let distances = DistanceMatrix::from_pairs(p, |i, j| cloud.distance(i, j).powf(0.8)).unwrap();
        let columns = Matrix::from_fn(p, p, |i, j| distances.get(i, j));
        let all = LandmarkDistances::new((0..p).collect(), columns).unwrap();
        let (landmark, mds) = (landmark_mds(&all, 3).unwrap(), crate::classical_full(&distances, 3).unwrap());
        assert!((&landmark.coords - &mds.coords).amax() < 1e-8 * mds.coords.amax());
        assert!((landmark.negative_mass - mds.negative_mass).abs() < 1e-8);
    }

    /// `x_a = -1/2 L# (δ_a - δ_μ)` point by point, as the paper of de Silva and Tenenbaum prints it. Straight
    /// lines between the results do not depend on how they are centred and turned.
    #[test]
    fn it_is_the_closed_form_also_far_from_euclidean_distances() {
        let cloud = Cloud::new(120, 4, 33);
        let (n, k) = (12, 3);
        let columns = Matrix::from_fn(120, n, |i, j| cloud.distance(i, j).powf(0.6));
        let distances = LandmarkDistances::new((0..n).collect(), columns).unwrap();
        let embedding = landmark_mds(&distances, k).unwrap();

        let squares = distances.sq_block();
        let centring = Matrix::identity(n, n).add_scalar(-1.0 / n as f64);
        let eigen = symmetric_eigen(&(&centring * &squares * &centring * -0.5)).unwrap();
        let place = |a: usize| -> Vec<f64> {
            let inner = |c: usize| -> f64 {
                let off = |j: usize| distances.matrix()[(a, j)].powi(2) - squares.row(j).sum() / n as f64;
                (0..n).map(|j| eigen.vectors[(j, c)] * off(j)).sum()
            };
            (0..k).map(|c| -0.5 * inner(c) / eigen.values[c].sqrt()).collect()
        };
        let places: Vec<Vec<f64>> = (0..120).map(place).collect();
        for a in 0..120 {
            for b in 0..a {
                let straight: f64 = (0..k).map(|c| (places[a][c] - places[b][c]).powi(2)).sum::<f64>().sqrt();
                let found = (embedding.coords.row(a) - embedding.coords.row(b)).norm();
                assert!((straight - found).abs() < 1e-10, "{a} {b}: {straight} {found}");
            }
        }
    }

    #[test]
    fn the_unit_of_length_does_not_matter() {
        let distances = landmark_distances(&Cloud::new(150, 5, 34), 10);
        let base = landmark_mds(&distances, 3).unwrap();
        for scale in [1e-3, 1e3] {
            let embedding = landmark_mds(&scaled(&distances, scale), 3).unwrap();
            assert!((embedding.coords / scale - &base.coords).amax() < 1e-9 * base.coords.amax());
            assert!((embedding.negative_mass - base.negative_mass).abs() < 1e-9);
        }
    }

    #[test]
    fn impossible_requests_are_refused_with_the_limit() {
        let distances = landmark_distances(&Cloud::new(20, 3, 35), 4);
        assert_eq!(landmark_mds(&distances, 4), Err(NmdsError::BadDimension { dim: 4, limit: 3 }));
        assert_eq!(landmark_mds(&distances, 0), Err(NmdsError::BadDimension { dim: 0, limit: 3 }));
        let nothing = LandmarkDistances::new(vec![0, 1, 2], Matrix::zeros(4, 3)).unwrap();
        assert_eq!(landmark_mds(&nothing, 2), Err(NmdsError::NoExtent { n_points: 4 }));
    }

    #[test]
    fn a_line_has_two_empty_dimensions_and_no_nan() {
        let columns = Matrix::from_fn(30, 5, |i, j| (i as f64 - 6.0 * j as f64).abs());
        let line = LandmarkDistances::new((0..5).map(|j| 6 * j).collect(), columns).unwrap();
        let embedding = landmark_mds(&line, 3).unwrap();
        assert_eq!((embedding.rank, embedding.dim()), (1, 3));
        assert!(embedding.coords.columns(1, 2).amax() < 1e-6);
        assert!((embedding.coords.column(0).max() - 14.5).abs() < 1e-9);
    }
}
