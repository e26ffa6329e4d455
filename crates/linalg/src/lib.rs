//! Distance matrices, and the decompositions behind every embedding.
//!
//! `geodesics` -> **[`LandmarkDistances`], [`DistanceMatrix`]** -> `nmds`, `retrieval`
//!
//! The only crate that names a linear-algebra backend. Public types are nalgebra's. Decompositions of dense matrices
//! are faer's, run sequentially so that results do not depend on the number of threads. [`SparseCholesky`] solves
//! sparse positive definite systems for many right-hand sides; [`smallest_eigenpairs`] and [`largest_eigenpairs`] find
//! a few eigenpairs of large ones, both by block Lanczos processes. Knows nothing of meshes.

mod cholesky;
mod column_store;
mod decomposition;
mod distance_matrix;
mod error;
mod generalized;
mod lanczos;
mod landmark_distances;
mod largest;
mod operator;
mod panels;
mod sparse;

pub use cholesky::{EliminationOrder, SparseCholesky};
pub use column_store::{ColumnSlot, ColumnStore};
pub use decomposition::{
    SymmetricEigen, leading_sign, pseudo_inverse, symmetric_eigen, symmetric_eigenvalues, thin_qr, thin_svd,
    triangular_factor,
};
pub use distance_matrix::DistanceMatrix;
pub use error::{LinalgError, NoFactor};
pub use generalized::smallest_eigenpairs;
pub use landmark_distances::LandmarkDistances;
pub use largest::largest_eigenpairs;
pub use operator::SymmetricOperator;
pub use sparse::SparseSymmetric;

/// A dense matrix of `f64`, column by column.
pub type Matrix = nalgebra::DMatrix<f64>;

/// The squared distance of two points, over the coordinates that both have.
pub fn sq_distance(a: &[f64], b: &[f64]) -> f64 {
    // Four sums, which vector instructions can take at once.
    let mut sums = [0.0; 4];
    let ((a, rest_a), (b, rest_b)) = (a.as_chunks::<4>(), b.as_chunks::<4>());
    for (a, b) in a.iter().zip(b) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum += (a - b) * (a - b);
        }
    }
    let rest: f64 = rest_a.iter().zip(rest_b).map(|(a, b)| (a - b) * (a - b)).sum();
    sums.iter().sum::<f64>() + rest
}
