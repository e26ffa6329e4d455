//! Landmarks taken by a rule, and the distances from them.

use std::sync::OnceLock;

use linalg::{ColumnStore, LandmarkDistances, LinalgError};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use surface::{VertexId, unit_for};

use super::{FirstSample, Sampling};
use crate::error::GeodesicError;
use crate::solver::DistanceSolver;

/// Most columns that are measured at once: some solvers take many sources at once faster than one by one.
const BATCH: usize = 64;

/// Takes landmarks on one surface, one after the other: the first n of 2n landmarks are the n landmarks.
///
/// ```
/// use canonform_geodesics::{Dijkstra, FirstSample, Sampling};
/// use mesh::shapes;
///
/// // A strip: first its ends, then its middle.
/// let solver = Dijkstra::new(&shapes::grid(9, 2, 1.0).intrinsic(), &());
/// let mut sampler = Sampling::Farthest.start(&solver, FirstSample::Farthest, 0)?;
/// sampler.extend_to(3)?;
/// let columns = sampler.distances(3)?;
/// assert!(columns.landmarks()[2] % 9 == 4);
/// # Ok::<(), canonform_geodesics::GeodesicError>(())
/// ```
#[derive(Debug)]
pub struct Sampler<'a> {
    solver: &'a dyn DistanceSolver,
    rule: Rule,
    landmarks: Vec<usize>,
    /// The distances from them, all finite.
    store: ColumnStore,
}

/// What the next landmark depends on.
#[derive(Debug)]
enum Rule {
    /// The distance of every vertex to its nearest landmark.
    Farthest { nearest: Vec<f64> },
    /// All vertices in the order in which they are taken.
    Random { order: Vec<usize> },
    Incremental {
        /// 1 for the least variance, -1 for the greatest.
        sign: f64,
        second: Option<usize>,
        /// The unit of the moments, in which fourth powers of distances neither underflow nor overflow.
        unit: f64,
        /// For every vertex, the mean of its squared distances to the landmarks and the sum of their squared deviations.
        moments: Vec<[f64; 2]>,
        is_landmark: Vec<bool>,
    },
}

impl Rule {
    /// The landmarks that can be taken at once after the first `taken`, up to the `n`th; none if there are no more.
    fn next(&self, taken: usize, n: usize) -> Vec<usize> {
        let next = match self {
            Self::Random { order } => return order[taken..n].to_vec(),
            Self::Farthest { nearest } => Some(farthest(nearest)).filter(|next| nearest[*next] > 0.0),
            Self::Incremental { second, .. } if taken == 1 => *second,
            Self::Incremental { sign, moments, is_landmark, .. } => {
                let better = |v: usize, best: usize| sign * moments[v][1] < sign * moments[best][1];
                let free = (0..moments.len()).filter(|&v| !is_landmark[v]);
                free.reduce(|best, v| if better(v, best) { v } else { best })
            }
        };
        next.into_iter().collect()
    }

    /// Takes note of the distances from a landmark, which is the `count`th.
    fn note(&mut self, landmark: usize, count: usize, column: &[f64]) {
        match self {
            Self::Farthest { nearest } => {
                nearest.iter_mut().zip(column).for_each(|(near, d)| *near = near.min(*d));
            }
            Self::Random { .. } => {}
            Self::Incremental { unit, moments, is_landmark, .. } => {
                is_landmark[landmark] = true;
                if count == 1 {
                    *unit = unit_for(column.iter().copied().fold(0.0, f64::max));
                }
                for ([mean, spread], d) in moments.iter_mut().zip(column) {
                    let square = (d / *unit).powi(2);
                    let off = square - *mean;
                    *mean += off / count as f64;
                    *spread += off * (square - *mean);
                }
            }
        }
    }
}

