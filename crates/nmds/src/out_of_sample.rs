//! Further points in an embedding.

use linalg::{LinalgError, Matrix};

use crate::NmdsError;

/// Places points in an embedding by NMDS that were not there when it was made, from their distances to its landmarks.
///
/// The coordinates of a point of the embedding are a linear function of its squared distances to the landmarks, less
/// their means: `z = A' (r - m)`. The same function of the distances of another point is the Nystrom extension of the
/// eigenvectors to it (Bengio et al. 2003, `bengio2003` in `REFERENCES.bib`). Points of the embedding get their own
/// coordinates, up to rounding; the mean of the new ones need not be zero.
///
/// ```
/// # extern crate linalg as canonform_linalg;
/// use canonform_linalg::{LandmarkDistances, Matrix};
/// use canonform_nmds::{Regularization, nystrom_extended};
///
/// // The points 0, 1, ..., 9 on a line, and the distances from three of them.
/// let landmarks = vec![0, 4, 9];
/// let columns = Matrix::from_fn(10, 3, |i, j| (i as f64 - landmarks[j] as f64).abs());
/// let (embedding, extension) = nystrom_extended(&LandmarkDistances::new(landmarks, columns)?, Regularization::default(), 1)?;
///
/// // A point between the second and the third.
/// let placed = extension.place(&Matrix::from_row_slice(1, 3, &[1.5, 2.5, 7.5]))?;
/// assert!((placed[(0, 0)] - 0.5 * (embedding.coords[(1, 0)] + embedding.coords[(2, 0)])).abs() < 1e-9);
/// # Ok::<(), canonform_nmds::NmdsError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct OutOfSample {
    /// The unit of length in which `means` are squared distances.
    pub unit: f64,
    /// The mean squared distance of the points of the embedding from each landmark, in units of `unit²`.
    pub means: Vec<f64>,
    /// The coordinates for each squared distance, in the unit of the distances: landmarks x dim.
    pub axes: Matrix,
}

impl OutOfSample {
    /// The coordinates (q x k) of points with these distances to the landmarks (q x n), in the unit of the distances.
    ///
    /// # Errors
    /// [`NmdsError::Linalg`] if there is not one distance for each landmark, or one is infinite, NaN or negative.
    pub fn place(&self, distances: &Matrix) -> Result<Matrix, NmdsError> {
        let ((q, n), n_columns) = (distances.shape(), self.means.len());
        if n != n_columns {
            return Err(LinalgError::Shape { n_rows: q, n_columns, actual: q * n }.into());
        }
        let bad = |value: &f64| !(value.is_finite() && *value >= 0.0);
        if let Some(at) = distances.iter().position(bad) {
            let (row, column) = (at % q, at / q);
            return Err(LinalgError::BadDistance { row, column, value: distances[(row, column)] }.into());
        }
        let mut squares = distances.map(|d| (d / self.unit).powi(2));
        for (mut column, mean) in squares.column_iter_mut().zip(&self.means) {
            column.add_scalar_mut(-mean);
        }
        Ok(squares * &self.axes)
    }
}
