//! SMACOF: iterative minimization of the metric stress.

use base::{Budget, Observer};
use linalg::{Matrix, pseudo_inverse};
use rayon::prelude::*;

use crate::squares::{check_dim, check_extent, check_points, unit_near};
use crate::{DistanceRows, Embedding, NmdsError};

/// Options of [`smacof`].
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub struct SmacofOptions {
    /// Maximum number of steps. Default: 300.
    pub max_iterations: usize,
    /// Stops when a step lowers the raw stress by less than this share of it. 0 takes plain steps, without extrapolation, while
    /// they lower it. Default: 1e-6.
    pub tolerance: f64,
}

impl Default for SmacofOptions {
    fn default() -> Self {
        Self { max_iterations: 300, tolerance: 1e-6 }
    }
}

/// The distances that [`smacof`] fits, and how much they count.
#[derive(Clone, Copy)]
pub struct LandmarkPairs<'a> {
    /// n of the p points: their distances to all points are fitted. All points, for the distances of all pairs.
    pub landmarks: &'a [usize],
    /// The distances, of which the rows of landmarks are needed.
    pub rows: &'a dyn DistanceRows,
    /// The masses of the points.
    pub masses: &'a [f64],
    /// Weights of pairs are this power of the inverse distance: 0 weighs all alike, 1 is Sammon's mapping.
    pub power: f64,
}

/// What happened in a run of [`smacof`].
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct SmacofReport {
    /// Number of steps that lowered the stress.
    pub iterations: usize,
    /// Why it stopped.
    pub stop: SmacofStop,
    /// The stress relative to that of coinciding points, `sqrt(sum m_i w_is (d_is - |x_i - x_s|)^2 / sum m_i w_is d_is^2)`, of the
    /// start and after each step; never increases. It is Kruskal's stress for all pairs and equal masses.
    pub normalized_stress: Vec<f64>,
}

/// Why [`smacof`] stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum SmacofStop {
    /// The stress fell by less than the tolerance.
    Converged,
    /// The maximum number of steps was reached.
    IterationLimit,
}

/// SMACOF: starts from the coordinates `start` (p x k) and lowers the raw stress `sum m_i w_is (d_is - |x_i - x_s|)^2` over all
/// points `i` and landmarks `s`, with the masses `m` of the points and the weights `w = d^-power`.
///
/// Each step moves every other point to the minimum of a majorant of its own share of the stress,
/// `x_i <- sum_s w_is (x_s + d_is u_is) / sum_s w_is` with `u_is` the unit vector from `x_s` to `x_i`, and then every landmark
/// in turn by all points. If all points are landmarks and all pairs count alike, all points move at once (the Guttman transform).
/// So the stress never increases. With a tolerance, every eighth step extrapolates from the previous ones
/// instead (reduced rank extrapolation) and is rejected if it does not lower the stress. On real shapes this takes a quarter of the
/// steps.
///
/// * Finds a local minimum that depends on the start. Classical and Nystrom scaling are good starts. A dimension that is
///   zero in the start stays zero.
/// * Fits distances, whereas classical and Nystrom scaling fit their squares: the paper's stress of the result is larger than
///   that of classical scaling, the [normalized](crate::Stress::normalized) one is smaller, and small features count more.
/// * Landmarks that are spread evenly serve nearly as well as all pairs.
/// * The result is centered and rotated to its principal axes; `eigenvalues` are the k of `X' X`.
/// * Cost: `O(p n k)` per step; `O(p k)` memory besides the distances. Does not depend on the number of threads.
///
/// After de Leeuw 1977, Sammon 1969 and Rosman et al. 2008 (`deleeuw1977`, `sammon1969`, `rosman2008` in `REFERENCES.bib`).
///
/// # Errors
/// [`NmdsError::PointMismatch`] unless there is a row and a mass for each point, [`NmdsError::BadDimension`],
/// [`NmdsError::BadTolerance`], [`NmdsError::NoExtent`]; [`NmdsError::Linalg`] if a coordinate is not finite;
/// [`NmdsError::Exceeded`] if the budget of the observer is, which is checked before every row of a step.
///
/// ```
/// # extern crate linalg as canonform_linalg;
/// use canonform_linalg::DistanceMatrix;
/// use canonform_nmds::{LandmarkPairs, SmacofOptions, classical, smacof};
///
/// // Distances along the arcs of a circle do not fit into the plane.
/// let distances = DistanceMatrix::from_pairs(12, |i, j| (j - i).min(12 - (j - i)) as f64)?;
/// let start = classical(&distances, 2, &())?.coords;
/// let landmarks: Vec<usize> = (0..12).collect();
/// let all = LandmarkPairs { landmarks: &landmarks, rows: &distances, masses: &[1.0; 12], power: 0.0 };
/// let (_, report) = smacof(&start, &all, &SmacofOptions::default(), &())?;
/// assert!(report.normalized_stress[report.iterations] <= report.normalized_stress[0]);
/// # Ok::<(), canonform_nmds::NmdsError>(())
/// ```
pub fn smacof(
    start: &Matrix,
    pairs: &LandmarkPairs<'_>,
    options: &SmacofOptions,
    observer: &dyn Observer,
) -> Result<(Embedding, SmacofReport), NmdsError> {
    let (p, dim) = start.shape();
    check_points(p, pairs.rows.n_points())?;
    check_points(pairs.masses.len(), p)?;
    check_dim(dim, p)?;
    let tolerance = options.tolerance;
    if !(tolerance >= 0.0 && tolerance.is_finite()) {
        return Err(NmdsError::BadTolerance(tolerance));
    }
    let fit = Fit::new(pairs, observer.budget())?;
    let mut x = start / fit.unit;
    let (mut stress, mut next) = fit.around(&x)?;
    let (mut stop, mut normalized_stress) = (SmacofStop::IterationLimit, vec![stress.sqrt()]);
    let mut history = vec![x.clone()];
    for _ in 0..options.max_iterations {
        let extrapolates = tolerance > 0.0 && history.len() == CYCLE;
        let moved = match &next {
            _ if extrapolates => extrapolated(&history)?,
            Some(next) => next.clone(),
            None => fit.step(&x)?,
        };
        let (lower, after) = fit.around(&moved)?;
        let settled = !extrapolates && stress - lower <= tolerance * stress;
        // Rounding may increase it slightly.
        if lower < stress {
            (x, stress, next) = (moved, lower, after);
            normalized_stress.push(stress.sqrt());
        }
        if settled {
            stop = SmacofStop::Converged;
            break;
        }
        if extrapolates {
            history.clear();
        }
        history.push(x.clone());
    }
    let report = SmacofReport { iterations: normalized_stress.len() - 1, stop, normalized_stress };
    Ok((Embedding::along_principal_axes(x, fit.unit, dim)?, report))
}