impl Sampling {
    /// Starts with the landmark `first`; `seed` determines what is drawn at random.
    ///
    /// # Errors
    /// [`GeodesicError::NoSuchVertex`], [`GeodesicError::NoSamples`] on an empty surface,
    /// [`GeodesicError::Disconnected`].
    pub fn start<'a>(
        self,
        solver: &'a dyn DistanceSolver,
        first: FirstSample,
        seed: u64,
    ) -> Result<Sampler<'a>, GeodesicError> {
        let p = solver.n_vertices();
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let first = match first {
            _ if p == 0 => return Err(GeodesicError::NoSamples),
            FirstSample::Vertex(vertex) if vertex.index() >= p => {
                return Err(GeodesicError::NoSuchVertex { vertex, n_vertices: p });
            }
            FirstSample::Vertex(vertex) => vertex.index(),
            FirstSample::Farthest if self == Self::Farthest => farthest(measured(solver, &[0])?.as_slice()),
            FirstSample::Farthest => below(p, &mut rng),
        };
        let rule = match self {
            Self::Farthest => Rule::Farthest { nearest: vec![f64::INFINITY; p] },
            Self::Random => {
                let mut order: Vec<usize> = (0..p).collect();
                order.swap(0, first);
                for i in 1..p {
                    order.swap(i, i + below(p - i, &mut rng));
                }
                Rule::Random { order }
            }
            Self::MinVariance | Self::MaxVariance => Rule::Incremental {
                sign: if self == Self::MinVariance { 1.0 } else { -1.0 },
                // Any other vertex: those from the first on move up by one.
                second: (p > 1).then(|| below(p - 1, &mut rng)).map(|v| v + usize::from(v >= first)),
                unit: 1.0,
                moments: vec![[0.0; 2]; p],
                is_landmark: vec![false; p],
            },
        };
        let mut sampler = Sampler { solver, rule, landmarks: Vec::new(), store: ColumnStore::in_memory(p) };
        sampler.add(&[first])?;
        Ok(sampler)
    }
}

