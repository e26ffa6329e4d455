//! How many samples are enough, by distances that the embedding does not know.

use std::collections::HashMap;

use linalg::{LandmarkDistances, LinalgError, Matrix};

use crate::estimate::{RowSample, StressEstimate, estimate_stress};
use crate::squares::check_extent;
use crate::{DistanceRows, Embedding, NmdsError};

/// Rows that all embeddings are compared on.
const BASE_ROWS: usize = 16;

/// Most rows that are measured to tell a stress from the target.
const MOST_ROWS: usize = 64;

/// With a target, the stress of at most this many points is measured on all rows.
const EXACT_POINTS: usize = 1000;

/// Samples grow by this share at a time: finer steps embed more often, coarser ones overshoot. A search then takes at most
/// half again the samples needed, which a test holds.
const GROWTH: f64 = 0.2;

/// The stress has settled when twice the samples reduce it by less than this share, by definition of [`SampleGoal::Settled`].
const GAIN: f64 = 0.01;

/// Relative errors of distances below this are rounding.
const NEGLIGIBLE: f64 = 1e-6;

/// When samples are enough.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum SampleGoal {
    /// When twice as many reduced the [stress of the paper](crate::paper_stress) by less than 1 %.
    #[default]
    Settled,
    /// When the [normalised stress](crate::normalized_stress) is at most this, or has settled above it.
    Stress(f64),
}

/// What [`SampleSearch`] needs next.
#[derive(Debug, Clone, PartialEq)]
pub enum SampleStep {
    /// An embedding from this many samples, or from all there are.
    Samples(usize),
    /// The distances from these points.
    Rows(Vec<usize>),
    /// Nothing: the samples are enough, or more do not help.
    Done(SampleStop),
}

/// Why no more samples are taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum SampleStop {
    /// The estimated stress is within the target.
    Target,
    /// Twice the samples reduced the stress by less than 1 %.
    Settled,
    /// All points are samples, or coincide with one.
    AllPoints,
    /// The most samples allowed are taken.
    Limit,
}

/// One number of samples that was tried.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct SampleTrial {
    /// Number of samples n.
    pub n_samples: usize,
    /// Eigenpairs of the sample matrix used.
    pub rank: usize,
    /// The stress of the paper on the rows that all trials share, in the unit of a squared distance.
    pub stress: f64,
    /// The normalised stress on all rows known at that time.
    pub normalized: f64,
}

/// Finds how many samples an embedding needs from its stress on held-out rows: distances from points that are drawn once, by
/// [`RowSample::by_landmarks`] for the first embedding, and measured once.
///
/// The samples of a larger number include those of a smaller one, so columns are never measured twice. Numbers grow by a fifth:
/// 8, 10, 12, 15, 18, ... for three dimensions. The search asks for what it needs and is told: it measures nothing itself.
///
/// * All embeddings are compared on the same 16 rows, so what they have in common cancels.
/// * With [`SampleGoal::Stress`], rows are doubled up to 64 as long as the confidence interval contains the target; up to 1,000
///   points, the stress is that of all rows.
/// * Of several candidates, as with different ranks, the one of least normalised stress is kept with [`SampleGoal::Stress`]. Else it
///   is the first, unless the interval of another is below the stress of the first.
///
/// The stress on these rows is biased after the search, which has picked embeddings that fit them. A certificate needs
/// [other rows](estimate_stress).
///
/// ```
/// # extern crate linalg as canonform_linalg;
/// use canonform_linalg::{LandmarkDistances, Matrix};
/// use canonform_nmds::{NystromOptions, SampleGoal, SampleSearch, SampleStep, nystrom};
///
/// // Points on a circle, with distances along the arc, embedded in the plane.
/// let p = 200;
/// let along = |i: usize, j: usize| i.abs_diff(j).min(p - i.abs_diff(j)) as f64;
/// let columns = |of: &[usize]| Matrix::from_fn(p, of.len(), |i, j| along(i, of[j]));
/// let options = NystromOptions { dim: 2, ..NystromOptions::default() };
///
/// let mut search = SampleSearch::new(SampleGoal::Settled, options.first_samples(), 100, 0);
/// let mut step = search.start();
/// let stop = loop {
///     step = match step {
///         SampleStep::Samples(n) => {
///             let landmarks: Vec<usize> = (0..n).map(|j| j * p / n).collect();
///             let distances = LandmarkDistances::new(landmarks.clone(), columns(&landmarks))?;
///             search.offer(&distances, vec![nystrom(&distances, &options)?])?
///         }
///         SampleStep::Rows(rows) => search.supply(&rows, &columns(&rows))?,
///         SampleStep::Done(stop) => break stop,
///     };
/// };
/// let embedding = search.into_embedding().unwrap();
/// println!("{stop:?} with rank {}", embedding.rank);
/// # Ok::<(), canonform_nmds::NmdsError>(())
/// ```
#[derive(Debug, Clone)]
pub struct SampleSearch {
    goal: SampleGoal,
    /// The number of samples asked for.
    asked: usize,
    limit: usize,
    seed: u64,
    held_out: Option<HeldOut>,
    candidates: Vec<Embedding>,
    n_samples: usize,
    trials: Vec<SampleTrial>,
}

