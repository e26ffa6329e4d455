//! How many samples are enough, by distances that the embedding does not know.

use std::collections::HashMap;

use linalg::{LandmarkDistances, LinalgError, Matrix};

use crate::row_sample::RowSample;
use crate::squares::check_extent;
use crate::stress::{Stress, estimate_stress};
use crate::{DistanceRows, Embedding, NmdsError};

/// Samples grow by this share at a time: finer steps embed more often, coarser ones overshoot.
const GROWTH: f64 = 0.2;

/// Samples are enough when twice as many reduce the stress by less than this share.
const GAIN: f64 = 0.01;

/// Relative errors of distances below this are rounding.
const NEGLIGIBLE: f64 = 1e-6;

/// What [`SampleSearch`] needs next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SampleStep {
    /// An embedding from this many samples, or from all there are.
    Samples(usize),
    /// Nothing: the samples are enough, or more do not help.
    Done(SampleStop),
}

/// Why no more samples are taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum SampleStop {
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
    /// The stress of the paper on the held-out rows, in the unit of a squared distance.
    pub stress: f64,
    /// The normalised stress on the same rows.
    pub normalized: f64,
}

/// Finds how many samples an embedding needs: until twice as many reduced the [stress of the paper](crate::paper_stress) by less
/// than 1 %. The stress is that on held-out rows: distances from [16 points](Self::ROWS) that are drawn once, by
/// [`RowSample::by_landmarks`] for the first embedding.
///
/// The samples of a larger number include those of a smaller one, so columns are never measured twice. Numbers grow by a fifth:
/// 8, 10, 12, 15, 18, ... for three dimensions. The search asks for what it needs and is told: it measures nothing itself. All
/// embeddings are compared on the same rows, so what they have in common cancels.
///
/// The stress on these rows is biased after the search, which has picked embeddings that fit them. A certificate needs
/// [other rows](estimate_stress).
///
/// ```
/// # extern crate linalg as canonform_linalg;
/// use canonform_linalg::{LandmarkDistances, Matrix};
/// use canonform_nmds::{NystromOptions, SampleSearch, SampleStep, nystrom};
///
/// // Points on a circle, with distances along the arc, embedded in the plane.
/// let p = 200;
/// let along = |i: usize, j: usize| i.abs_diff(j).min(p - i.abs_diff(j)) as f64;
/// let columns = |of: &[usize]| Matrix::from_fn(p, of.len(), |i, j| along(i, of[j]));
/// let landmarks = |n: usize| {
///     let landmarks: Vec<usize> = (0..n).map(|j| j * p / n).collect();
///     LandmarkDistances::new(landmarks.clone(), columns(&landmarks))
/// };
/// let options = NystromOptions { dim: 2, ..NystromOptions::default() };
///
/// let first = landmarks(options.first_samples())?;
/// let mut search = SampleSearch::new(&first, nystrom(&first, &options)?, 100, 0)?;
/// let mut step = search.start(&columns(&search.rows()))?;
/// while let SampleStep::Samples(n) = step {
///     let distances = landmarks(n)?;
///     step = search.offer(&distances, nystrom(&distances, &options)?)?;
/// }
/// println!("{step:?} with rank {}", search.into_embedding().rank);
/// # Ok::<(), canonform_nmds::NmdsError>(())
/// ```
#[derive(Debug, Clone)]
pub struct SampleSearch {
    /// The most samples that are taken.
    limit: usize,
    held_out: HeldOut,
    /// The last embedding, and its number of samples.
    embedding: Embedding,
    n_samples: usize,
    trials: Vec<SampleTrial>,
}

impl SampleSearch {
    /// The most rows that are held out.
    pub const ROWS: usize = 16;

    /// The number of samples that a search in `dim` dimensions begins with: one more than the default rank.
    #[must_use]
    pub fn first(dim: usize) -> usize {
        dim + 5
    }

    /// Starts a search that ends with at most `limit` samples from the first embedding. `seed` determines the rows.
    ///
    /// # Errors
    /// [`NmdsError::NoExtent`], [`NmdsError::Linalg`].
    pub fn new(
        distances: &LandmarkDistances,
        embedding: Embedding,
        limit: usize,
        seed: u64,
    ) -> Result<Self, NmdsError> {
        // Other rows than those of a certificate with the same seed.
        let held_out = HeldOut::new(&embedding.coords, distances, seed ^ 0x9e37_79b9_7f4a_7c15)?;
        Ok(Self { limit, held_out, embedding, n_samples: distances.n_landmarks(), trials: Vec::new() })
    }

