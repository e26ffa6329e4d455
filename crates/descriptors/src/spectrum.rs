//! The Laplace-Beltrami spectrum of a surface.

use base::Observer;
use linalg::{LinalgError, Matrix, SparseSymmetric, SymmetricEigen, smallest_eigenpairs};
use surface::IntrinsicMesh;
use surface::laplacian::{Element, Laplacian};

use crate::error::DescriptorError;

/// The smallest eigenpairs of the Laplace-Beltrami operator of a surface scaled to unit area, `W Φ = A Φ Λ`.
///
/// Invariant to scale and to isometries such as bending; hardly changes with the triangulation.
#[derive(Debug, Clone, PartialEq)]
pub struct LaplaceSpectrum {
    /// Eigenvalues, ascending from zero: those of the surface in its own unit, times its area.
    pub values: Vec<f64>,
    /// The eigenvalues without the leading error of linear elements, see [`new`](Self::new).
    pub corrected: Vec<f64>,
    /// Eigenfunctions at the vertices as columns: `Φ' A Φ = I`.
    pub vectors: Matrix,
    /// The diagonal of `A`: the share of the area around each vertex.
    pub masses: Vec<f64>,
    /// The area of the surface, in squared mesh units.
    pub area: f64,
}

impl LaplaceSpectrum {
    /// Number of eigenpairs that the signatures of a surface use. A convention.
    pub(crate) const DESCRIBING: usize = 60;

    /// The eigenpairs that the signatures of a surface use, as accurate as these need them.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn describing(mesh: &IntrinsicMesh, observer: &dyn Observer) -> Result<Self, DescriptorError> {
        Self::found(mesh, Self::DESCRIBING, SymmetricEigen::AVERAGED, observer)
    }

    /// The `m` smallest eigenpairs, including the constant function; fewer on a surface with fewer vertices.
    ///
    /// Cotangent stiffness on an intrinsic Delaunay triangulation, lumped masses: see
    /// [`Laplacian`] and [`smallest_eigenpairs`](linalg::smallest_eigenpairs). Cost: one sparse factorization.
    ///
    /// With edges of length `h`, lumped masses make an eigenvalue `λ` too small by about `λ h² / 16` of itself, and consistent
    /// masses too large by as much (exactly so on equilateral triangles). The corrected eigenvalues are the Rayleigh
    /// quotients of the eigenfunctions with the mean of both masses, where the errors cancel.
    ///
    /// # Errors
    /// [`DescriptorError::NoExtent`] for a surface without area; [`DescriptorError::Linalg`], also if the
    /// budget of the observer is exceeded.
    pub fn new(mesh: &IntrinsicMesh, m: usize, observer: &dyn Observer) -> Result<Self, DescriptorError> {
        Self::found(mesh, m, SymmetricEigen::ACCURATE, observer)
    }

    fn found(
        mesh: &IntrinsicMesh,
        m: usize,
        tolerance: f64,
        observer: &dyn Observer,
    ) -> Result<Self, DescriptorError> {
        observer.budget().check().map_err(LinalgError::from)?;
        let laplacian = Laplacian::new(mesh);
        let mut masses = laplacian.masses();
        let area: f64 = masses.iter().sum();
        if area <= 0.0 || laplacian.metric.unit <= 0.0 {
            return Err(DescriptorError::NoExtent { n_points: mesh.n_vertices() });
        }
        masses.iter_mut().for_each(|mass| *mass /= area);
        let stiffness = SparseSymmetric::from_entries(mesh.n_vertices(), laplacian.stiffness_entries());
        let SymmetricEigen { values, vectors } =
            smallest_eigenpairs(&stiffness, &masses, m, tolerance, observer)?;
        let corrected = corrected(&laplacian, area, &values, &vectors);
        Ok(Self { values, corrected, vectors, masses, area: area * laplacian.metric.unit.powi(2) })
    }
}

/// Rayleigh quotients with the mean of the lumped and the consistent mass. On a triangle of area `a`, the consistent
/// mass of a function is less by `a / 12` times the sum of its squared differences along the sides.
fn corrected(laplacian: &Laplacian, area: f64, values: &[f64], vectors: &Matrix) -> Vec<f64> {
    let of = |(j, value): (usize, &f64)| {
        let x = vectors.column(j);
        let missing = laplacian.elements.iter().map(|Element { vertices, triangle, share }| {
            let [a, b, c] = vertices.map(|v| x[v as usize]);
            share * triangle.area() * ((a - b).powi(2) + (b - c).powi(2) + (c - a).powi(2))
        });
        value / (1.0 - missing.sum::<f64>() / (24.0 * area))
    };
    values.iter().enumerate().map(of).collect()
}
