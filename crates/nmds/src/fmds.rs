//! Fast multidimensional scaling.

use base::{Budget, Observer};
use linalg::{EliminationOrder, LandmarkDistances, Matrix, SparseCholesky, SparseSymmetric, thin_qr};

use crate::squares::{Squares, center_columns, check_dim, check_points, solve_saddle_point, symmetrized};
use crate::{Embedding, NmdsError};

/// Fast multidimensional scaling (FMDS): embeds p points from n columns of distances, interpolated by the smoothest
/// functions on the surface.
///
/// | paper | here | shape | meaning |
/// |---|---|---|---|
/// | `W`, `A` | `stiffness`, `masses` | p x p, p | Laplacian: `A^-1 W`, `A` diagonal |
/// | `R` | | p x n | squared distances to the samples |
/// | `M` | | p x n | column j minimises `x' W A^-1 W x` among functions that are one at sample j, zero at the others |
/// | `Ê` | `(M R' + R M') / 2` | p x p | interpolated squared distances |
///
/// `Z = Q U √L` with the `k` algebraically largest eigenpairs `U L U'` of `-1/4 T P T'`, `Q T = J [M R]` and
/// `P = [0 I; I 0]` (Shamai, Aflalo, Zibulevsky and Kimmel 2015, `shamai2015b` in `REFERENCES.bib`).
///
/// * Exact at the samples: their columns of `Ê` are the given ones if the distances are symmetric.
/// * Independent of the unit of length.
/// * Cost: one sparse factorisation of `W` and `2 n` solutions; in addition `O(p n^2)` time and `O(p n)` memory.
///
/// **Deviation**: the values at the samples are hard constraints, so there is no weight to choose. `M` is computed by
/// splines, `M = H C + 1 d'` with `H = W^+ A W^+` at the samples and `1' C = 0`. This equals `-(L_ff)^-1 L_fs` with
/// `L = W A^-1 W` but does not square the condition number of `W`.
///
/// The budget of the observer is checked around the factorisation and the solutions, not within them.
///
/// # Errors
/// [`NmdsError::PointMismatch`], [`NmdsError::NotDetermined`] if a component of the surface has no sample,
/// [`NmdsError::BadDimension`], [`NmdsError::NoExtent`], [`NmdsError::Linalg`], [`NmdsError::Exceeded`].
pub fn fmds(
    distances: &LandmarkDistances,
    stiffness: &SparseSymmetric,
    masses: &[f64],
    dim: usize,
    observer: &dyn Observer,
) -> Result<Embedding, NmdsError> {
    let budget = &observer.budget();
    let (p, n) = (distances.n_points(), distances.n_landmarks());
    check_points(stiffness.order(), p)?;
    check_points(masses.len(), p)?;
    check_dim(dim, n)?;
    let Squares { unit, columns, .. } = Squares::new(distances)?;
    let interpolant = interpolant(distances.landmarks(), stiffness, masses, budget)?;
    budget.check()?;
    let mut both = Matrix::zeros(p, 2 * n);
    both.columns_mut(0, n).copy_from(&interpolant);
    both.columns_mut(n, n).copy_from(&columns);
    center_columns(&mut both);
    let (q, t) = thin_qr(&both);
    let inner = symmetrized(t.columns(0, n) * t.columns(n, n).transpose() * -0.5);
    Embedding::from_factors(q, &inner, dim, unit, n)
}