impl SampleSearch {
    /// The most rows that a search among `n_points` points measures.
    #[must_use]
    pub fn most_rows(goal: SampleGoal, n_points: usize) -> usize {
        match goal {
            SampleGoal::Settled => BASE_ROWS.min(n_points),
            SampleGoal::Stress(_) if n_points <= EXACT_POINTS => n_points,
            SampleGoal::Stress(_) => MOST_ROWS,
        }
    }

    /// The number of samples that a search in `dim` dimensions begins with: one more than the default rank.
    #[must_use]
    pub fn first(dim: usize) -> usize {
        dim + 5
    }

    /// Starts a search with `first` samples, which ends with at most `limit`. `seed` determines the rows.
    #[must_use]
    pub fn new(goal: SampleGoal, first: usize, limit: usize, seed: u64) -> Self {
        let asked = first.min(limit);
        // Other rows than those of a certificate with the same seed.
        let seed = seed ^ 0x9e37_79b9_7f4a_7c15;
        let (candidates, trials) = Default::default();
        Self { goal, asked, limit, seed, held_out: None, candidates, n_samples: 0, trials }
    }

    /// The first step.
    #[must_use]
    pub fn start(&self) -> SampleStep {
        SampleStep::Samples(self.asked)
    }

    /// Takes embeddings from the number of samples that was asked for. Fewer `distances` mean that there are no more samples.
    ///
    /// # Errors
    /// [`NmdsError::NoExtent`], [`NmdsError::Linalg`].
    ///
    /// # Panics
    /// If there are no candidates.
    pub fn offer(
        &mut self,
        distances: &LandmarkDistances,
        candidates: Vec<Embedding>,
    ) -> Result<SampleStep, NmdsError> {
        assert!(!candidates.is_empty(), "an embedding is needed");
        if self.held_out.is_none() {
            self.held_out = Some(HeldOut::new(&candidates[0].coords, distances, self.goal, self.seed)?);
        }
        self.candidates = candidates;
        self.n_samples = distances.n_landmarks();
        self.decide()
    }

    /// Takes the distances from points that were asked for, one column each.
    ///
    /// # Errors
    /// [`NmdsError::Linalg`].
    ///
    /// # Panics
    /// If there is not a column for each row.
    pub fn supply(&mut self, rows: &[usize], columns: &Matrix) -> Result<SampleStep, NmdsError> {
        assert_eq!(rows.len(), columns.ncols(), "a column for each row");
        if let Some(held_out) = &mut self.held_out {
            held_out.add(rows, columns);
        }
        self.decide()
    }

    /// Replaces the embedding found by the best of others from the same samples, if that is better.
    ///
    /// # Errors
    /// [`NmdsError::Linalg`].
    pub fn compare(&mut self, others: Vec<Embedding>) -> Result<(), NmdsError> {
        self.candidates.extend(others);
        if let (Some(held_out), Some(last)) = (&self.held_out, self.trials.last_mut()) {
            *last = held_out.best(&mut self.candidates, self.goal, self.n_samples)?.0;
        }
        Ok(())
    }

    /// What was tried, in this order.
    #[must_use]
    pub fn trials(&self) -> &[SampleTrial] {
        &self.trials
    }

    /// Number of different rows that were measured.
    #[must_use]
    pub fn n_rows(&self) -> usize {
        self.held_out.as_ref().map_or(0, |held_out| held_out.columns.len())
    }

    /// The least number of samples tried whose stress is within 1 % of the last one.
    #[must_use]
    pub fn sufficient(&self) -> usize {
        let enough = |last: &SampleTrial| {
            let mut within = self.trials.iter().filter(|trial| trial.stress <= (1.0 + GAIN) * last.stress);
            within.next().map(|trial| trial.n_samples)
        };
        self.trials.last().and_then(enough).unwrap_or(self.n_samples)
    }

