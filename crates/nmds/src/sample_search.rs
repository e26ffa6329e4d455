//! How many samples are enough, by distances that the embedding does not know.

use linalg::{LandmarkDistances, Matrix};

use crate::row_sample::RowSample;
use crate::stress::{Stress, estimate_stress};
use crate::{Embedding, NmdsError};

/// Samples grow by this share at a time: finer steps embed more often, coarser ones overshoot.
const GROWTH: f64 = 0.2;

/// Samples are enough when twice as many reduce the stress by less than this share.
const GAIN: f64 = 0.01;

/// Relative errors of distances below this are rounding.
const NEGLIGIBLE: f64 = 1e-6;

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
    /// The normalized stress on the same rows.
    pub normalized: f64,
}

/// How the number of samples was found.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct SamplesReport {
    /// Why no more samples were taken.
    pub stop: SampleStop,
    /// The least number of samples tried whose stress is within 1 % of that of the result.
    pub sufficient: usize,
    /// Rows of distances that the choice was made on. They are not those that the stress of the result is estimated from.
    pub rows: usize,
    /// What was tried.
    pub tried: Vec<SampleTrial>,
}

/// Embeds from a number of samples.
pub type EmbedSamples<'a> = dyn Fn(&LandmarkDistances) -> Result<Embedding, NmdsError> + 'a;

/// Finds how many samples an embedding needs: until twice as many reduced the [stress of the paper](crate::paper_stress) by less
/// than 1 %. The stress is that on held-out rows: distances from [16 points](Self::ROWS) that are drawn once, by
/// [`RowSample::by_landmarks`] for the first embedding.
///
/// The samples of a larger number include those of a smaller one, so columns are never measured twice. Numbers grow by a fifth:
/// 8, 10, 12, 15, 18, ... for three dimensions. All embeddings are compared on the same rows, so what they have in common cancels.
///
/// The stress on these rows is biased after the search, which has picked embeddings that fit them. A certificate needs
/// [other rows](crate::estimate_stress).
///
/// ```
/// # extern crate linalg as canonform_linalg;
/// use canonform_linalg::{LandmarkDistances, Matrix};
/// use canonform_nmds::{NmdsError, Regularization, SampleSearch, nystrom};
///
/// // Points on a circle, with distances along the arc, embedded in the plane.
/// let p = 200;
/// let along = |i: usize, j: usize| i.abs_diff(j).min(p - i.abs_diff(j)) as f64;
/// let columns = |of: &[usize]| Matrix::from_fn(p, of.len(), |i, j| along(i, of[j]));
/// let landmarks = |n: usize| {
///     let landmarks: Vec<usize> = (0..n).map(|j| j * p / n).collect();
///     Ok::<_, NmdsError>(LandmarkDistances::new(landmarks.clone(), columns(&landmarks))?)
/// };
///
/// let regularization = Regularization::default();
/// let search = SampleSearch {
///     first: regularization.first_samples(2),
///     limit: 100,
///     seed: 0,
///     embed: &|distances| nystrom(distances, regularization, 2),
/// };
/// let (embedding, distances, report) = search.run(landmarks, |rows| Ok(columns(rows)))?;
/// println!("{:?} with {} samples and rank {}", report.stop, distances.n_landmarks(), embedding.rank);
/// # Ok::<(), NmdsError>(())
/// ```
#[derive(Clone, Copy)]
pub struct SampleSearch<'a> {
    /// The number of samples to begin with.
    pub first: usize,
    /// The most samples that are taken.
    pub limit: usize,
    /// Determines the rows that are held out.
    pub seed: u64,
    /// Embeds.
    pub embed: &'a EmbedSamples<'a>,
}

impl SampleSearch<'_> {
    /// The most rows that are held out.
    pub const ROWS: usize = 16;

    /// The number of samples that a search in `dim` dimensions begins with: one more than the default rank.
    pub fn first(dim: usize) -> usize {
        dim + 5
    }

    /// Searches. `columns` measures the distances from as many samples, or from all there are, and `rows` those from some points,
    /// one column each. Returns the embedding and the distances it was made from.
    ///
    /// # Errors
    /// [`NmdsError::Linalg`], and those of the embedding and of the distances.
    pub fn run<E: From<NmdsError>>(
        &self,
        mut columns: impl FnMut(usize) -> Result<LandmarkDistances, E>,
        rows: impl FnOnce(&[usize]) -> Result<Matrix, E>,
    ) -> Result<(Embedding, LandmarkDistances, SamplesReport), E> {
        let mut asked = self.first.min(self.limit);
        let mut distances = columns(asked)?;
        let mut embedding = (self.embed)(&distances)?;
        // Other rows than those of a certificate with the same seed.
        let seed = self.seed ^ 0x9e37_79b9_7f4a_7c15;
        let sample = RowSample::by_landmarks(&embedding.coords, &distances, Self::ROWS, seed)
            .map_err(NmdsError::from)?;
        let held_out =
            LandmarkDistances::new(sample.rows(), rows(&sample.rows())?).map_err(NmdsError::from)?;
        let mut tried: Vec<SampleTrial> = Vec::new();
        let stop = loop {
            let n = distances.n_landmarks();
            let found = estimate_stress(&embedding.coords, &held_out, &sample).map_err(NmdsError::from)?;
            let of_half = tried.iter().rev().find(|other| 2 * other.n_samples <= n);
            let has_settled = of_half.is_some_and(|half| half.stress <= (1.0 + GAIN) * found.value);
            let Stress { value: stress, normalized, .. } = found;
            tried.push(SampleTrial { n_samples: n, rank: embedding.rank, stress, normalized });
            match () {
                () if normalized < NEGLIGIBLE || has_settled => break SampleStop::Settled,
                () if n < asked || n >= distances.n_points() => break SampleStop::AllPoints,
                () if n >= self.limit => break SampleStop::Limit,
                () => {}
            }
            asked = (n + ((n as f64 * GROWTH) as usize).max(1)).min(self.limit);
            distances = columns(asked)?;
            embedding = (self.embed)(&distances)?;
        };
        let least = tried.last().map_or(f64::NAN, |last| last.stress);
        let enough = tried.iter().find(|trial| trial.stress <= (1.0 + GAIN) * least);
        let sufficient = enough.map_or(distances.n_landmarks(), |trial| trial.n_samples);
        let report = SamplesReport { stop, sufficient, rows: held_out.n_landmarks(), tried };
        Ok((embedding, distances, report))
    }
}
