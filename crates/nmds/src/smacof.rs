//! SMACOF: iterative minimisation of the metric stress.

use base::{Budget, Observer};
use linalg::{DistanceMatrix, Matrix, pseudo_inverse};
use rayon::prelude::*;

use crate::squares::{check_dim, check_extent, check_points};
use crate::{Embedding, NmdsError};

/// Options of [`smacof`].
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub struct SmacofOptions {
    /// Maximum number of steps. Default: 300.
    pub max_iterations: usize,
    /// Stops when a step lowers the raw stress by less than this share of it. Default: 1e-6.
    pub tolerance: f64,
}

impl Default for SmacofOptions {
    fn default() -> Self {
        Self { max_iterations: 300, tolerance: 1e-6 }
    }
}

/// What happened in a run of [`smacof`].
#[derive(Debug, Clone, PartialEq)]
pub struct SmacofReport {
    /// Kruskal's stress `sqrt(sum (d_ij - |x_i - x_j|)^2 / sum d_ij^2)` of the start and after each step; never increases.
    pub normalized_stress: Vec<f64>,
    /// Why it stopped.
    pub stop: SmacofStop,
}

impl SmacofReport {
    /// Number of steps that lowered the stress.
    #[must_use]
    pub fn iterations(&self) -> usize {
        self.normalized_stress.len() - 1
    }
}

/// Why [`smacof`] stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SmacofStop {
    /// The stress fell by less than the tolerance.
    Converged,
    /// The maximum number of steps was reached.
    IterationLimit,
}

/// SMACOF with equal weights: starts from the coordinates `start` (p x k) and minimises the raw stress
/// `sum (d_ij - |x_i - x_j|)^2`.
///
/// Each step is the Guttman transform `X <- B(X) X / p`, where `B_ij = -d_ij / |x_i - x_j|` (zero for coinciding points)
/// and the rows of `B` sum to zero. It minimises a quadratic majorant of the stress, so the stress never increases.
/// Every eighth step extrapolates from the previous ones instead (reduced rank extrapolation) and is rejected if it does
/// not lower the stress. On real shapes this takes a quarter of the steps.
///
/// * Finds a local minimum that depends on the start. Classical and Nystrom scaling are good starts. A dimension that is
///   zero in the start stays zero.
/// * Fits distances, whereas classical scaling fits their squares: the paper's stress of the result is larger than that of
///   classical scaling, and [`normalized_stress`](crate::normalized_stress) is smaller.
/// * The result is centred and rotated to its principal axes; `eigenvalues` are the k of `X' X`.
/// * Cost: `O(p^2 k)` per step; `O(p k)` memory besides the distances. Does not depend on the number of threads.
///
/// After de Leeuw 1977 and Rosman et al. 2008 (`deleeuw1977`, `rosman2008` in `REFERENCES.bib`).
///
/// # Errors
/// [`NmdsError::PointMismatch`], [`NmdsError::BadDimension`], [`NmdsError::BadTolerance`],
/// [`NmdsError::NoExtent`]; [`NmdsError::Linalg`] if a coordinate is not finite; [`NmdsError::Exceeded`] if the budget of
/// the observer is, which is checked before every row of a step.
///
/// ```
/// # extern crate linalg as canonform_linalg;
/// use canonform_linalg::DistanceMatrix;
/// use canonform_nmds::{SmacofOptions, classical, smacof};
///
/// // Distances along the arcs of a circle do not fit into the plane.
/// let distances = DistanceMatrix::from_pairs(12, |i, j| (j - i).min(12 - (j - i)) as f64)?;
/// let start = classical(&distances, 2, &())?.coords;
/// let (_, report) = smacof(&start, &distances, &SmacofOptions::default(), &())?;
/// assert!(report.normalized_stress[report.iterations()] <= report.normalized_stress[0]);
/// # Ok::<(), canonform_nmds::NmdsError>(())
/// ```
pub fn smacof(
    start: &Matrix,
    distances: &DistanceMatrix,
    options: &SmacofOptions,
    observer: &dyn Observer,
) -> Result<(Embedding, SmacofReport), NmdsError> {
    let budget = &observer.budget();
    let (p, dim) = start.shape();
    check_points(p, distances.n_points())?;
    check_dim(dim, p)?;
    let tolerance = options.tolerance;
    if !(tolerance >= 0.0 && tolerance.is_finite()) {
        return Err(NmdsError::BadTolerance(tolerance));
    }
    // A power of two: dividing by it is exact.
    let unit = 2f64.powi(check_extent(distances.max(), p)?.log2().floor() as i32);
    let target = SmacofTarget { distances, inverse_unit: 1.0 / unit, budget };
    let total: f64 = distances.as_slice().iter().map(|d| (d * target.inverse_unit).powi(2)).sum();

    let mut state = SmacofState::new(start / unit, &target)?;
    let mut normalized_stress = vec![(state.stress / total).sqrt()];
    let mut stop = SmacofStop::IterationLimit;
    let mut history = vec![state.x.clone()];
    for _ in 0..options.max_iterations {
        if history.len() == CYCLE {
            let extrapolated = SmacofState::new(extrapolate(&history)?, &target)?;
            history.clear();
            if extrapolated.stress < state.stress {
                state = extrapolated;
                normalized_stress.push((state.stress / total).sqrt());
            }
            history.push(state.x.clone());
            continue;
        }
        let (lower, after) = target.guttman(&state.next)?;
        let gain = state.stress - lower;
        let settled = gain <= tolerance * state.stress;
        // Rounding may increase it slightly.
        if gain > 0.0 {
            normalized_stress.push((lower / total).sqrt());
            state = SmacofState { x: state.next, stress: lower, next: after };
            history.push(state.x.clone());
        }
        if settled {
            stop = SmacofStop::Converged;
            break;
        }
    }
    let report = SmacofReport { normalized_stress, stop };
    Ok((Embedding::along_principal_axes(state.x, unit, dim)?, report))
}