    /// The points whose distances [`start`](Self::start) needs.
    #[must_use]
    pub fn rows(&self) -> Vec<usize> {
        self.held_out.sample.rows()
    }

    /// Takes the distances from the [rows](Self::rows), one column each, and tells what is needed next.
    ///
    /// # Errors
    /// [`NmdsError::Linalg`].
    ///
    /// # Panics
    /// If there is not a column for each row.
    pub fn start(&mut self, columns: &Matrix) -> Result<SampleStep, NmdsError> {
        let (rows, unit) = (self.rows(), self.held_out.unit);
        assert_eq!(rows.len(), columns.ncols(), "a column for each row");
        let scaled = columns.column_iter().map(|column| column.iter().map(|d| d / unit).collect());
        self.held_out.columns = rows.into_iter().zip(scaled).collect();
        self.decide(self.n_samples)
    }

    /// Takes an embedding from the number of samples that was asked for. Fewer `distances` mean that there are no more samples.
    ///
    /// # Errors
    /// [`NmdsError::Linalg`].
    pub fn offer(
        &mut self,
        distances: &LandmarkDistances,
        embedding: Embedding,
    ) -> Result<SampleStep, NmdsError> {
        let asked = self.next();
        (self.embedding, self.n_samples) = (embedding, distances.n_landmarks());
        self.decide(asked)
    }

    /// Replaces the embedding found by the best of others from the same samples, as with different ranks, if its interval is
    /// below the stress of the one found: a few rows would too often prefer a worse one.
    ///
    /// # Errors
    /// [`NmdsError::Linalg`].
    pub fn compare(&mut self, others: Vec<Embedding>) -> Result<(), NmdsError> {
        let found = self.held_out.estimate(&self.embedding)?;
        let mut least = found.value;
        for other in others {
            let estimate = self.held_out.estimate(&other)?;
            if estimate.interval[1] <= found.value && estimate.value < least {
                (least, self.embedding) = (estimate.value, other);
            }
        }
        self.trials.pop();
        self.trials.push(self.trial()?);
        Ok(())
    }

    /// What was tried, in this order.
    #[must_use]
    pub fn trials(&self) -> &[SampleTrial] {
        &self.trials
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
    pub fn into_embedding(self) -> Embedding {
        self.embedding
    }

    /// The next number of samples.
    fn next(&self) -> usize {
        (self.n_samples + ((self.n_samples as f64 * GROWTH) as usize).max(1)).min(self.limit)
    }

    /// The stress of the last embedding.
    fn trial(&self) -> Result<SampleTrial, LinalgError> {
        let Stress { value, normalized, .. } = self.held_out.estimate(&self.embedding)?;
        let stress = value * self.held_out.unit * self.held_out.unit;
        Ok(SampleTrial { n_samples: self.n_samples, rank: self.embedding.rank, stress, normalized })
    }

    /// Decides on the last embedding, for which `asked` samples were wanted.
    fn decide(&mut self, asked: usize) -> Result<SampleStep, NmdsError> {
        let (n, trial) = (self.n_samples, self.trial()?);
        self.trials.push(trial);
        let of_half = self.trials.iter().rev().find(|other| 2 * other.n_samples <= n);
        let has_settled = of_half.is_some_and(|half| half.stress <= (1.0 + GAIN) * trial.stress);
        Ok(match () {
            () if trial.normalized < NEGLIGIBLE || has_settled => SampleStep::Done(SampleStop::Settled),
            () if n < asked || n >= self.held_out.n_points => SampleStep::Done(SampleStop::AllPoints),
            () if n >= self.limit => SampleStep::Done(SampleStop::Limit),
            () => SampleStep::Samples(self.next()),
        })
    }
}

/// Rows of distances that no embedding was made from.
#[derive(Debug, Clone)]
struct HeldOut {
    n_points: usize,
    /// The largest distance from the first samples.
    unit: f64,
    sample: RowSample,
    /// Distances from the rows, in units of `unit`.
    columns: HashMap<usize, Vec<f64>>,
}

impl HeldOut {
    fn new(coords: &Matrix, distances: &LandmarkDistances, seed: u64) -> Result<Self, NmdsError> {
        let n_points = distances.n_points();
        let unit = check_extent(distances.max(), n_points)?;
        let sample = RowSample::by_landmarks(&(coords / unit), distances, unit, SampleSearch::ROWS, seed)?;
        Ok(Self { n_points, unit, sample, columns: HashMap::new() })
    }

