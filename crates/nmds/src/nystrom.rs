//! Nystrom multidimensional scaling.

use linalg::{LandmarkDistances, Matrix, symmetric_eigen, thin_qr};

use crate::embedding::center_columns;
use crate::{Embedding, NmdsError, Regularization};

/// Options of [`nystrom`].
#[derive(Debug, Clone, PartialEq)]
pub struct NystromOptions {
    /// What takes the place of the inverse of the sample matrix. Default: [`Regularization::LowRank`] with
    /// half of the eigenpairs.
    pub regularization: Regularization,
    /// Dimensions of the embedding (`k`). Default: 3.
    pub dim: usize,
}

impl Default for NystromOptions {
    fn default() -> Self {
        Self { regularization: Regularization::default(), dim: 3 }
    }
}

impl NystromOptions {
    /// The rank used with `n_landmarks` samples.
    ///
    /// # Errors
    /// [`NmdsError::BadRank`], [`NmdsError::BadAlpha`] and [`NmdsError::BadDimension`].
    pub fn validate(&self, n_landmarks: usize) -> Result<usize, NmdsError> {
        let rank = self.regularization.rank(n_landmarks, self.dim)?;
        if self.dim == 0 || self.dim > rank {
            return Err(NmdsError::BadDimension { dim: self.dim, limit: rank });
        }
        Ok(rank)
    }
}

