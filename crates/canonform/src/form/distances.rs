//! Measuring the distances that an embedding method needs.

use std::cell::Cell;
use std::fmt;
use std::str::FromStr;
use std::time::Instant;

use geodesics::{DistanceSolver, FirstSample, Sampler, Sampling};
use linalg::{DistanceMatrix, LandmarkDistances, Matrix};
use nmds::{EmbedSamples, SampleSearch};
use surface::VertexId;

use super::outcome::Outcome;
use super::plan::{Plan, check_memory};
use crate::error::Error;
use base::Observer;

/// Samples taken by default, as in the paper's Figure 4.
const DEFAULT_COUNT: usize = 100;

/// [`Samples::Auto`] stops at this many samples.
const AUTO_LAST: usize = 640;

/// How many samples are taken; written as a number or as `auto`.
#[derive(Debug, Clone, Copy, PartialEq)]
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

/// The memory of an embedding by distances from samples.
pub(super) fn plan(n_vertices: usize, samples: Samples) -> Plan {
    let held_out = if samples == Samples::Auto { SampleSearch::ROWS } else { 0 };
    Plan::new(n_vertices, samples.count_or(AUTO_LAST), held_out)
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
    /// Whether the method reads distances in blocks, so that they may be in a file.
    pub(super) streams: bool,
    /// Seconds spent on distances so far.
    pub(super) seconds: Cell<f64>,
}

impl Measurement<'_> {
    /// Takes samples and embeds by the distances from them. A search for their number begins with `first` of them.
    pub(super) fn sampled(&self, first: usize, embed: &EmbedSamples<'_>) -> Result<Outcome, Error> {
        self.observer.begin("distances", self.samples.count_or(AUTO_LAST));
        let mut sampler = self.timed(|| self.sampling.start(self.solver, self.first, self.seed))?;
        if self.streams && self.observer.budget().spill().is_some() {
            let store = plan(self.solver.n_vertices(), self.samples).store(&self.observer.budget())?;
            self.timed(|| sampler.move_to(store))?;
        }
        let (embedding, distances, search) = match self.samples {
            Samples::Count(n) => {
                self.extend(&mut sampler, n)?;
                let distances = self.timed(|| sampler.into_distances(n))?;
                self.observer.budget().check()?;
                (embed(&distances)?, distances, None)
            }
            Samples::Auto => {
                let search = SampleSearch { first, limit: AUTO_LAST, seed: self.seed, embed };
                let columns = |n| {
                    self.observer.budget().check()?;
                    self.take(&mut sampler, n)
                };
                let rows = |rows: &[usize]| self.columns(rows);
                let (embedding, distances, report) = search.run(columns, rows)?;
                (embedding, distances, Some(report))
            }
        };
        self.observer.budget().check()?;
        Ok(Outcome { embedding, distances, search, all: None, descent: None })
    }

    /// Takes samples until there are `n`, or as many as there are vertices.
    fn extend(&self, sampler: &mut Sampler, n: usize) -> Result<(), Error> {
        if !self.streams || self.observer.budget().spill().is_none() {
            let p = self.solver.n_vertices();
            check_memory(p, n.min(p), &self.observer.budget())?;
        }
        Ok(self.timed(|| sampler.extend_to(n))?)
    }

    fn take(&self, sampler: &mut Sampler, n: usize) -> Result<LandmarkDistances, Error> {
        self.extend(sampler, n)?;
        Ok(self.timed(|| sampler.distances(n))?)
    }

    /// The distances from some vertices, one column each.
    pub(super) fn columns(&self, vertices: &[usize]) -> Result<Matrix, Error> {
        check_memory(self.solver.n_vertices(), vertices.len(), &self.observer.budget())?;
        let sources: Vec<VertexId> = vertices.iter().copied().map(VertexId::from).collect();
        Ok(self.timed(|| self.solver.distance_columns(&sources))?)
    }

    /// The distances between all pairs of vertices.
    pub(super) fn all_pairs(&self) -> Result<DistanceMatrix, Error> {
        let p = self.solver.n_vertices();
        check_memory(p, p, &self.observer.budget())?;
        self.observer.begin("distances", p);
        Ok(self.timed(|| self.solver.distance_matrix())?)
    }

    /// The distances that a method with samples would measure.
    pub(super) fn sample_distances(&self) -> Result<LandmarkDistances, Error> {
        let n = self.samples.count_or(DEFAULT_COUNT);
        // The first sample is found by one run more.
        self.observer.begin("distances", n + 1);
        let mut sampler = self.timed(|| self.sampling.start(self.solver, self.first, self.seed))?;
        self.take(&mut sampler, n)
    }

    /// Counts the time of `work` as time spent on distances.
    fn timed<T>(&self, work: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let result = work();
        self.seconds.set(self.seconds.get() + start.elapsed().as_secs_f64());
        result
    }
}