    /// The stress of an embedding, in units of `unit`.
    fn estimate(&self, embedding: &Embedding) -> Result<Stress, LinalgError> {
        estimate_stress(&(&embedding.coords / self.unit), self, &self.sample)
    }
}

impl DistanceRows for HeldOut {
    fn n_points(&self) -> usize {
        self.n_points
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
    use crate::{NystromOptions, Regularization, nystrom};

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

        /// Embeddings with other ranks worth trying.
        fn others(&self, distances: &LandmarkDistances) -> Vec<Embedding> {
            let with = |rank| {
                let regularization = Regularization::LowRank { rank: Some(rank) };
                nystrom(distances, &NystromOptions { regularization, ..self.options.clone() }).unwrap()
            };
            self.options.other_ranks(distances.n_landmarks()).into_iter().map(with).collect()
        }

        /// Runs a search that compares all ranks worth trying at its end.
        fn search(&self, limit: usize, seed: u64) -> (SampleSearch, SampleStop) {
            let first = self.landmarks(self.options.first_samples());
            let default = |distances: &LandmarkDistances| nystrom(distances, &self.options).unwrap();
            let mut search = SampleSearch::new(&first, default(&first), limit, seed).unwrap();
            let mut step = search.start(&self.columns(&search.rows())).unwrap();
            loop {
                match step {
                    SampleStep::Samples(n) => {
                        let distances = self.landmarks(n);
                        step = search.offer(&distances, default(&distances)).unwrap();
                    }
                    SampleStep::Done(stop) => {
                        search.compare(self.others(&self.landmarks(search.n_samples))).unwrap();
                        return (search, stop);
                    }
                }
            }
        }
    }

    #[test]
    fn a_search_ends_when_twice_the_samples_do_not_help() {
        let problem = Problem::new(240, 0.8, 3);
        let (search, stop) = problem.search(200, 0);
        assert_eq!(stop, SampleStop::Settled);
        let trials = search.trials();
        let (last, half) = (trials.last().unwrap(), search.sufficient());
        assert!(2 * half <= last.n_samples, "{half} of {}", last.n_samples);
        assert!(trials.windows(2).all(|pair| pair[0].n_samples < pair[1].n_samples));
        assert!(
            trials.windows(2).all(|pair| pair[1].n_samples as f64 <= 1.2 * pair[0].n_samples as f64 + 1.0)
        );
        assert!((5..=16).contains(&search.rows().len()), "{:?}", search.rows());
    }

    #[test]
    fn a_search_ends_for_other_reasons_too() {
        let stop = |p, power, limit| Problem::new(p, power, 3).search(limit, 1).1;
        assert_eq!(stop(60, 0.8, 10), SampleStop::Limit);
        assert_eq!(stop(7, 0.8, 640), SampleStop::AllPoints);
        // Points in space are exact from the first samples.
        let (search, stop) = Problem::new(80, 1.0, 3).search(640, 0);
        assert_eq!((search.trials().len(), stop), (1, SampleStop::Settled));
    }

    #[test]
    fn the_best_of_several_ranks_is_kept_and_a_worse_one_is_not() {
        let problem = Problem::new(200, 0.8, 3);
        let (search, _) = problem.search(64, 3);
        let (n, found) = (search.n_samples, search.clone().into_embedding());
        let distances = problem.landmarks(n);
        let worse = NystromOptions {
            regularization: Regularization::LowRank { rank: Some(4) },
            ..problem.options.clone()
        };
        let mut again = search.clone();
        again.compare(vec![nystrom(&distances, &worse).unwrap()]).unwrap();
        assert_eq!(again.trials().last(), search.trials().last());
        assert_eq!(again.into_embedding(), found);
        let given = NystromOptions {
            regularization: Regularization::LowRank { rank: Some(found.rank) },
            ..problem.options.clone()
        };
        assert_eq!(nystrom(&distances, &given).unwrap(), found, "the same as with this rank given");
    }

    #[test]
    fn the_unit_of_length_changes_nothing() {
        let problem = Problem::new(150, 0.8, 3);
        let base = problem.search(100, 5).0;
        let scaled = DistanceMatrix::from_pairs(150, |i, j| 1024.0 * problem.distances.get(i, j)).unwrap();
        let other = Problem { distances: scaled, ..problem }.search(100, 5).0;
        assert_eq!(base.trials().len(), other.trials().len());
        for (a, b) in base.trials().iter().zip(other.trials()) {
            assert!((a.normalized / b.normalized - 1.0).abs() < 1e-9);
            assert!((a.stress * 1024.0 * 1024.0 / b.stress - 1.0).abs() < 1e-9);
        }
    }
}
