//! The result of every method.

use linalg::{Matrix, symmetric_eigen, thin_qr};

use crate::NmdsError;

/// Coordinates of p points in k dimensions, and what is known of their quality.
#[derive(Debug, Clone, PartialEq)]
pub struct Embedding {
    /// p x k coordinates in the unit of the distances, centred; columns by descending eigenvalue, the
    /// largest entry of each column positive. A column is zero where no positive eigenvalue was left.
    pub coords: Matrix,
    /// All eigenvalues the method computed, descending; the first k made the columns of `coords`.
    pub eigenvalues: Vec<f64>,
    /// Sum of the magnitudes of negative eigenvalues over the sum of all magnitudes, in 0..=1: how
    /// far the distances are from Euclidean ones, among the eigenvalues computed.
    pub negative_mass: f64,
    /// Number of eigenpairs of the sample matrix (or of eigenvalues, without samples) that were used.
    pub rank: usize,
}

impl Embedding {
    /// Number of points p.
    #[must_use]
    pub fn n_points(&self) -> usize {
        self.coords.nrows()
    }

    /// Number of dimensions k.
    #[must_use]
    pub fn dim(&self) -> usize {
        self.coords.ncols()
    }

    /// Number of leading dimensions with a positive eigenvalue; the other columns are zero.
    #[must_use]
    pub fn positive_dims(&self) -> usize {
        self.eigenvalues.iter().take(self.dim()).filter(|value| **value > 0.0).count()
    }

    /// Scales orthonormal columns by the roots of their eigenvalues and fixes their signs.
    pub(crate) fn from_orthonormal(
        mut columns: Matrix,
        eigenvalues: Vec<f64>,
        unit: f64,
        rank: usize,
    ) -> Self {
        for (mut column, value) in columns.column_iter_mut().zip(&eigenvalues) {
            let scale = value.max(0.0).sqrt() * unit;
            // The first of several entries of the same size decides, so that rounding cannot.
            let largest = column.iter().copied().fold(0.0f64, |a, x| a.max(x.abs()));
            let lead = column.iter().copied().find(|x| x.abs() >= 0.999 * largest).unwrap_or(0.0);
            column *= if lead < 0.0 { -scale } else { scale };
        }
        let eigenvalues: Vec<f64> = eigenvalues.iter().map(|value| value * unit * unit).collect();
        let negative_mass = negative_mass(&eigenvalues);
        Self { coords: columns, eigenvalues, negative_mass, rank }
    }

    /// Centres coordinates in units of `unit` and turns them to their principal axes; `eigenvalues` become
    /// those of `Z' Z`. Straight lines between points stay as they are.
    pub(crate) fn along_principal_axes(
        mut coords: Matrix,
        unit: f64,
        rank: usize,
    ) -> Result<Self, NmdsError> {
        center_columns(&mut coords);
        let (q, w) = thin_qr(&coords);
        let axes = symmetric_eigen(&(&w * w.transpose()))?;
        let eigenvalues = axes.values.iter().map(|value| value.max(0.0)).collect();
        Ok(Self::from_orthonormal(q * axes.vectors, eigenvalues, unit, rank))
    }
}

/// Share of negative eigenvalues in the sum of magnitudes; zero when all are zero.
pub(crate) fn negative_mass(eigenvalues: &[f64]) -> f64 {
    let total: f64 = eigenvalues.iter().map(|value| value.abs()).sum();
    let negative: f64 = eigenvalues.iter().map(|value| (-value).max(0.0)).sum();
    if total > 0.0 { negative / total } else { 0.0 }
}

/// Subtracts its mean from every column: the product with `J = I - 11'/p` from the left.
pub(crate) fn center_columns(columns: &mut Matrix) {
    let p = columns.nrows().max(1) as f64;
    for mut column in columns.column_iter_mut() {
        let mean = column.sum() / p;
        column.add_scalar_mut(-mean);
    }
}