    /// The embedding found.
    #[must_use]
    pub fn into_embedding(self) -> Option<Embedding> {
        self.candidates.into_iter().next()
    }

    /// Decides on the candidates, as far as the known rows allow.
    fn decide(&mut self) -> Result<SampleStep, NmdsError> {
        let trial = loop {
            let Some(held_out) = &mut self.held_out else { return Ok(self.start()) };
            let missing = held_out.missing();
            if !missing.is_empty() {
                return Ok(SampleStep::Rows(missing));
            }
            let (trial, interval) = held_out.best(&mut self.candidates, self.goal, self.n_samples)?;
            let SampleGoal::Stress(target) = self.goal else { break trial };
            let is_open = interval[0] < target && target < interval[1];
            if !(is_open && held_out.may_grow()) {
                break trial;
            }
            held_out.grow()?;
        };
        self.trials.push(trial);
        let n = self.n_samples;
        let is_exact = trial.normalized < NEGLIGIBLE;
        let of_half = self.trials.iter().rev().find(|other| 2 * other.n_samples <= n);
        let stop = match self.goal {
            SampleGoal::Stress(target) if trial.normalized <= target => SampleStop::Target,
            _ if is_exact || of_half.is_some_and(|half| half.stress <= (1.0 + GAIN) * trial.stress) => {
                SampleStop::Settled
            }
            _ if n < self.asked => SampleStop::AllPoints,
            _ if n >= self.limit => SampleStop::Limit,
            _ => {
                self.asked = (n + ((n as f64 * GROWTH) as usize).max(1)).min(self.limit);
                return Ok(SampleStep::Samples(self.asked));
            }
        };
        Ok(SampleStep::Done(stop))
    }
}

/// Rows of distances that no embedding was made from.
#[derive(Debug, Clone)]
struct HeldOut {
    /// The largest distance from the first samples.
    unit: f64,
    /// The first embedding in units of `unit`, and what it was made from: they decide which rows are drawn.
    pilot: (Matrix, LandmarkDistances),
    seed: u64,
    /// The rows that all embeddings are compared on.
    base: RowSample,
    /// All rows, which include those.
    all: RowSample,
    n_drawn: usize,
    /// Distances from the rows measured so far, in units of `unit`.
    columns: HashMap<usize, Vec<f64>>,
}

impl HeldOut {
    fn new(
        coords: &Matrix,
        distances: &LandmarkDistances,
        goal: SampleGoal,
        seed: u64,
    ) -> Result<Self, NmdsError> {
        let p = distances.n_points();
        let unit = check_extent(distances.max(), p)?;
        let coords = coords / unit;
        let base = match goal {
            SampleGoal::Stress(_) if p <= EXACT_POINTS => RowSample::uniform(p, p, seed),
            _ => RowSample::by_landmarks(&coords, distances, unit, BASE_ROWS, seed)?,
        };
        let (all, pilot) = (base.clone(), (coords, distances.clone()));
        Ok(Self { unit, pilot, seed, base, all, n_drawn: BASE_ROWS, columns: HashMap::new() })
    }

    /// Rows that are drawn but not measured.
    fn missing(&self) -> Vec<usize> {
        self.all.rows().into_iter().filter(|row| !self.columns.contains_key(row)).collect()
    }

    fn add(&mut self, rows: &[usize], columns: &Matrix) {
        for (row, column) in rows.iter().zip(columns.column_iter()) {
            self.columns.insert(*row, column.iter().map(|d| d / self.unit).collect());
        }
    }

    fn may_grow(&self) -> bool {
        self.n_drawn < MOST_ROWS && self.columns.len() < self.n_points()
    }

    /// Doubles the rows. The same seed draws the same first rows.
    fn grow(&mut self) -> Result<(), LinalgError> {
        let (coords, distances) = &self.pilot;
        self.n_drawn *= 2;
        self.all = RowSample::by_landmarks(coords, distances, self.unit, self.n_drawn, self.seed)?;
        Ok(())
    }

