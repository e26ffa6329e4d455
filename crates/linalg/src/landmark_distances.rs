//! Distances from a few landmarks to all points.

use std::borrow::Cow;
use std::ops::Range;

use crate::distance_matrix::first_invalid;
use crate::{ColumnStore, LinalgError, Matrix};

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
#[derive(Debug, Clone)]
pub struct LandmarkDistances {
    landmarks: Vec<usize>,
    columns: ColumnStore,
    max: f64,
    /// The squared distances between the landmarks.
    sq_block: Matrix,
}

/// Rows read at a time.
const BLOCK: usize = 1024;

impl LandmarkDistances {
    /// Takes one column of distances per landmark.
    ///
    /// # Errors
    /// As [`of_columns`](Self::of_columns).
    pub fn new(landmarks: Vec<usize>, columns: Matrix) -> Result<Self, LinalgError> {
        Self::of_columns(landmarks, ColumnStore::of_matrix(columns))
    }

    /// Takes one column of distances per landmark, in memory or in a file.
    ///
    /// # Errors
    /// [`LinalgError::BadDistance`] for the first distance that is infinite (an unreachable point), NaN or negative;
    /// [`LinalgError::Shape`]; [`LinalgError::BadLandmark`]; [`LinalgError::File`].
    pub fn of_columns(landmarks: Vec<usize>, columns: ColumnStore) -> Result<Self, LinalgError> {
        let (p, n) = (columns.n_rows(), columns.n_columns());
        if landmarks.len() != n {
            return Err(LinalgError::Shape { n_rows: p, n_columns: landmarks.len(), actual: p * n });
        }
        let mut taken = std::collections::HashSet::with_capacity(n);
        for &landmark in &landmarks {
            if landmark >= p || !taken.insert(landmark) {
                return Err(LinalgError::BadLandmark { landmark, n_points: p });
            }
        }
        let (mut max, mut at_landmarks) = (0.0, Matrix::zeros(n, n));
        for (j, &landmark) in landmarks.iter().enumerate() {
            let column = columns.column(j)?;
            if let Some(row) = first_invalid(&column) {
                return Err(LinalgError::BadDistance { row, column: landmark, value: column[row] });
            }
            max = column.iter().copied().fold(max, f64::max);
            for (i, &other) in landmarks.iter().enumerate() {
                at_landmarks[(i, j)] = column[other];
            }
        }
        let square = |i: usize, j: usize| at_landmarks[(i, j)].powi(2);
        let sq_block =
            Matrix::from_fn(n, n, |i, j| if i == j { 0.0 } else { 0.5 * (square(i, j) + square(j, i)) });
        Ok(Self { landmarks, columns, max, sq_block })
    }

    /// Number of points p.
    pub fn n_points(&self) -> usize {
        self.columns.n_rows()
    }

    /// Number of landmarks n.
    pub fn n_landmarks(&self) -> usize {
        self.landmarks.len()
    }

    /// The point of each landmark, in sampling order.
    pub fn landmarks(&self) -> &[usize] {
        &self.landmarks
    }

    /// Whether the distances are in a file.
    pub fn is_in_file(&self) -> bool {
        self.columns.is_in_file()
    }

    /// The p x n distances; a copy in memory if they are in a file.
    ///
    /// # Errors
    /// [`LinalgError::File`], [`LinalgError::Exceeded`].
    pub fn to_matrix(&self) -> Result<Matrix, LinalgError> {
        self.columns.rows(0..self.n_points())
    }

    /// The distances from landmark number `landmark` to all points.
    ///
    /// # Errors
    /// [`LinalgError::File`].
    pub fn column(&self, landmark: usize) -> Result<Cow<'_, [f64]>, LinalgError> {
        self.columns.column(landmark)
    }

    /// The distances from all landmarks to the points of a range, `range.len()` x n.
    ///
    /// # Errors
    /// [`LinalgError::File`].
    pub fn rows(&self, range: Range<usize>) -> Result<Matrix, LinalgError> {
        self.columns.rows(range)
    }

    /// The distances from all landmarks to some of the points, `points.len()` x n.
    ///
    /// # Errors
    /// [`LinalgError::File`].
    pub fn at(&self, points: &[usize]) -> Result<Matrix, LinalgError> {
        let mut found = Matrix::zeros(points.len(), self.n_landmarks());
        for (landmark, mut at_points) in found.column_iter_mut().enumerate() {
            let column = self.column(landmark)?;
            at_points.iter_mut().zip(points).for_each(|(d, &i)| *d = column[i]);
        }
        Ok(found)
    }

    /// Ranges of rows that a pass over all rows reads one at a time. They depend on the number of points only.
    pub fn blocks(&self) -> Vec<Range<usize>> {
        let p = self.n_points();
        (0..p).step_by(BLOCK).map(|start| start..(start + BLOCK).min(p)).collect()
    }

    /// The largest distance; zero if there are no points.
    pub fn max(&self) -> f64 {
        self.max
    }

    /// The n x n squared distances between the landmarks (`S` in the paper). Averages the two directions of each pair,
    /// because computed distances are not exactly symmetric.
    pub fn sq_block(&self) -> Matrix {
        self.sq_block.clone()
    }
}