/// The distances to fit, in a unit near the largest.
struct SmacofTarget<'a> {
    distances: &'a DistanceMatrix,
    inverse_unit: f64,
    budget: &'a Budget,
}

impl SmacofTarget<'_> {
    /// The raw stress of `x` (each pair counted twice) and its Guttman transform.
    fn guttman(&self, x: &Matrix) -> Result<(f64, Matrix), NmdsError> {
        let (p, dim) = x.shape();
        let mut moved = vec![0.0; p * dim];
        let stresses = moved
            .par_chunks_mut(dim)
            .enumerate()
            .map_init(
                || vec![0.0; p],
                |ratios, (i, moved)| {
                    self.budget.check()?;
                    let stress = ratios_of_row(x, self.distances.row(i), self.inverse_unit, i, ratios);
                    for (moved, column) in moved.iter_mut().zip(x.column_iter()) {
                        *moved = pull(ratios, column.as_slice(), column[i]) / p as f64;
                    }
                    Ok(stress)
                },
            )
            .collect::<Result<Vec<f64>, NmdsError>>()?;
        Ok((stresses.iter().sum(), Matrix::from_row_slice(p, dim, &moved)))
    }
}

/// Coordinates in that unit, their raw stress (each pair counted twice) and their Guttman transform.
struct SmacofState {
    x: Matrix,
    stress: f64,
    next: Matrix,
}

impl SmacofState {
    fn new(x: Matrix, target: &SmacofTarget<'_>) -> Result<Self, NmdsError> {
        let (stress, next) = target.guttman(&x)?;
        Ok(Self { x, stress, next })
    }
}

/// Number of iterates to extrapolate from. More make extrapolations better but rarer.
const CYCLE: usize = 8;