    /// Keeps the best of the embeddings; its stress on the rows known, with the interval of the normalised one.
    fn best(
        &self,
        candidates: &mut Vec<Embedding>,
        goal: SampleGoal,
        n_samples: usize,
    ) -> Result<(SampleTrial, [f64; 2]), LinalgError> {
        let all = candidates.iter().map(|candidate| self.estimate(candidate, &self.all));
        let estimates = all.collect::<Result<Vec<_>, _>>()?;
        let measure = |estimate: &StressEstimate| match goal {
            // The first unless another is better for certain: a few rows would too often prefer a worse one.
            SampleGoal::Settled if estimate.interval[1] > estimates[0].value => estimates[0].value,
            SampleGoal::Settled => estimate.value,
            SampleGoal::Stress(_) => estimate.normalized,
        };
        let measures = estimates.iter().map(measure).enumerate();
        let (best, _) = measures.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or_default();
        candidates.swap(0, best);
        candidates.truncate(1);
        let base = self.estimate(&candidates[0], &self.base)?;
        let trial = SampleTrial {
            n_samples,
            rank: candidates[0].rank,
            stress: base.value * self.unit * self.unit,
            normalized: estimates[best].normalized,
        };
        Ok((trial, estimates[best].normalized_interval))
    }

    /// The stress of an embedding, in units of `unit`.
    fn estimate(&self, embedding: &Embedding, rows: &RowSample) -> Result<StressEstimate, LinalgError> {
        estimate_stress(&(&embedding.coords / self.unit), self, rows)
    }
}

impl DistanceRows for HeldOut {
    fn n_points(&self) -> usize {
        self.pilot.1.n_points()
    }