/// Computes `M` by splines.
fn interpolant(
    samples: &[usize],
    stiffness: &SparseSymmetric,
    masses: &[f64],
    budget: &Budget,
) -> Result<Matrix, NmdsError> {
    let (p, n) = (masses.len(), samples.len());
    let blocks = StiffnessBlocks::new(stiffness, masses);
    let matrix = blocks.grounded(stiffness);
    let order = EliminationOrder::new(&matrix, budget)?;
    let factor = SparseCholesky::new(&order, &matrix, budget)?;
    let green = |mut b: Matrix| {
        factor.solve_columns(&mut b);
        blocks.subtract_means(&mut b);
        b
    };
    let mut unit = Matrix::zeros(p, n);
    for (j, &sample) in samples.iter().enumerate() {
        unit[(sample, j)] = 1.0;
        // The system is solvable if its right-hand side sums to zero in each block.
        let block = blocks.of[sample];
        let share = if blocks.mass[block] > 0.0 { 1.0 / blocks.mass[block] } else { 0.0 };
        (0..p).filter(|&i| blocks.of[i] == block).for_each(|i| unit[(i, j)] -= share * masses[i]);
    }
    let mut weighted = green(unit);
    budget.check()?;
    weighted.row_iter_mut().zip(masses).for_each(|(mut row, mass)| row *= *mass);
    let splines = green(weighted);
    budget.check()?;

    let count = blocks.mass.len();
    let constants = |rows: &[usize]| {
        Matrix::from_fn(rows.len(), count, |i, k| if blocks.of[rows[i]] == k { 1.0 } else { 0.0 })
    };
    let at_samples = splines.select_rows(samples);
    // Scales the constants to the size of the splines, so that pivots are comparable.
    let size = at_samples.amax().max(f64::MIN_POSITIVE);
    let solution = solve_saddle_point(&symmetrized(at_samples), &(constants(samples) * size));
    let [weights, shifts] = solution.ok_or(NmdsError::NotDetermined(n))?;
    let everywhere: Vec<usize> = (0..p).collect();
    let mut m = splines * weights + constants(&everywhere) * shifts * size;
    for (j, &sample) in samples.iter().enumerate() {
        m.row_mut(sample).fill(0.0);
        m[(sample, j)] = 1.0;
    }
    Ok(m)
}

/// The connected blocks of a stiffness matrix, whose kernel are the functions that are constant on each.
#[derive(Debug)]
struct StiffnessBlocks<'a> {
    /// The block of each row.
    of: Vec<usize>,
    /// The mass of each block.
    mass: Vec<f64>,
    masses: &'a [f64],
}

impl<'a> StiffnessBlocks<'a> {
    fn new(stiffness: &SparseSymmetric, masses: &'a [f64]) -> Self {
        let of = stiffness.blocks();
        let mut mass = vec![0.0; of.iter().max().map_or(0, |last| last + 1)];
        of.iter().zip(masses).for_each(|(&block, m)| mass[block] += m);
        Self { of, mass, masses }
    }

    /// The matrix with the first diagonal entry of each block doubled: positive definite, with the same solutions up to
    /// a constant per block.
    fn grounded(&self, stiffness: &SparseSymmetric) -> SparseSymmetric {
        let mut ground = vec![0.0; self.of.len()];
        let mut next = 0;
        for (row, (block, value)) in self.of.iter().zip(stiffness.diagonal()).enumerate() {
            // Blocks are numbered in the order of their first rows.
            if *block == next {
                ground[row] = if value > 0.0 { value } else { 1.0 };
                next += 1;
            }
        }
        let mut matrix = stiffness.clone();
        matrix.add_to_diagonal(ground.into_iter());
        matrix
    }