/// Number of iterates to extrapolate from. More make extrapolations better but rarer.
const CYCLE: usize = 8;

/// Reduced rank extrapolation: the weighted average of the iterates, with weights that sum to one, for which the
/// weighted sum of their steps is smallest.
fn extrapolated(iterates: &[Matrix]) -> Result<Matrix, NmdsError> {
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

/// Distances in a unit near the largest, which have to be fitted.
struct Fit<'a> {
    pairs: &'a LandmarkPairs<'a>,
    budget: Budget,
    /// A power of two: dividing by it is exact.
    unit: f64,
    /// 1 for a landmark, 0 for another point.
    is_landmark: Vec<f64>,
    /// Whether all pairs of points are given, with equal weights.
    is_uniform: bool,
    /// The raw stress of coinciding points.
    total: f64,
}

/// The pairs of one landmark.
struct LandmarkRow {
    distances: Vec<f64>,
    /// Zero for a distance of zero, unless all pairs count alike.
    weights: Matrix,
    lengths: Vec<f64>,
    /// How strongly points are pushed apart, `w d / |x - x_s|`: zero for points that coincide.
    pushes: Vec<f64>,
}

impl<'a> Fit<'a> {
    fn new(pairs: &'a LandmarkPairs<'a>, budget: Budget) -> Result<Self, NmdsError> {
        let mut is_landmark = vec![0.0; pairs.masses.len()];
        pairs.landmarks.iter().for_each(|&landmark| is_landmark[landmark] = 1.0);
        let is_uniform = pairs.power == 0.0
            && is_landmark.iter().all(|is| *is == 1.0)
            && pairs.masses.windows(2).all(|pair| pair[0] == pair[1]);
        let mut fit = Self { pairs, budget, unit: 1.0, is_landmark, is_uniform, total: 1.0 };
        let largest = |row: &mut LandmarkRow, _| row.distances.iter().copied().fold(0.0, f64::max);
        let origin = Matrix::zeros(pairs.masses.len(), 1);
        let largest = fit.of_rows(&origin, largest)?.into_iter().fold(0.0, f64::max);
        fit.unit = unit_near(check_extent(largest, pairs.masses.len())?);
        fit.total = fit.around(&origin)?.0;
        Ok(fit)
    }

    fn new_row(&self) -> LandmarkRow {
        let p = self.pairs.masses.len();
        let [distances, lengths, pushes] = [(); 3].map(|()| vec![0.0; p]);
        LandmarkRow { distances, weights: Matrix::zeros(p, 1), lengths, pushes }
    }