impl Sampler<'_> {
    /// Takes further landmarks until there are `n`, or as many as the surface has.
    ///
    /// # Errors
    /// [`GeodesicError::Disconnected`] if a vertex cannot be reached.
    pub fn extend_to(&mut self, n: usize) -> Result<(), GeodesicError> {
        let n = n.min(self.solver.n_vertices());
        self.store.reserve(n.saturating_sub(self.landmarks.len()), &self.solver.budget())?;
        if rayon::current_num_threads() > 1 && self.solver.prunes() {
            self.extend_pruned(n)?;
        }
        while self.landmarks.len() < n {
            let next = self.rule.next(self.landmarks.len(), n);
            if next.is_empty() {
                break;
            }
            self.add(&next)?;
        }
        Ok(())
    }

    /// Adds landmarks and finds the distances from them, in parallel.
    fn add(&mut self, landmarks: &[usize]) -> Result<(), GeodesicError> {
        // Columns in a file are few in memory.
        let batch = if self.store.is_in_file() { rayon::current_num_threads() } else { BATCH };
        for landmarks in landmarks.chunks(batch) {
            let columns = measured(self.solver, landmarks)?;
            for (landmark, column) in landmarks.iter().zip(columns.column_iter()) {
                self.store.push(column.as_slice())?;
                self.landmarks.push(*landmark);
                self.rule.note(*landmark, self.landmarks.len(), column.as_slice());
            }
        }
        Ok(())
    }

    /// Chooses the farthest vertices with pruned fronts, which stop half-way to earlier landmarks, while other threads
    /// compute the distances from those chosen. The first landmark reaches every vertex, so all do.
    ///
    /// Distances may be too long where a pruned front stopped. So the choices are checked once all distances are
    /// known, and kept up to the first that is not the farthest vertex.
    fn extend_pruned(&mut self, n: usize) -> Result<(), GeodesicError> {
        let Self { solver, rule: Rule::Farthest { nearest: known }, landmarks, store } = self else {
            return Ok(());
        };
        let (solver, before) = (*solver, landmarks.len());
        let mut nearest = known.clone();
        let mut guesses = Vec::new();
        let failed = OnceLock::new();
        let note = &|result: Result<(), LinalgError>| {
            if let Err(error) = result {
                failed.get_or_init(|| error);
            }
        };
        let slots = store.grow(n.saturating_sub(before), &solver.budget())?;
        rayon::scope(|scope| {
            let mut unknown = slots.into_iter().peekable();
            while let Some(slot) = unknown.next() {
                let next = farthest(&nearest);
                if nearest[next] == 0.0 || failed.get().is_some() {
                    break;
                }
                guesses.push(next);
                let source = VertexId::from(next);
                scope.spawn(move |_| note(slot.fill(|column| solver.distances_into(source, column))));
                if unknown.peek().is_some() {
                    note(solver.lower(source, &mut nearest).map_err(Into::into));
                }
            }
        });
        drop(nearest);
        if let Some(error) = failed.into_inner() {
            store.truncate(before);
            return Err(error.into());
        }
        for (index, guess) in (before..).zip(guesses) {
            if self.rule.next(index, n) != [guess] {
                break;
            }
            self.landmarks.push(guess);
            self.rule.note(guess, index + 1, &self.store.column(index)?);
        }
        self.store.truncate(self.landmarks.len());
        Ok(())
    }

    /// The distances from the first `n` landmarks, or all if there are fewer, to all vertices, in mesh units.
    ///
    /// # Errors
    /// [`GeodesicError::NoSamples`] if `n` is zero.
    pub fn distances(&self, n: usize) -> Result<LandmarkDistances, GeodesicError> {
        let n = n.min(self.landmarks.len());
        landmark_distances(self.landmarks[..n].to_vec(), self.store.first(n))
    }

    /// The distances from the first `n` landmarks, choosing those that are missing, without a copy of what is in memory.
    ///
    /// # Errors
    /// As [`extend_to`](Self::extend_to) and [`distances`](Self::distances).
    pub fn into_distances(mut self, n: usize) -> Result<LandmarkDistances, GeodesicError> {
        self.extend_to(n)?;
        self.landmarks.truncate(n);
        self.store.truncate(n);
        landmark_distances(self.landmarks, self.store)
    }

    /// Moves the distances into another, empty store, where further ones go too: by default they are in memory. The
    /// result does not depend on the store.
    ///
    /// # Errors
    /// [`GeodesicError::Matrix`] if the store is a file that cannot be written.
    pub fn move_to(&mut self, mut store: ColumnStore) -> Result<(), GeodesicError> {
        for index in 0..self.landmarks.len() {
            store.push(&self.store.column(index)?)?;
        }
        self.store = store;
        Ok(())
    }
}

/// The distances from some vertices, all finite.
fn measured(solver: &dyn DistanceSolver, landmarks: &[usize]) -> Result<linalg::Matrix, GeodesicError> {
    let sources: Vec<VertexId> = landmarks.iter().map(|&landmark| VertexId::from(landmark)).collect();
    let columns = solver.distance_columns(&sources)?;
    for (source, column) in sources.into_iter().zip(columns.column_iter()) {
        let unreached = column.iter().filter(|d| !d.is_finite()).count();
        if unreached > 0 {
            let n_vertices = solver.n_vertices();
            return Err(GeodesicError::Disconnected { unreached, n_vertices, source_vertex: source });
        }
    }
    Ok(columns)
}

fn landmark_distances(landmarks: Vec<usize>, store: ColumnStore) -> Result<LandmarkDistances, GeodesicError> {
    match landmarks.is_empty() {
        true => Err(GeodesicError::NoSamples),
        false => Ok(LandmarkDistances::of_columns(landmarks, store)?),
    }
}

/// A random number below `limit`, which must be positive; uniform to one in 2^64.
fn below(limit: usize, rng: &mut ChaCha8Rng) -> usize {
    (rng.next_u64() % limit as u64) as usize
}

/// The lowest index of the largest value.
pub(super) fn farthest(values: &[f64]) -> usize {
    (0..values.len()).reduce(|best, i| if values[i] > values[best] { i } else { best }).unwrap_or(0)
}