    /// Subtracts from each column its mass-weighted mean over each block.
    fn subtract_means(&self, columns: &mut Matrix) {
        for mut column in columns.column_iter_mut() {
            let mut sums = vec![0.0; self.mass.len()];
            for ((x, m), &block) in column.iter().zip(self.masses).zip(&self.of) {
                sums[block] += m * x;
            }
            for (x, &block) in column.iter_mut().zip(&self.of) {
                *x -= if self.mass[block] > 0.0 { sums[block] / self.mass[block] } else { 0.0 };
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Irregular points on the unit circle: the stiffness of a spring is the inverse of its length, masses are arc
    /// lengths, and distances are measured along the circle.
    struct Ring {
        angles: Vec<f64>,
    }

    impl Ring {
        fn new(p: usize) -> Self {
            let step = std::f64::consts::TAU / p as f64;
            Self { angles: (0..p).map(|i| step * (i as f64 + 0.3 * (i as f64 * 1.7).sin())).collect() }
        }

        fn arc(&self, i: usize, j: usize) -> f64 {
            let arc = (self.angles[i] - self.angles[j]).abs();
            arc.min(std::f64::consts::TAU - arc)
        }

        fn laplacian(&self, scale: f64) -> (SparseSymmetric, Vec<f64>) {
            let p = self.angles.len();
            let mut masses = vec![0.0; p];
            let mut entries = Vec::new();
            for i in 0..p {
                let next = (i + 1) % p;
                let length = scale * self.arc(i, next);
                masses[i] += length / 2.0;
                masses[next] += length / 2.0;
                let w = 1.0 / length;
                entries.extend([(i, i, w), (next, next, w), (i, next, -w)]);
            }
            (SparseSymmetric::from_entries(p, entries), masses)
        }

        fn columns(&self, step: usize, distance: impl Fn(f64) -> f64) -> LandmarkDistances {
            let p = self.angles.len();
            let samples: Vec<usize> = (0..p).step_by(step).collect();
            let columns = Matrix::from_fn(p, samples.len(), |i, j| distance(self.arc(i, samples[j])));
            LandmarkDistances::new(samples, columns).unwrap()
        }
    }

    #[test]
    fn the_interpolant_satisfies_its_definition() {
        let ring = Ring::new(40);
        let (w, a) = ring.laplacian(1.0);
        let samples = [0, 7, 13, 22, 31];
        let found = interpolant(&samples, &w, &a, &Budget::unlimited()).unwrap();
        let mut dense = Matrix::zeros(40, 40);
        for (i, j, value) in w.entries() {
            dense[(i, j)] = value;
            dense[(j, i)] = value;
        }
        let inverse = Matrix::from_diagonal(&a.iter().map(|m| 1.0 / m).collect::<Vec<_>>().into());
        let l = &dense * inverse * &dense;
        let free: Vec<usize> = (0..40).filter(|i| !samples.contains(i)).collect();
        let l_ff = l.select_rows(&free).select_columns(&free);
        let l_fs = l.select_rows(&free).select_columns(&samples);
        let expected = -l_ff.lu().solve(&l_fs).unwrap();
        assert!((found.select_rows(&free) - expected).amax() < 1e-8);
        assert_eq!(found.select_rows(&samples), Matrix::identity(5, 5));
    }

    #[test]
    fn interpolation_preserves_constants_on_each_component() {
        let ring = Ring::new(30);
        let (w, a) = ring.laplacian(1.0);
        let twice = w.entries().chain(w.entries().map(|(i, j, v)| (i + 30, j + 30, v)));
        let w = SparseSymmetric::from_entries(60, twice.collect::<Vec<_>>());
        let a = [a.clone(), a].concat();
        let found = interpolant(&[3, 20, 41], &w, &a, &Budget::unlimited()).unwrap();
        for i in 0..60 {
            let own = if i < 30 { found[(i, 0)] + found[(i, 1)] } else { found[(i, 2)] };
            assert!((own - 1.0).abs() < 1e-10 && (found.row(i).sum() - 1.0).abs() < 1e-10);
        }
        assert_eq!(
            interpolant(&[3, 20], &w, &a, &Budget::unlimited()).map(|_| ()),
            Err(NmdsError::NotDetermined(2))
        );
    }

    #[test]
    fn a_circle_is_recovered_from_chords_with_fourth_order() {
        let ring = Ring::new(160);
        let (w, a) = ring.laplacian(1.0);
        let chord = |arc: f64| 2.0 * (0.5 * arc).sin();
        let worst = |step: usize| {
            let found = fmds(&ring.columns(step, chord), &w, &a, 2, &()).unwrap();
            let pairs = (0..160).flat_map(|i| (0..i).map(move |j| (i, j)));
            let error = |(i, j): (usize, usize)| {
                ((found.coords.row(i) - found.coords.row(j)).norm() - chord(ring.arc(i, j))).abs()
            };
            pairs.map(error).fold(0.0, f64::max)
        };
        // Splines converge with fourth order.
        assert!(worst(20) < 0.01 && worst(10) < worst(20) / 8.0, "{} {}", worst(20), worst(10));
    }

    #[test]
    fn other_numbers_of_points_are_rejected() {
        let ring = Ring::new(12);
        let (w, a) = ring.laplacian(1.0);
        let distances = ring.columns(3, |d| d);
        let result = fmds(&distances, &w, &a[1..], 2, &());
        assert_eq!(result, Err(NmdsError::PointMismatch { given: 11, n_points: 12 }));
    }
}
