//! Measuring the distances that an embedding method needs.

use std::borrow::Cow;
use std::fmt;
use std::str::FromStr;
use std::time::Instant;

use base::{Budget, Exceeded};
use geodesics::{DistanceSolver, FirstSample, PrunedSolver, Sampler, Sampling, Source};
use linalg::{DistanceMatrix, LandmarkDistances, Matrix};
use nmds::{Embedding, NmdsError, SampleSearch, SampleStep};
use serde::{Deserialize, Serialize};
use surface::VertexId;

use super::plan::{Plan, check_memory};
use super::report::SamplesReport;
use crate::error::Error;
use base::Observer;

/// Samples taken by default, as in the paper's Figure 4.
const DEFAULT_COUNT: usize = 100;

/// [`Samples::Auto`] stops at this many samples.
const AUTO_LAST: usize = 640;

/// How many samples are taken; written as a number or as `auto`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(into = "Stored", try_from = "Stored")]
pub enum Samples {
    /// This many.
    Count(usize),
    /// As many as needed, at most 640: see [`SampleSearch`].
    Auto,
}

impl Samples {
    /// The number, or `auto` if it is not fixed.
    pub(super) fn count_or(self, auto: usize) -> usize {
        match self {
            Self::Count(n) => n,
            Self::Auto => auto,
        }
    }
}

impl Default for Samples {
    fn default() -> Self {
        Self::Count(DEFAULT_COUNT)
    }
}

impl fmt::Display for Samples {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Count(n) => n.fmt(f),
            Self::Auto => f.write_str("auto"),
        }
    }
}

impl FromStr for Samples {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.parse() {
            _ if text == "auto" => Ok(Self::Auto),
            Ok(0) | Err(_) => Err(format!("`{text}` is neither a positive number nor `auto`")),
            Ok(n) => Ok(Self::Count(n)),
        }
    }
}

/// [`Samples`] as they are stored: `100` or `"auto"`.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum Stored {
    Count(usize),
    Text(String),
}

impl From<Samples> for Stored {
    fn from(samples: Samples) -> Self {
        match samples {
            Samples::Count(n) => Self::Count(n),
            Samples::Auto => Self::Text(samples.to_string()),
        }
    }
}

impl TryFrom<Stored> for Samples {
    type Error = String;

    fn try_from(stored: Stored) -> Result<Self, String> {
        match stored {
            Stored::Count(n) => n.to_string().parse(),
            Stored::Text(text) => text.parse(),
        }
    }
}

/// The memory of an embedding by distances from samples.
pub(super) fn plan(n_vertices: usize, samples: Samples) -> Plan {
    let held_out = if samples == Samples::Auto { SampleSearch::ROWS } else { 0 };
    Plan::new(n_vertices, samples.count_or(AUTO_LAST)).with_held_out(held_out)
}

/// Measures distances on one surface and counts the time it takes.
pub(super) struct Measurement<'a> {
    pub(super) solver: &'a dyn DistanceSolver,
    pub(super) samples: Samples,
    pub(super) sampling: Sampling,
    /// A vertex of the repaired mesh.
    pub(super) first: FirstSample,
    pub(super) seed: u64,
    pub(super) observer: &'a dyn Observer,
    /// The limits of all work on the surface.
    pub(super) budget: Budget,
    /// Whether the method reads distances in blocks, so that they may be in a file.
    pub(super) streams: bool,
    /// Seconds spent on distances so far.
    pub(super) seconds: f64,
    /// How the number of samples was found, if it was not given.
    pub(super) search: Option<SamplesReport>,
}

/// Embeds by distances, with a rank of the sample matrix if there is one.
pub(super) type EmbedByRank<'a> =
    dyn Fn(&LandmarkDistances, Option<usize>) -> Result<Embedding, NmdsError> + 'a;