    /// Fills the row of a landmark.
    fn fill(&self, row: &mut LandmarkRow, x: &Matrix, landmark: usize) -> Result<(), NmdsError> {
        self.budget.check()?;
        let LandmarkRow { distances, weights, lengths, pushes } = row;
        self.pairs.rows.row_into(landmark, distances)?;
        lengths.fill(0.0);
        for column in x.column_iter() {
            let at = column[landmark];
            lengths.iter_mut().zip(column.as_slice()).for_each(|(sq, x)| *sq += (x - at) * (x - at));
        }
        let (scale, power) = (1.0 / self.unit, self.pairs.power);
        let pairs = distances.iter_mut().zip(weights.iter_mut()).zip(lengths).zip(pushes);
        for (((d, w), length), push) in pairs {
            (*d, *length) = (*d * scale, length.sqrt());
            *w = match power {
                0.0 => 1.0,
                _ if *d == 0.0 => 0.0,
                1.0 => 1.0 / *d,
                power => d.powf(-power),
            };
            *push = if *length > 0.0 { *w * *d / *length } else { 0.0 };
        }
        Ok(())
    }

    /// What the row of every landmark says.
    fn of_rows<T: Send>(
        &self,
        x: &Matrix,
        says: impl Fn(&mut LandmarkRow, usize) -> T + Sync,
    ) -> Result<Vec<T>, NmdsError> {
        let of_row = |row: &mut LandmarkRow, landmark: &usize| {
            self.fill(row, x, *landmark)?;
            Ok(says(row, *landmark))
        };
        self.pairs.landmarks.par_iter().map_init(|| self.new_row(), of_row).collect()
    }

    /// The raw stress relative to that of coinciding points, and the Guttman transform if all pairs count alike.
    fn around(&self, x: &Matrix) -> Result<(f64, Option<Matrix>), NmdsError> {
        let of_row = |row: &mut LandmarkRow, landmark| {
            let gaps = row.distances.iter().zip(&row.lengths).map(|(d, length)| (d - length) * (d - length));
            let stress: f64 = gaps
                .zip(row.weights.as_slice())
                .zip(self.pairs.masses)
                .map(|((gap, w), m)| m * w * gap)
                .sum();
            (stress, if self.is_uniform { self.pulled(row, x, landmark) } else { Vec::new() })
        };
        let rows = self.of_rows(x, of_row)?;
        let next = self.is_uniform.then(|| {
            let mut next = x.clone();
            let moved = self.pairs.landmarks.iter().zip(&rows);
            moved.for_each(|(&landmark, (_, to))| next.row_mut(landmark).copy_from_slice(to));
            next
        });
        Ok((rows.iter().map(|(stress, _)| stress).sum::<f64>() / self.total, next))
    }

    /// The points after a step.
    fn step(&self, x: &Matrix) -> Result<Matrix, NmdsError> {
        let (mut x, mut row) = (x.clone(), self.new_row());
        if self.pairs.landmarks.len() < x.nrows() {
            let (mut sums, mut totals) = (Matrix::zeros(x.nrows(), x.ncols()), vec![0.0; x.nrows()]);
            for &landmark in self.pairs.landmarks {
                self.fill(&mut row, &x, landmark)?;
                let forces = || row.weights.as_slice().iter().zip(&row.pushes);
                for (mut sum, column) in sums.column_iter_mut().zip(x.column_iter()) {
                    let at = column[landmark];
                    let pulled = sum.iter_mut().zip(column.as_slice()).zip(forces());
                    pulled.for_each(|((sum, x), (w, push))| *sum += w * at + push * (x - at));
                }
                totals.iter_mut().zip(row.weights.as_slice()).for_each(|(total, w)| *total += w);
            }
            // Landmarks wait for their turn.
            for i in (0..x.nrows()).filter(|&i| self.is_landmark[i] == 0.0 && totals[i] > 0.0) {
                x.row_mut(i).copy_from(&(sums.row(i) / totals[i]));
            }
        }
        for &landmark in self.pairs.landmarks {
            self.fill(&mut row, &x, landmark)?;
            // A landmark does not hold itself.
            (row.weights[landmark], row.pushes[landmark]) = (0.0, 0.0);
            let to = self.pulled(&mut row, &x, landmark);
            x.row_mut(landmark).copy_from_slice(&to);
        }
        Ok(x)
    }

    /// Where all points pull a landmark. Overwrites the weights of its row.
    fn pulled(&self, row: &mut LandmarkRow, x: &Matrix, landmark: usize) -> Vec<f64> {
        let (masses, at) = (self.pairs.masses.iter().zip(&self.is_landmark), x.row(landmark));
        let (mut total, mut pushed, own) = (0.0, 0.0, self.pairs.masses[landmark]);
        for ((w, push), (mass, is_landmark)) in
            row.weights.as_mut_slice().iter_mut().zip(&row.pushes).zip(masses)
        {
            // A pair of landmarks belongs to both of them.
            let mass = mass + is_landmark * own;
            (total, pushed) = (total + mass * *w, pushed + mass * push);
            *w = mass * (*w - push);
        }
        if total == 0.0 {
            return at.iter().copied().collect();
        }
        (0..at.len()).map(|k| (x.column(k).dot(&row.weights) + pushed * at[k]) / total).collect()
    }
}