/// Reduced rank extrapolation: the weighted average of the iterates, with weights that sum to one, for which the
/// weighted sum of their steps is smallest.
fn extrapolate(iterates: &[Matrix]) -> Result<Matrix, NmdsError> {
    let steps: Vec<Matrix> = iterates.windows(2).map(|pair| &pair[1] - &pair[0]).collect();
    let gram = Matrix::from_fn(steps.len(), steps.len(), |i, j| steps[i].dot(&steps[j]));
    let weights = pseudo_inverse(&gram)? * Matrix::from_element(steps.len(), 1, 1.0);
    let total = weights.sum();
    let mut average = Matrix::zeros(iterates[0].nrows(), iterates[0].ncols());
    for (weight, iterate) in weights.iter().zip(iterates) {
        average += iterate * (weight / total);
    }
    Ok(average)
}

/// Partial sums of a row, so that the loops are not one chain of additions.
const LANES: usize = 4;

/// Writes `d_ij / |x_i - x_j|` (zero for coinciding points) for all `j`. Returns the sum of the squared differences
/// `d_ij - |x_i - x_j|`. Distances are multiplied by `inverse_unit`.
fn ratios_of_row(x: &Matrix, row: &[f64], inverse_unit: f64, i: usize, ratios: &mut [f64]) -> f64 {
    ratios.fill(0.0);
    for column in x.column_iter() {
        let at = column[i];
        for (sq, x) in ratios.iter_mut().zip(column.as_slice()) {
            *sq += (x - at) * (x - at);
        }
    }
    let mut sums = [0.0; LANES];
    let one = |sum: &mut f64, ratio: &mut f64, d: &f64| {
        let (d, length) = (d * inverse_unit, ratio.sqrt());
        *sum += (d - length) * (d - length);
        *ratio = if length > 0.0 { d / length } else { 0.0 };
    };
    let (mut ratios, mut row) = (ratios.chunks_exact_mut(LANES), row.chunks_exact(LANES));
    for (ratios, row) in (&mut ratios).zip(&mut row) {
        sums.iter_mut().zip(ratios).zip(row).for_each(|((sum, ratio), d)| one(sum, ratio, d));
    }
    let tail = ratios.into_remainder().iter_mut().zip(row.remainder());
    sums.iter_mut().zip(tail).for_each(|(sum, (ratio, d))| one(sum, ratio, d));
    sums.iter().sum()
}

