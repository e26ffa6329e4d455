//! Symmetric matrices that are given by their products.

use crate::Matrix;

/// An n x n matrix that is symmetric in the inner product `x' M y` of diagonal masses, given by its products with vectors.
pub trait SymmetricOperator: Sync + std::fmt::Debug {
    /// The order n of the matrix.
    fn order(&self) -> usize;

    /// Writes the product of the matrix with `x` into `y`; both have n entries.
    fn apply(&self, x: &[f64], y: &mut [f64]);

    /// The product of the matrix with all columns of another one.
    fn apply_to_columns(&self, columns: &Matrix) -> Matrix {
        let mut result = Matrix::zeros(columns.nrows(), columns.ncols());
        for (x, mut y) in columns.column_iter().zip(result.column_iter_mut()) {
            self.apply(x.as_slice(), y.as_mut_slice());
        }
        result
    }

    /// The diagonal of `M`; `None` if it is the identity.
    fn masses(&self) -> Option<&[f64]> {
        None
    }
}