    fn row_into(&self, i: usize, out: &mut [f64]) -> Result<(), LinalgError> {
        let known = self.columns.get(&i).unwrap_or_else(|| unreachable!("row {i} was not asked for"));
        out.copy_from_slice(known);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use linalg::DistanceMatrix;

    use super::*;
    use crate::tests::support::Cloud;
    use crate::{NystromOptions, Regularization, normalized_stress, nystrom};

    /// All distances of a problem, and landmarks in the order in which they are taken.
    struct Problem {
        distances: DistanceMatrix,
        order: Vec<usize>,
        options: NystromOptions,
    }

    impl Problem {
        /// Distances that are not Euclidean, raised to a power below 1.
        fn new(p: usize, power: f64, dim: usize) -> Self {
            let cloud = Cloud::new(p, 3, 11);
            let distances = DistanceMatrix::from_pairs(p, |i, j| cloud.distance(i, j).powf(power)).unwrap();
            let order = (0..p).map(|i| (i * 37) % p).collect();
            Self { distances, order, options: NystromOptions { dim, ..NystromOptions::default() } }
        }

        fn columns(&self, of: &[usize]) -> Matrix {
            Matrix::from_fn(self.distances.n_points(), of.len(), |i, j| self.distances.get(i, of[j]))
        }

        fn landmarks(&self, n: usize) -> LandmarkDistances {
            let landmarks = self.order[..n.min(self.order.len())].to_vec();
            let columns = self.columns(&landmarks);
            LandmarkDistances::new(landmarks, columns).unwrap()
        }

        /// Embeddings with all ranks worth trying.
        fn candidates(&self, distances: &LandmarkDistances) -> Vec<Embedding> {
            let with = |rank| {
                let regularization = Regularization::LowRank { rank };
                nystrom(distances, &NystromOptions { regularization, ..self.options.clone() }).unwrap()
            };
            let others = self.options.other_ranks(distances.n_landmarks());
            std::iter::once(None).chain(others.into_iter().map(Some)).map(with).collect()
        }

        /// Runs a search; counts how often each column is asked for.
        fn search(&self, goal: SampleGoal, limit: usize, seed: u64) -> (SampleSearch, SampleStop) {
            let mut search = SampleSearch::new(goal, self.options.first_samples(), limit, seed);
            let (mut step, mut asked) = (search.start(), std::collections::HashSet::new());
            loop {
                step = match step {
                    SampleStep::Samples(n) => {
                        let distances = self.landmarks(n);
                        search.offer(&distances, self.candidates(&distances)).unwrap()
                    }
                    SampleStep::Rows(rows) => {
                        assert!(rows.iter().all(|row| asked.insert(*row)), "a row is measured once");
                        search.supply(&rows, &self.columns(&rows)).unwrap()
                    }
                    SampleStep::Done(stop) => return (search, stop),
                };
            }
        }
    }

    #[test]
    fn a_target_is_reached_with_few_more_samples_than_needed() {
        let problem = Problem::new(240, 0.8, 6);
        let exact = |n: usize| {
            let all = problem.candidates(&problem.landmarks(n));
            let stresses = all.iter().map(|e| normalized_stress(&e.coords, &problem.distances));
            stresses.fold(f64::INFINITY, f64::min)
        };
        let curve: Vec<f64> = (11..=120).map(exact).collect();
        let least = curve.iter().copied().fold(f64::INFINITY, f64::min);
        for share in [0.2, 0.5] {
            let target = least * (curve[0] / least).powf(share);
            let best = 11 + curve.iter().position(|stress| *stress <= target).unwrap();
            for seed in 0..5 {
                let (search, stop) = problem.search(SampleGoal::Stress(target), 200, seed);
                let (n, found) = (search.n_samples, search.into_embedding().unwrap());
                let reached = normalized_stress(&found.coords, &problem.distances) / target;
                println!("target {target:.4}: {n} samples, best {best}, {reached:.3} of the target");
                assert_eq!(stop, SampleStop::Target);
                assert!(2 * n <= 3 * best && reached <= 1.0 + 1e-9, "{n} {best} {reached}");
            }
        }
    }

    #[test]
    fn a_search_without_a_target_ends_when_twice_the_samples_do_not_help() {
        let problem = Problem::new(240, 0.8, 3);
        let (search, stop) = problem.search(SampleGoal::Settled, 200, 0);
        assert_eq!(stop, SampleStop::Settled);
        let trials = search.trials();
        let (last, half) = (trials.last().unwrap(), search.sufficient());
        assert!(2 * half <= last.n_samples, "{half} of {}", last.n_samples);
        assert!(trials.windows(2).all(|pair| pair[0].n_samples < pair[1].n_samples));
        assert!(
            trials.windows(2).all(|pair| pair[1].n_samples as f64 <= 1.2 * pair[0].n_samples as f64 + 1.0)
        );
        assert!((5..=16).contains(&search.n_rows()), "{}", search.n_rows());
    }

    #[test]
    fn a_target_out_of_reach_ends_with_the_other_reasons() {
        let problem = Problem::new(60, 0.8, 3);
        let stop = |goal, limit| problem.search(goal, limit, 1).1;
        assert_eq!(stop(SampleGoal::Stress(1e-3), 640), SampleStop::Settled);
        assert_eq!(stop(SampleGoal::Stress(1e-3), 10), SampleStop::Limit);
        let few = Problem::new(7, 0.8, 3);
        assert_eq!(few.search(SampleGoal::Settled, 640, 0).1, SampleStop::AllPoints);
        // Points in space are exact from the first samples.
        let flat = Problem::new(80, 1.0, 3);
        let (search, stop) = flat.search(SampleGoal::Settled, 640, 0);
        assert_eq!((search.trials().len(), stop), (1, SampleStop::Settled));
    }

    #[test]
    fn the_best_of_several_ranks_is_kept_and_a_worse_one_is_not() {
        let problem = Problem::new(200, 0.8, 3);
        let (search, _) = problem.search(SampleGoal::Settled, 64, 3);
        let (n, found) = (search.n_samples, search.clone().into_embedding().unwrap());
        let distances = problem.landmarks(n);
        let worse = NystromOptions {
            regularization: Regularization::LowRank { rank: Some(4) },
            ..problem.options.clone()
        };
        let mut again = search.clone();
        again.compare(vec![nystrom(&distances, &worse).unwrap()]).unwrap();
        assert_eq!(again.trials().last(), search.trials().last());
        assert_eq!(again.into_embedding().unwrap(), found);
        let given = NystromOptions {
            regularization: Regularization::LowRank { rank: Some(found.rank) },
            ..problem.options.clone()
        };
        assert_eq!(nystrom(&distances, &given).unwrap(), found, "the same as with this rank given");
    }

    #[test]
    fn the_unit_of_length_changes_nothing() {
        let problem = Problem::new(150, 0.8, 3);
        let base = problem.search(SampleGoal::Stress(0.1), 100, 5).0;
        let scaled = DistanceMatrix::from_pairs(150, |i, j| 1024.0 * problem.distances.get(i, j)).unwrap();
        let other = Problem { distances: scaled, ..problem }.search(SampleGoal::Stress(0.1), 100, 5).0;
        assert_eq!(base.trials().len(), other.trials().len());
        for (a, b) in base.trials().iter().zip(other.trials()) {
            assert!((a.normalized / b.normalized - 1.0).abs() < 1e-9);
            assert!((a.stress * 1024.0 * 1024.0 / b.stress - 1.0).abs() < 1e-9);
        }
    }
}
