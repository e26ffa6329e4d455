//! Symmetric matrices that are given by their products.

use crate::Matrix;

/// An n x n matrix that is symmetric in the inner product `x' M y` of diagonal masses, given by its products.
pub trait SymmetricOperator: Sync + std::fmt::Debug {
    /// The order n of the matrix.
    fn order(&self) -> usize;

    /// The product of the matrix with another one, of n rows.
    fn apply(&self, columns: &Matrix) -> Matrix;

    /// The diagonal of `M`; `None` if it is the identity.
    fn masses(&self) -> Option<&[f64]> {
        None
    }
}
