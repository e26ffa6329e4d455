//! The result of every method.

use linalg::{Matrix, leading_sign, symmetric_eigen, thin_qr};

use crate::NmdsError;
use crate::squares::center_columns;

/// Coordinates of p points in k dimensions, and their quality.
#[derive(Debug, Clone, PartialEq)]
pub struct Embedding {
    /// p x k coordinates in the unit of the distances, centered. Columns are in descending order of their eigenvalues;
    /// the largest entry of each is positive. Columns without a positive eigenvalue are zero.
    pub coords: Matrix,
    /// All eigenvalues that the method computed, descending; the first k belong to the columns of `coords`.
    pub eigenvalues: Vec<f64>,
    /// Sum of the magnitudes of negative eigenvalues over the sum of all magnitudes, in 0..=1, among the eigenvalues
    /// computed: measures how far the distances are from Euclidean.
    pub negative_mass: f64,
    /// Number of eigenpairs of the sample matrix that were used (of eigenvalues, if the method uses no samples).
    pub rank: usize,
}

impl Embedding {
    /// Number of points p.
    pub fn n_points(&self) -> usize {
        self.coords.nrows()
    }

    /// Number of dimensions k.
    pub fn dim(&self) -> usize {
        self.coords.ncols()
    }

    /// Number of leading dimensions with a positive eigenvalue; the other columns are zero.
    pub fn positive_dims(&self) -> usize {
        self.eigenvalues.iter().take(self.dim()).filter(|value| **value > 0.0).count()
    }

    /// `Z = Q U √L` with the `dim` largest eigenpairs `U L U'` of `inner` and orthonormal columns `q`, in units of
    /// `unit`.
    pub(crate) fn from_factors(
        q: Matrix,
        inner: &Matrix,
        dim: usize,
        unit: f64,
        rank: usize,
    ) -> Result<Self, NmdsError> {
        let inner = symmetric_eigen(inner)?;
        let columns = q * inner.vectors.columns(0, dim.min(inner.values.len()));
        Ok(Self::from_orthonormal(columns.resize_horizontally(dim, 0.0), inner.values, unit, rank).0)
    }

    /// Scales orthonormal columns by the roots of their eigenvalues and normalizes their signs: with the factors that columns were
    /// multiplied by.
    pub(crate) fn from_orthonormal(
        mut columns: Matrix,
        eigenvalues: Vec<f64>,
        unit: f64,
        rank: usize,
    ) -> (Self, Vec<f64>) {
        let mut factors = Vec::with_capacity(columns.ncols());
        for (mut column, value) in columns.column_iter_mut().zip(&eigenvalues) {
            let factor = leading_sign(column.as_slice()) * (value.max(0.0).sqrt() * unit);
            column *= factor;
            factors.push(factor);
        }
        factors.resize(columns.ncols(), 0.0);
        let eigenvalues: Vec<f64> = eigenvalues.iter().map(|value| value * unit * unit).collect();
        let negative_mass = negative_mass(&eigenvalues);
        (Self { coords: columns, eigenvalues, negative_mass, rank }, factors)
    }

    /// Centers coordinates in units of `unit` and rotates them to their principal axes; `eigenvalues` become those of
    /// `Z' Z`. Distances between points do not change.
    pub(crate) fn along_principal_axes(
        mut coords: Matrix,
        unit: f64,
        rank: usize,
    ) -> Result<Self, NmdsError> {
        center_columns(&mut coords);
        let (q, w) = thin_qr(&coords);
        let axes = symmetric_eigen(&(&w * w.transpose()))?;
        let eigenvalues = axes.values.iter().map(|value| value.max(0.0)).collect();
        Ok(Self::from_orthonormal(q * axes.vectors, eigenvalues, unit, rank).0)
    }
}

/// Share of negative eigenvalues in the sum of magnitudes; zero if all are zero.
pub(crate) fn negative_mass(eigenvalues: &[f64]) -> f64 {
    let total: f64 = eigenvalues.iter().map(|value| value.abs()).sum();
    let negative: f64 = eigenvalues.iter().map(|value| (-value).max(0.0)).sum();
    if total > 0.0 { negative / total } else { 0.0 }
}
