//! Matrices of distances and the decompositions behind every embedding.
//!
//! `geodesics` -> **[`LandmarkDistances`], [`DistanceMatrix`]** -> `nmds`, `retrieval`
//!
//! The only crate that names a linear-algebra backend: public types are nalgebra's, the
//! decompositions of large matrices are faer's, run sequentially so that no result depends on
//! the number of threads. Sparse positive definite systems have a factor of their own,
//! [`SparseCholesky`], made once for many right-hand sides. Knows nothing of meshes.

mod cholesky;
mod decomposition;
mod distance_matrix;
mod error;
mod generalized;
mod krylov;
mod landmark_distances;
mod panels;
mod sparse;

pub use cholesky::{EliminationOrder, SparseCholesky};
pub use decomposition::{SymmetricEigen, pseudo_inverse, symmetric_eigen, thin_qr};
pub use distance_matrix::DistanceMatrix;
pub use error::LinalgError;
pub use generalized::{GeneralizedEigen, smallest_eigenpairs};
pub use krylov::{SymmetricOperator, largest_eigenpairs};
pub use landmark_distances::LandmarkDistances;
pub use sparse::SparseSymmetric;

/// A dense matrix of `f64`, column by column.
pub type Matrix = nalgebra::DMatrix<f64>;