/// The sum of `r_j (at - x_j)`.
fn pull(ratios: &[f64], column: &[f64], at: f64) -> f64 {
    let mut sums = [0.0; LANES];
    let (ratios, column) = (ratios.chunks_exact(LANES), column.chunks_exact(LANES));
    let tail = ratios.remainder().iter().zip(column.remainder());
    sums.iter_mut().zip(tail).for_each(|(sum, (r, x))| *sum += r * (at - x));
    for (ratios, column) in ratios.zip(column) {
        sums.iter_mut().zip(ratios).zip(column).for_each(|((sum, r), x)| *sum += r * (at - x));
    }
    sums.iter().sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::support::{Cloud, procrustes_free_gap};
    use crate::{classical, normalized_stress};

    /// Distances of a cloud raised to a power, and their classical scaling.
    fn problem(p: usize, power: f64) -> (DistanceMatrix, Matrix) {
        let cloud = Cloud::new(p, 4, 51);
        let distances = DistanceMatrix::from_pairs(p, |i, j| cloud.distance(i, j).powf(power)).unwrap();
        let start = classical(&distances, 3, &()).unwrap().coords;
        (distances, start)
    }

    #[test]
    fn the_stress_never_increases_and_is_that_of_the_coordinates() {
        let (distances, start) = problem(120, 0.7);
        for tolerance in [0.0, 1e-5] {
            let options = SmacofOptions { tolerance, ..Default::default() };
            let (embedding, report) = smacof(&start, &distances, &options, &()).unwrap();
            let stress = &report.normalized_stress;
            assert!(stress.windows(2).all(|pair| pair[1] < pair[0]), "{stress:?}");
            assert!((stress[0] / normalized_stress(&start, &distances) - 1.0).abs() < 1e-9);
            let last = stress[report.iterations()];
            assert!((last / normalized_stress(&embedding.coords, &distances) - 1.0).abs() < 1e-9);
            assert!(last < 0.9 * stress[0]);
        }
    }

    #[test]
    fn an_exact_start_stays_and_a_perturbed_one_returns() {
        let cloud = Cloud::new(90, 3, 52);
        let distances = DistanceMatrix::from_pairs(90, |i, j| cloud.distance(i, j)).unwrap();
        let start = classical(&distances, 3, &()).unwrap();
        let (embedding, report) = smacof(&start.coords, &distances, &SmacofOptions::default(), &()).unwrap();
        assert!(procrustes_free_gap(&cloud, &embedding) < 1e-9);
        assert_eq!(report.stop, SmacofStop::Converged);
        let perturbed = start.coords.map_with_location(|i, j, x| x + 0.5 * ((7 * i + 3 * j) as f64).sin());
        let options = SmacofOptions { tolerance: 0.0, max_iterations: 2000 };
        let (embedding, _) = smacof(&perturbed, &distances, &options, &()).unwrap();
        assert!(procrustes_free_gap(&cloud, &embedding) < 1e-6);
    }

    #[test]
    fn a_step_is_the_guttman_transform() {
        let (distances, start) = problem(30, 0.7);
        let p = 30;
        let mut b = Matrix::from_fn(p, p, |i, j| {
            if i == j { 0.0 } else { -distances.get(i, j) / (start.row(i) - start.row(j)).norm() }
        });
        for i in 0..p {
            b[(i, i)] = -b.row(i).sum();
        }
        let expected = b * &start / p as f64;
        let (stress, moved) =
            SmacofTarget { distances: &distances, inverse_unit: 1.0, budget: &Budget::unlimited() }
                .guttman(&start)
                .unwrap();
        assert!((moved - &expected).amax() < 1e-12);
        let total: f64 = distances.as_slice().iter().map(|d| d * d).sum();
        assert!(((stress / total).sqrt() / normalized_stress(&start, &distances) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_iteration_limit_and_the_tolerance_stop_it() {
        let (distances, start) = problem(80, 0.7);
        let run = |max_iterations, tolerance| {
            smacof(&start, &distances, &SmacofOptions { max_iterations, tolerance }, &()).unwrap().1
        };
        let cut = run(5, 0.0);
        assert_eq!((cut.iterations(), cut.stop), (5, SmacofStop::IterationLimit));
        let none = run(0, 0.0);
        assert_eq!((none.iterations(), none.stop), (0, SmacofStop::IterationLimit));
        let (rough, fine) = (run(10_000, 1e-3), run(10_000, 1e-7));
        assert_eq!([rough.stop, fine.stop], [SmacofStop::Converged; 2]);
        assert!(rough.iterations() < fine.iterations());
    }

    #[test]
    fn coinciding_points_and_empty_dimensions_give_finite_coordinates() {
        let (distances, mut start) = problem(40, 0.7);
        let row = start.row(0).into_owned();
        start.row_mut(1).copy_from(&row);
        start.column_mut(2).fill(0.0);
        let (embedding, _) = smacof(&start, &distances, &SmacofOptions::default(), &()).unwrap();
        assert!(embedding.coords.iter().all(|x| x.is_finite()));
        assert!(embedding.coords.column(2).amax() < 1e-9);
    }

    #[test]
    fn mismatched_arguments_are_rejected() {
        let (distances, start) = problem(20, 1.0);
        let error = |start: &Matrix, tolerance| {
            smacof(start, &distances, &SmacofOptions { tolerance, ..Default::default() }, &()).unwrap_err()
        };
        let short = start.rows(0, 19).into_owned();
        assert_eq!(error(&short, 1e-5), NmdsError::PointMismatch { given: 19, n_points: 20 });
        let flat = Matrix::zeros(20, 0);
        assert_eq!(error(&flat, 1e-5), NmdsError::BadDimension { dim: 0, limit: 20 });
        assert_eq!(error(&start, -1.0), NmdsError::BadTolerance(-1.0));
    }
}
