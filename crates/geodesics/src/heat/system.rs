//! The two matrices and their factors.

use base::Budget;
use linalg::{EliminationOrder, LinalgError, SparseCholesky, SparseSymmetric};
use surface::VertexId;
use surface::laplacian::{Element, Laplacian};

use super::flow::HeatBar;
use crate::error::GeodesicError;

/// Shares of its diagonal added, one after the other, to a matrix that rounding keeps from being factorized.
const SHIFTS: [f64; 3] = [1e-12, 1e-9, 1e-6];

/// The factors of `M + t L` and of `L`, in the same order of elimination.
#[derive(Debug)]
pub(super) struct System {
    /// Of `M + t L`.
    pub(super) heat: SparseCholesky,
    /// Of `L`, grounded at one vertex in each component.
    pub(super) poisson: SparseCholesky,
}

impl System {
    /// Assembles and factorizes; `grounded` has one vertex of each component.
    ///
    /// The cotangent stiffness `L` maps constants to zero. Adding one to its diagonal at one vertex of each component
    /// makes it definite. As right-hand sides sum to zero over a component, this only makes the solution zero there.
    pub(super) fn new(
        laplacian: &Laplacian,
        bars: &[HeatBar],
        time: f64,
        grounded: &[VertexId],
        budget: &Budget,
    ) -> Result<Self, GeodesicError> {
        let (n, elements) = (laplacian.n_vertices, &laplacian.elements);
        let mut heat = stiffness(n, elements, time, bars.iter().map(|bar| (bar.ends, bar.heat())));
        heat.add_to_diagonal(laplacian.masses().into_iter());
        // A vertex without triangles and links has an equation of its own.
        let missing: Vec<f64> = heat.diagonal().iter().map(|d| if *d == 0.0 { 1.0 } else { 0.0 }).collect();
        heat.add_to_diagonal(missing.into_iter());
        let order = EliminationOrder::new(&heat, budget).map_err(failed)?;
        let heat = factorize(&order, heat, budget)?;

        let mut poisson =
            stiffness(n, elements, 1.0, bars.iter().map(|bar| (bar.ends, [bar.weight(), -bar.weight()])));
        let mut ground = vec![0.0; n];
        grounded.iter().for_each(|v| ground[v.index()] = 1.0);
        poisson.add_to_diagonal(ground.into_iter());
        Ok(Self { heat, poisson: factorize(&order, poisson, budget)? })
    }
}

/// `scale` times the stiffness of the triangles, and what each bar adds at and between its ends.
fn stiffness(
    n: usize,
    elements: &[Element],
    scale: f64,
    bars: impl Iterator<Item = ([u32; 2], [f64; 2])>,
) -> SparseSymmetric {
    let weights = elements.iter().flat_map(Element::weights);
    let triangles = weights.map(|(ends, weight)| (ends, [scale * weight, -scale * weight]));
    let entries = triangles.chain(bars).flat_map(|(ends, [at, between])| {
        let [i, j] = ends.map(|v| v as usize);
        [(i, i, at), (j, j, at), (i, j, between)]
    });
    SparseSymmetric::from_entries(n, entries)
}

/// The factor of a matrix, or of the matrix with as many of [`SHIFTS`] as it needs.
fn factorize(
    order: &EliminationOrder,
    mut matrix: SparseSymmetric,
    budget: &Budget,
) -> Result<SparseCholesky, GeodesicError> {
    let diagonal = matrix.diagonal();
    let mut shifts = SHIFTS.into_iter();
    loop {
        match (SparseCholesky::new(order, &matrix, budget).map_err(failed), shifts.next()) {
            (Err(GeodesicError::NotFactorized(_)), Some(shift)) => {
                matrix.add_to_diagonal(diagonal.iter().map(|d| shift * d));
            }
            (result, _) => return result,
        }
    }
}

fn failed(error: LinalgError) -> GeodesicError {
    match error {
        LinalgError::Exceeded(exceeded) => exceeded.into(),
        other => GeodesicError::NotFactorized(other),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_semidefinite_matrix_is_shifted_and_an_indefinite_one_rejected() {
        let matrix = |at| SparseSymmetric::from_entries(2, [(0, 0, at), (1, 1, at), (0, 1, -1.0)]);
        let order = EliminationOrder::new(&matrix(1.0), &()).unwrap();
        // Constants are mapped to zero; the shift makes the solution large and keeps its difference.
        let mut x = [1.0, -1.0];
        factorize(&order, matrix(1.0), &Budget::unlimited()).unwrap().solve(&mut x);
        assert!((x[0] - x[1] - 1.0).abs() < 1e-3, "{x:?}");
        let indefinite = factorize(&order, matrix(0.5), &Budget::unlimited());
        assert!(matches!(indefinite, Err(GeodesicError::NotFactorized(_))));
    }
}