/// An embedding by distances from samples.
pub(super) struct Sampled<'a> {
    /// Embeds; with this rank of the sample matrix if one is given, else as the options say.
    pub(super) embed: &'a EmbedByRank<'a>,
    /// Other ranks worth trying for a number of samples; none if the options say the rank, or there is none.
    pub(super) other_ranks: &'a dyn Fn(usize) -> Vec<usize>,
    /// The number of samples that a search begins with.
    pub(super) first_samples: usize,
}

impl Sampled<'_> {
    fn others(&self, distances: &LandmarkDistances) -> Result<Vec<Embedding>, NmdsError> {
        let ranks = (self.other_ranks)(distances.n_landmarks());
        ranks.into_iter().map(|rank| (self.embed)(distances, Some(rank))).collect()
    }
}

impl Measurement<'_> {
    /// Takes samples and embeds by the distances from them.
    pub(super) fn sampled(&mut self, method: &Sampled<'_>) -> Result<(Embedding, LandmarkDistances), Error> {
        let (solver, sampling) = (self.solver, self.sampling);
        self.observer.begin("distances", self.samples.count_or(AUTO_LAST));
        let mut sampler = self.timed(|m| sampling.start(solver, m.first, m.seed))?;
        if self.streams && self.budget.spill().is_some() {
            let store = plan(solver.n_vertices(), self.samples).store(&self.budget)?;
            self.timed(|_| sampler.move_to(store))?;
        }
        let n = match self.samples {
            Samples::Count(n) => n,
            Samples::Auto => return self.enough(&mut sampler, method),
        };
        self.extend(&mut sampler, n)?;
        let distances = self.timed(|_| sampler.into_distances(n))?;
        self.budget.check()?;
        let embedding = (method.embed)(&distances, None)?;
        self.budget.check()?;
        Ok((embedding, distances))
    }

    /// Takes samples until they are enough.
    fn enough(
        &mut self,
        sampler: &mut Sampler,
        method: &Sampled<'_>,
    ) -> Result<(Embedding, LandmarkDistances), Error> {
        let p = self.solver.n_vertices();
        let limit = AUTO_LAST.min(p);
        let mut distances = self.take(sampler, method.first_samples.min(limit))?;
        let first = (method.embed)(&distances, None)?;
        let mut search = SampleSearch::new(&distances, first, limit, self.seed)?;
        let rows: Vec<VertexId> = search.rows().into_iter().map(VertexId::from).collect();
        check_memory(p, rows.len(), &self.budget)?;
        let columns = self.timed(|m| m.solver.distance_columns(&rows))?;
        let mut step = search.start(&columns)?;
        let stop = loop {
            self.budget.check()?;
            match step {
                SampleStep::Samples(n) => {
                    distances = self.take(sampler, n)?;
                    step = search.offer(&distances, (method.embed)(&distances, None)?)?;
                }
                SampleStep::Done(stop) => break stop,
            }
        };
        search.compare(method.others(&distances)?)?;
        self.search = Some(SamplesReport {
            stop,
            sufficient: search.sufficient(),
            rows: rows.len(),
            tried: search.trials().to_vec(),
        });
        Ok((search.into_embedding(), distances))
    }

    /// Takes samples until there are `n`, or as many as there are vertices.
    fn extend(&mut self, sampler: &mut Sampler, n: usize) -> Result<(), Error> {
        if !self.streams || self.budget.spill().is_none() {
            let p = self.solver.n_vertices();
            check_memory(p, n.min(p), &self.budget)?;
        }
        Ok(self.timed(|_| sampler.extend_to(n))?)
    }

    fn take(&mut self, sampler: &mut Sampler, n: usize) -> Result<LandmarkDistances, Error> {
        self.extend(sampler, n)?;
        Ok(self.timed(|_| sampler.distances(n))?)
    }

    /// The distances between all pairs of vertices.
    pub(super) fn all_pairs(&mut self) -> Result<DistanceMatrix, Error> {
        let p = self.solver.n_vertices();
        check_memory(p, p, &self.budget)?;
        self.observer.begin("distances", p);
        self.timed(|m| Ok(m.solver.distance_matrix()?))
    }

    /// The columns of `all` that belong to samples, as a method with samples would take them.
    pub(super) fn columns_of(&mut self, all: &DistanceMatrix) -> Result<LandmarkDistances, Error> {
        let known = KnownDistances(all);
        let mut sampler = self.sampling.start(&known, self.first, self.seed)?;
        self.take(&mut sampler, self.samples.count_or(DEFAULT_COUNT))
    }

    /// Counts the time of `work` as time spent on distances.
    fn timed<T, E>(&mut self, work: impl FnOnce(&Self) -> Result<T, E>) -> Result<T, E> {
        let start = Instant::now();
        let result = work(self);
        self.seconds += start.elapsed().as_secs_f64();
        result
    }
}

