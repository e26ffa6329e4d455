//! Nystrom multidimensional scaling.

use linalg::{LandmarkDistances, Matrix, symmetric_eigen, thin_qr};

use crate::embedding::center_columns;
use crate::{Embedding, NmdsError};

/// Options of [`nystrom`].
#[derive(Debug, Clone, PartialEq)]
pub struct NystromOptions {
    /// Eigenpairs of the sample matrix to keep (`n1`), 1 to the number of samples n. Fewer regularise
    /// more; with all n the result may blow up. Default: half of n, at least `dim + 4`: the least rank
    /// that is exact for Euclidean distances, `dim + 2`, leaves some first samples 50 % above the
    /// optimal stress at n = 10, two more leave none above 13 %.
    pub rank: Option<usize>,
    /// Dimensions of the embedding (`k`). Default: 3.
    pub dim: usize,
}

impl Default for NystromOptions {
    fn default() -> Self {
        Self { rank: None, dim: 3 }
    }
}

impl NystromOptions {
    /// The rank used with `n_landmarks` samples.
    ///
    /// # Errors
    /// [`NmdsError::BadRank`] and [`NmdsError::BadDimension`].
    pub fn validate(&self, n_landmarks: usize) -> Result<usize, NmdsError> {
        let rank = self.rank.unwrap_or((self.dim + 4).max(n_landmarks.div_ceil(2)).min(n_landmarks));
        if rank == 0 || rank > n_landmarks {
            return Err(NmdsError::BadRank { rank, n_landmarks });
        }
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
/// | `V~`, `Λ~` | `kept` | n x n1 | eigenpairs of `S` of largest magnitude |
/// | `Q W` | `q`, `w` | p x n1, n1 x n1 | QR decomposition of `J R V~` |
/// | `Z` | result | p x k | coordinates, columns by descending eigenvalue |
///
/// `Z = Q U √L` with the `k` algebraically largest eigenpairs `U L U'` of `-1/2 W Λ~⁻¹ W'`
/// (Procedure 2, eq. 13 to 16; `shamai2015` in `REFERENCES.bib`).
///
/// * Cost `O(p n n1)` time, `O(p n)` memory.
/// * Exact for Euclidean distances in `R^d` when `rank >= d + 2`.
/// * Distances are scaled by their maximum inside, so the unit of length does not matter.
/// * Eigenvalues of `S` below rounding are left out even when asked for. Negative eigenvalues of the
///   result are left out and their share reported; never NaN.
///
/// **Deviation**: "the n1 largest eigenvalues of S" are those of largest *magnitude*. `S` has one
/// large positive eigenvalue, the geometry sits in the negative ones; in algebraic order the stress
/// stays near four times the optimum whatever n is. `J` is `I - 11'/p` (the paper prints 1/n).
///
/// # Errors
/// [`NmdsError::BadRank`], [`NmdsError::BadDimension`], [`NmdsError::NoExtent`], [`NmdsError::Linalg`].
pub fn nystrom(distances: &LandmarkDistances, options: &NystromOptions) -> Result<Embedding, NmdsError> {
    let rank = options.validate(distances.n_landmarks())?;
    let unit = distances.max();
    if unit <= 0.0 {
        return Err(NmdsError::NoExtent { n_points: distances.n_points() });
    }
    let sq_columns = distances.matrix().map(|d| (d / unit).powi(2));
    let sq_block = distances.sq_block() / (unit * unit);

    let eigen = symmetric_eigen(&sq_block)?;
    let mut by_magnitude: Vec<usize> = (0..eigen.values.len()).collect();
    by_magnitude.sort_by(|&i, &j| eigen.values[j].abs().total_cmp(&eigen.values[i].abs()));
    by_magnitude.truncate(rank);
    let floor = sq_block.nrows() as f64 * f64::EPSILON * eigen.values[by_magnitude[0]].abs();
    by_magnitude.retain(|&i| eigen.values[i].abs() > floor);
    let kept = eigen.select(&by_magnitude);
    let rank = kept.values.len();

    let mut centred = sq_columns * &kept.vectors;
    center_columns(&mut centred);
    let (q, w) = thin_qr(&centred);
    let inverse =
        Matrix::from_diagonal(&kept.values.iter().map(|value| 1.0 / value).collect::<Vec<_>>().into());
    let middle = &w * inverse * w.transpose() * -0.5;
    let middle = (&middle + middle.transpose()) * 0.5;
    let inner = symmetric_eigen(&middle)?;
    let dim = options.dim.min(rank);
    let mut columns = Matrix::zeros(distances.n_points(), options.dim);
    columns.columns_mut(0, dim).copy_from(&(q * inner.vectors.columns(0, dim)));
    Ok(Embedding::from_orthonormal(columns, inner.values, unit, rank))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Cloud, landmark_distances, procrustes_free_gap};

    #[test]
    fn points_in_space_come_back_exactly_at_rank_five() {
        let cloud = Cloud::new(300, 3, 1);
        let embedding =
            nystrom(&landmark_distances(&cloud, 10), &NystromOptions { rank: Some(5), ..Default::default() })
                .unwrap();
        assert!(procrustes_free_gap(&cloud, &embedding) < 1e-10);
        assert_eq!(embedding.rank, 5);
        assert!(embedding.negative_mass < 1e-12);
        let at_four =
            nystrom(&landmark_distances(&cloud, 10), &NystromOptions { rank: Some(4), ..Default::default() })
                .unwrap();
        assert!(procrustes_free_gap(&cloud, &at_four) > 1e-3, "rank 4 cannot hold three dimensions");
    }

    #[test]
    fn the_unit_of_length_does_not_matter() {
        let cloud = Cloud::new(200, 4, 2);
        let distances = landmark_distances(&cloud, 12);
        let base = nystrom(&distances, &NystromOptions::default()).unwrap();
        for scale in [1e-3, 1e3] {
            let scaled =
                LandmarkDistances::new(distances.landmarks().to_vec(), distances.matrix() * scale).unwrap();
            let embedding = nystrom(&scaled, &NystromOptions::default()).unwrap();
            assert!((embedding.coords / scale - &base.coords).amax() < 1e-9 * base.coords.amax());
        }
    }

    #[test]
    fn impossible_requests_are_refused_with_the_limit() {
        let distances = landmark_distances(&Cloud::new(20, 3, 3), 6);
        let ask = |rank, dim| nystrom(&distances, &NystromOptions { rank, dim });
        assert_eq!(ask(Some(7), 3), Err(NmdsError::BadRank { rank: 7, n_landmarks: 6 }));
        assert_eq!(ask(Some(0), 3), Err(NmdsError::BadRank { rank: 0, n_landmarks: 6 }));
        assert_eq!(ask(Some(2), 3), Err(NmdsError::BadDimension { dim: 3, limit: 2 }));
        assert_eq!(ask(None, 0), Err(NmdsError::BadDimension { dim: 0, limit: 4 }));
        let nothing = LandmarkDistances::new(vec![0, 1, 2], Matrix::zeros(4, 3)).unwrap();
        assert_eq!(nystrom(&nothing, &NystromOptions::default()), Err(NmdsError::NoExtent { n_points: 4 }));
    }

    #[test]
    fn a_line_has_two_empty_dimensions_and_no_nan() {
        let columns = Matrix::from_fn(30, 5, |i, j| (i as f64 - 6.0 * j as f64).abs());
        let line = LandmarkDistances::new((0..5).map(|j| 6 * j).collect(), columns).unwrap();
        let embedding = nystrom(&line, &NystromOptions::default()).unwrap();
        assert!(embedding.coords.iter().all(|x| x.is_finite()));
        assert!(embedding.coords.column(1).amax() < 1e-6 && embedding.coords.column(2).amax() < 1e-6);
        assert!((embedding.coords.column(0).max() - 14.5).abs() < 1e-9);
    }
}
