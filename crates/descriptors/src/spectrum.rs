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
    /// Number of eigenpairs that the signatures of a surface use.
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

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use mesh::{TriMesh, shapes};

    fn spectrum(mesh: &TriMesh, m: usize) -> LaplaceSpectrum {
        LaplaceSpectrum::new(&mesh.intrinsic(), m, &()).unwrap()
    }

    #[test]
    fn the_eigenvalues_of_a_sphere_are_l_times_l_plus_1_with_multiplicity_2_l_plus_1() {
        let mut previous = f64::INFINITY;
        for level in [3, 4] {
            let found = spectrum(&shapes::icosphere(level), 49);
            let expected = (0..7).flat_map(|l| vec![4.0 * PI * f64::from(l * (l + 1)); 2 * l as usize + 1]);
            let error = |(a, e): (&f64, f64)| if e > 0.0 { (a / e - 1.0).abs() } else { *a };
            let worst = found.values.iter().zip(expected.clone()).map(error).fold(0.0, f64::max);
            let corrected = found.corrected.iter().zip(expected).map(error).fold(0.0, f64::max);
            assert!(corrected < 0.25 * worst, "level {level}: {corrected}, uncorrected {worst}");
            assert!(worst < previous / 3.0, "level {level}: {worst} after {previous}");
            previous = worst;
        }
        assert!(previous < 0.02, "{previous}");
    }

    #[test]
    fn the_eigenvalues_of_a_rectangle_are_those_of_standing_waves() {
        // With free ends: pi^2 (a^2 / w^2 + b^2 / h^2), times the area w h.
        let (w, h) = (60, 40);
        let found = spectrum(&shapes::grid(w + 1, h + 1, 0.1), 30);
        let ratio = w as f64 / h as f64;
        let wave = |a: usize, b: usize| PI * PI * ((a * a) as f64 / ratio + (b * b) as f64 * ratio);
        let mut expected: Vec<f64> = (0..12).flat_map(|a| (0..12).map(move |b| wave(a, b))).collect();
        expected.sort_by(f64::total_cmp);
        for (j, (a, e)) in found.values.iter().zip(&expected).enumerate().skip(1) {
            assert!((a / e - 1.0).abs() < 0.02, "{j}: {a} against {e}");
        }
        assert!((found.area - 24.0).abs() < 1e-9 && (found.masses.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn every_component_adds_a_constant_function() {
        let parts = [shapes::icosphere(2), shapes::grid(9, 9, 0.2), shapes::torus(20, 9, 1.0, 0.3)];
        let found = spectrum(&shapes::disjoint(&parts), 12);
        assert!(found.values[2] < 1e-9 && found.values[3] > 0.1, "{:?}", found.values);
    }

    #[test]
    fn a_surface_without_area_has_no_spectrum() {
        let none = LaplaceSpectrum::new(&TriMesh::default().intrinsic(), 5, &());
        assert_eq!(none, Err(DescriptorError::NoExtent { n_points: 0 }));
    }
}