/// A solver that looks distances up.
#[derive(Debug)]
struct KnownDistances<'a>(&'a DistanceMatrix);

impl DistanceSolver for KnownDistances<'_> {
    fn n_vertices(&self) -> usize {
        self.0.n_points()
    }

    fn solve_into(&self, sources: &[Source], max_distance: f64, out: &mut [f64]) -> Result<(), Exceeded> {
        out.fill(f64::INFINITY);
        for (vertex, offset) in sources.iter().flat_map(Source::reach) {
            for (near, distance) in out.iter_mut().zip(self.0.row(vertex.index())) {
                *near = near.min(offset + distance);
            }
        }
        out.iter_mut().filter(|d| **d > max_distance).for_each(|d| *d = f64::INFINITY);
        Ok(())
    }
}

/// A solver that looks up what is known and measures the rest.
#[derive(Debug)]
pub(super) struct KnownColumns<'a> {
    pub(super) solver: &'a dyn DistanceSolver,
    pub(super) known: &'a LandmarkDistances,
}

impl KnownColumns<'_> {
    /// The distances from a vertex, if it is a known landmark whose column can be read.
    fn column(&self, vertex: VertexId) -> Option<Cow<'_, [f64]>> {
        let landmark = self.known.landmarks().iter().position(|&landmark| landmark == vertex.index())?;
        self.known.column(landmark).ok()
    }
}

impl DistanceSolver for KnownColumns<'_> {
    fn n_vertices(&self) -> usize {
        self.solver.n_vertices()
    }

    fn budget(&self) -> Budget {
        self.solver.budget()
    }

    fn solve_into(&self, sources: &[Source], max_distance: f64, out: &mut [f64]) -> Result<(), Exceeded> {
        self.solver.solve_into(sources, max_distance, out)
    }

    fn distances_into(&self, source: VertexId, out: &mut [f64]) -> Result<(), Exceeded> {
        match self.column(source) {
            Some(column) => {
                out.copy_from_slice(&column);
                Ok(())
            }
            None => self.solver.distances_into(source, out),
        }
    }

    fn pruned(&self) -> Option<&dyn PrunedSolver> {
        self.solver.pruned()
    }

    fn distance_columns(&self, sources: &[VertexId]) -> Result<Matrix, Exceeded> {
        let known: Vec<_> = sources.iter().map(|&source| self.column(source)).collect();
        let unknown = sources.iter().zip(&known).filter(|(_, known)| known.is_none());
        let measured =
            self.solver.distance_columns(&unknown.map(|(source, _)| *source).collect::<Vec<_>>())?;
        let mut measured = measured.column_iter();
        let mut columns = self.budget().vector(self.n_vertices().saturating_mul(sources.len()))?;
        for (place, known) in columns.chunks_exact_mut(self.n_vertices().max(1)).zip(&known) {
            match (known, known.is_none().then(|| measured.next()).flatten()) {
                (Some(known), _) => place.copy_from_slice(known),
                (None, Some(column)) => place.copy_from_slice(column.as_slice()),
                (None, None) => unreachable!("every source is measured or known"),
            }
        }
        Ok(Matrix::from_vec(self.n_vertices(), sources.len(), columns))
    }
}