/// Nystrom multidimensional scaling (NMDS): embeds `p` points from `n << p` columns of distances.
///
/// | paper | here | shape | meaning |
/// |---|---|---|---|
/// | `R` | `sq_columns` | p x n | squared distances to the landmarks |
/// | `S` | `sq_block` | n x n | its rows at the landmarks; symmetric, **indefinite** |
/// | `V~ Λ~⁻¹ V~'` | `inverse` | n x n | its regularised pseudo-inverse, in factors |
/// | `Q W` | `q`, `w` | p x n1, n1 x n1 | QR decomposition of `J R V~` |
/// | `Z` | result | p x k | coordinates, columns by descending eigenvalue |
///
/// `Z = Q U √L` with the `k` algebraically largest eigenpairs `U L U'` of `-1/2 W Λ~⁻¹ W'`
/// (Procedure 2, eq. 13 to 16; `shamai2015` in `REFERENCES.bib`). For [`Regularization::Cur`] `Q W = J R` and
/// the middle is `-1/4 W (P U + U' P') W'` with `P` the first n1 columns of the identity: the QR decomposition of
/// `J [C R]` would say the same twice, `C` being part of `R`.
///
/// * Cost `O(p n n1)` time, `O(p n)` memory; n1 is n but for [`Regularization::LowRank`].
/// * Exact for Euclidean distances in `R^d` when `n1 >= d + 2`.
/// * Distances are scaled by their maximum inside, so the unit of length does not matter (but see
///   [`RpiAlpha::Paper`](crate::RpiAlpha::Paper)).
/// * Eigenvalues of `S` below rounding are left out even when asked for. Negative eigenvalues of the
///   result are left out and their share reported; never NaN.
///
/// **Deviation**: "the n1 largest eigenvalues of S" are those of largest *magnitude*. `S` has one
/// large positive eigenvalue, the geometry sits in the negative ones; in algebraic order the stress
/// stays near four times the optimum whatever n is. `J` is `I - 11'/p` (the paper prints 1/n).
///
/// # Errors
/// [`NmdsError::BadRank`], [`NmdsError::BadAlpha`], [`NmdsError::BadDimension`], [`NmdsError::NoExtent`],
/// [`NmdsError::Linalg`].
pub fn nystrom(distances: &LandmarkDistances, options: &NystromOptions) -> Result<Embedding, NmdsError> {
    let rank = options.validate(distances.n_landmarks())?;
    let unit = distances.max();
    if unit <= 0.0 {
        return Err(NmdsError::NoExtent { n_points: distances.n_points() });
    }
    let sq_columns = distances.matrix().map(|d| (d / unit).powi(2));
    let sq_block = distances.sq_block() / (unit * unit);
    let inverse = options.regularization.pseudo_inverse(&sq_block, unit, rank)?;

    let mut centred = inverse.apply(sq_columns);
    center_columns(&mut centred);
    let (q, w) = thin_qr(&centred);
    let middle = &w * &inverse.core * w.transpose() * -0.5;
    let middle = (&middle + middle.transpose()) * 0.5;
    let inner = symmetric_eigen(&middle)?;
    let dim = options.dim.min(inner.values.len());
    let mut columns = Matrix::zeros(distances.n_points(), options.dim);
    columns.columns_mut(0, dim).copy_from(&(q * inner.vectors.columns(0, dim)));
    Ok(Embedding::from_orthonormal(columns, inner.values, unit, inverse.rank))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Cloud, landmark_distances, procrustes_free_gap, scaled};
    use crate::{RpiAlpha, classical_full};
    use linalg::DistanceMatrix;

    const ALL: [Regularization; 5] = [
        Regularization::LowRank { rank: None },
        Regularization::Rpi { alpha: RpiAlpha::Relative(1e-10) },
        Regularization::Rpi { alpha: RpiAlpha::Relative(1e-8) },
        Regularization::None,
        Regularization::Cur { rank: None },
    ];

    fn options(regularization: Regularization) -> NystromOptions {
        NystromOptions { regularization, ..Default::default() }
    }

    fn low_rank(rank: usize) -> NystromOptions {
        options(Regularization::LowRank { rank: Some(rank) })
    }

    #[test]
    fn points_in_space_come_back_exactly_at_rank_five() {
        let cloud = Cloud::new(300, 3, 1);
        let distances = landmark_distances(&cloud, 10);
        for rank in [Regularization::LowRank { rank: Some(5) }, Regularization::Cur { rank: Some(5) }] {
            let embedding = nystrom(&distances, &options(rank)).unwrap();
            assert!(procrustes_free_gap(&cloud, &embedding) < 1e-9, "{rank:?}");
            assert_eq!(embedding.rank, 5);
            assert!(embedding.negative_mass < 1e-12);
        }
        let at_four = nystrom(&distances, &low_rank(4)).unwrap();
        assert!(procrustes_free_gap(&cloud, &at_four) > 1e-3, "rank 4 cannot hold three dimensions");
    }

    #[test]
    fn every_regularisation_returns_points_in_space_as_far_as_it_can() {
        let cloud = Cloud::new(300, 3, 1);
        let distances = landmark_distances(&cloud, 20);
        // The regularised pseudo-inverse changes large eigenvalues too, by a share of alpha / sigma^4.
        for (regularization, bound) in ALL.into_iter().zip([1e-9, 1e-4, 1e-2, 1e-9, 1e-9]) {
            let embedding = nystrom(&distances, &options(regularization)).unwrap();
            let gap = procrustes_free_gap(&cloud, &embedding);
            assert!(gap < bound, "{regularization:?}: {gap:e}");
        }
    }

    #[test]
    fn with_all_samples_it_is_classical_scaling() {
        let p = 60;
        let cloud = Cloud::new(p, 5, 7);
        let distances = DistanceMatrix::from_pairs(p, |i, j| cloud.distance(i, j).powf(0.8)).unwrap();
        let columns = Matrix::from_fn(p, p, |i, j| distances.get(i, j));
        let all = LandmarkDistances::new((0..p).collect(), columns).unwrap();
        let mds = classical_full(&distances, 3).unwrap();
        let tiny = Regularization::Rpi { alpha: RpiAlpha::Relative(1e-30) };
        let whole = [Regularization::LowRank { rank: Some(p) }, Regularization::Cur { rank: Some(p) }];
        for regularization in whole.into_iter().chain([Regularization::None, tiny]) {
            let nmds = nystrom(&all, &options(regularization)).unwrap();
            assert!((&nmds.coords - &mds.coords).amax() < 1e-8 * mds.coords.amax(), "{regularization:?}");
            assert!((nmds.negative_mass - mds.negative_mass).abs() < 1e-8, "{regularization:?}");
        }
    }

    /// Points of the plane and a little noise: four eigenvalues stand far above the rest.
    fn gapped() -> LandmarkDistances {
        let cloud = Cloud::new(150, 2, 4);
        let noise = |i: usize, j: usize| 1e-4 * ((i + j) as f64 * (1 + i * j) as f64).sin();
        let distance = |i: usize, j: usize| {
            if i == j { 0.0 } else { (cloud.distance(i, j).powi(2) + noise(i, j)).max(0.0).sqrt() }
        };
        LandmarkDistances::new((0..15).collect(), Matrix::from_fn(150, 15, distance)).unwrap()
    }

    #[test]
    fn the_regularised_pseudo_inverse_lies_between_none_and_low_rank() {
        let distances = gapped();
        let embed =
            |regularization| nystrom(&distances, &NystromOptions { regularization, dim: 2 }).unwrap().coords;
        let gap = |a: &Matrix, b: &Matrix| (a - b).amax() / b.amax();
        let none = embed(Regularization::None);
        let four = embed(Regularization::LowRank { rank: Some(4) });
        let apart = gap(&none, &four);
        let rpi = |c| embed(Regularization::Rpi { alpha: RpiAlpha::Relative(c) });
        // Between the fourth powers of the eigenvalues on either side of the gap.
        let eigenvalues = crate::sample_eigenvalues(&distances).unwrap();
        let ratio = |i: usize| (eigenvalues[i] / eigenvalues[0]).abs();
        let between = (ratio(3) * ratio(4)).powi(2);
        let ends = [gap(&rpi(1e-35), &none), gap(&rpi(between), &four)];
        assert!(apart > 1e-6 && ends.iter().all(|end| *end < 1e-2 * apart), "{apart:e} {ends:?}");
    }

    #[test]
    fn the_unit_of_length_does_not_matter() {
        let cloud = Cloud::new(200, 4, 2);
        let columns = Matrix::from_fn(200, 12, |i, j| cloud.distance(i, j).powf(0.9));
        let distances = LandmarkDistances::new((0..12).collect(), columns).unwrap();
        for regularization in ALL {
            let base = nystrom(&distances, &options(regularization)).unwrap();
            for scale in [1e-3, 1e3] {
                let embedding = nystrom(&scaled(&distances, scale), &options(regularization)).unwrap();
                let gap = (embedding.coords / scale - &base.coords).amax();
                assert!(gap < 1e-9 * base.coords.amax(), "{regularization:?}: {gap:e}");
                assert!((embedding.negative_mass - base.negative_mass).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn the_alpha_of_the_paper_is_taken_in_the_unit_of_the_caller() {
        let distances = landmark_distances(&Cloud::new(200, 4, 2), 12);
        for scale in [1e-3, 1.0, 1e3] {
            let distances = scaled(&distances, scale);
            let sigma_1 = crate::sample_eigenvalues(&distances).unwrap()[0];
            let by_name = options(Regularization::Rpi { alpha: RpiAlpha::Paper });
            let by_value = options(Regularization::Rpi { alpha: RpiAlpha::Relative(1.0 / sigma_1) });
            let (a, b) = (nystrom(&distances, &by_name).unwrap(), nystrom(&distances, &by_value).unwrap());
            assert!((&a.coords - &b.coords).amax() < 1e-12 * b.coords.amax());
        }
    }

    #[test]
    fn impossible_requests_are_refused_with_the_limit() {
        let distances = landmark_distances(&Cloud::new(20, 3, 3), 6);
        let ask = |regularization, dim| nystrom(&distances, &NystromOptions { regularization, dim });
        let low_rank = |rank| Regularization::LowRank { rank };
        let cur = |rank| Regularization::Cur { rank };
        for ranked in [low_rank, cur] {
            assert_eq!(ask(ranked(Some(7)), 3), Err(NmdsError::BadRank { rank: 7, n_landmarks: 6 }));
            assert_eq!(ask(ranked(Some(0)), 3), Err(NmdsError::BadRank { rank: 0, n_landmarks: 6 }));
            assert_eq!(ask(ranked(Some(2)), 3), Err(NmdsError::BadDimension { dim: 3, limit: 2 }));
            assert_eq!(ask(ranked(None), 0), Err(NmdsError::BadDimension { dim: 0, limit: 4 }));
        }
        assert_eq!(ask(Regularization::None, 7), Err(NmdsError::BadDimension { dim: 7, limit: 6 }));
        for alpha in [0.0, -1.0, f64::INFINITY] {
            let rpi = Regularization::Rpi { alpha: RpiAlpha::Relative(alpha) };
            assert_eq!(ask(rpi, 3), Err(NmdsError::BadAlpha { alpha }));
        }
        let nothing = LandmarkDistances::new(vec![0, 1, 2], Matrix::zeros(4, 3)).unwrap();
        assert_eq!(nystrom(&nothing, &NystromOptions::default()), Err(NmdsError::NoExtent { n_points: 4 }));
    }

    #[test]
    fn a_line_has_two_empty_dimensions_and_no_nan() {
        let columns = Matrix::from_fn(30, 5, |i, j| (i as f64 - 6.0 * j as f64).abs());
        let line = LandmarkDistances::new((0..5).map(|j| 6 * j).collect(), columns).unwrap();
        for regularization in ALL {
            let embedding = nystrom(&line, &options(regularization)).unwrap();
            assert!(embedding.coords.iter().all(|x| x.is_finite()), "{regularization:?}");
        }
        let embedding = nystrom(&line, &NystromOptions::default()).unwrap();
        assert!(embedding.coords.column(1).amax() < 1e-6 && embedding.coords.column(2).amax() < 1e-6);
        assert!((embedding.coords.column(0).max() - 14.5).abs() < 1e-9);
    }

    #[test]
    fn a_single_sample_gives_no_shape_and_no_nan() {
        let one =
            LandmarkDistances::new(vec![3], Matrix::from_fn(8, 1, |i, _| (i as f64 - 3.0).abs())).unwrap();
        for regularization in ALL {
            let embedding = nystrom(&one, &NystromOptions { regularization, dim: 1 }).unwrap();
            assert_eq!(embedding.coords, Matrix::zeros(8, 1), "{regularization:?}");
        }
    }
}
