//! Distances from a few landmarks to all points.

use crate::distance_matrix::first_invalid;
use crate::{LinalgError, Matrix};

/// The p x n matrix of distances from n landmarks to all p points, with the points that are landmarks.
///
/// **Invariant.** Distances are finite and not negative; landmarks are distinct points in range.
///
/// ```
/// use canonform_linalg::{LandmarkDistances, Matrix};
///
/// // Distances from the first and the last of four points on a line.
/// let columns = Matrix::from_columns(&[vec![0.0, 1.0, 2.0, 3.0].into(), vec![3.0, 2.0, 1.0, 0.0].into()]);
/// let distances = LandmarkDistances::new(vec![0, 3], columns)?;
/// assert_eq!((distances.n_points(), distances.n_landmarks()), (4, 2));
/// assert_eq!(distances.sq_block()[(0, 1)], 9.0);
/// # Ok::<(), canonform_linalg::LinalgError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct LandmarkDistances {
    landmarks: Vec<usize>,
    columns: Matrix,
}

impl LandmarkDistances {
    /// Takes one column of distances per landmark.
    ///
    /// # Errors
    /// [`LinalgError::BadDistance`] for the first distance that is infinite (an unreachable point), NaN or negative;
    /// [`LinalgError::Shape`]; [`LinalgError::BadLandmark`].
    pub fn new(landmarks: Vec<usize>, columns: Matrix) -> Result<Self, LinalgError> {
        let (p, n) = columns.shape();
        if landmarks.len() != n {
            return Err(LinalgError::Shape { n_rows: p, n_columns: landmarks.len(), actual: p * n });
        }
        let mut taken = vec![false; p];
        for &landmark in &landmarks {
            if landmark >= p || std::mem::replace(&mut taken[landmark], true) {
                return Err(LinalgError::BadLandmark { landmark, n_points: p });
            }
        }
        if let Some(bad) = first_invalid(columns.as_slice()) {
            let (row, column) = (bad % p, landmarks[bad / p]);
            return Err(LinalgError::BadDistance { row, column, value: columns.as_slice()[bad] });
        }
        Ok(Self { landmarks, columns })
    }

    /// Number of points p.
    #[must_use]
    pub fn n_points(&self) -> usize {
        self.columns.nrows()
    }

    /// Number of landmarks n.
    #[must_use]
    pub fn n_landmarks(&self) -> usize {
        self.landmarks.len()
    }

    /// The point of each landmark, in sampling order.
    #[must_use]
    pub fn landmarks(&self) -> &[usize] {
        &self.landmarks
    }

    /// The p x n distances.
    #[must_use]
    pub fn matrix(&self) -> &Matrix {
        &self.columns
    }

    /// The distances from landmark number `landmark` to all points.
    #[must_use]
    pub fn column(&self, landmark: usize) -> &[f64] {
        let p = self.n_points();
        &self.columns.as_slice()[landmark * p..(landmark + 1) * p]
    }

    /// The largest distance; zero if there are no points.
    #[must_use]
    pub fn max(&self) -> f64 {
        self.columns.as_slice().iter().copied().fold(0.0, f64::max)
    }

    /// The n x n squared distances between the landmarks (`S` in the paper). Averages the two directions of each pair,
    /// because computed distances are not exactly symmetric.
    #[must_use]
    pub fn sq_block(&self) -> Matrix {
        let square = |i: usize, j: usize| self.columns[(self.landmarks[i], j)].powi(2);
        let n = self.n_landmarks();
        Matrix::from_fn(n, n, |i, j| if i == j { 0.0 } else { 0.5 * (square(i, j) + square(j, i)) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        assert_eq!(d.column(1), &[2.2, 1.0, 0.0]);
    }

    #[test]
    fn unreachable_points_and_bad_landmarks_are_rejected() {
        let columns = Matrix::from_columns(&[vec![0.0, f64::INFINITY].into()]);
        assert_eq!(
            LandmarkDistances::new(vec![0], columns),
            Err(LinalgError::BadDistance { row: 1, column: 0, value: f64::INFINITY })
        );
        let zeros = Matrix::zeros(2, 2);
        assert!(matches!(
            LandmarkDistances::new(vec![1, 1], zeros.clone()),
            Err(LinalgError::BadLandmark { landmark: 1, n_points: 2 })
        ));
        assert!(matches!(LandmarkDistances::new(vec![0], zeros), Err(LinalgError::Shape { .. })));
    }
}
