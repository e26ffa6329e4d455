//! Measuring the distances that an embedding method needs.

use std::fmt;
use std::str::FromStr;
use std::time::Instant;

use budget::{Budget, Exceeded};
use geodesics::{DistanceSolver, FirstSample, Sampler, Sampling, Source};
use linalg::{DistanceMatrix, LandmarkDistances};
use nmds::{Embedding, NmdsError, RowSample, estimate_stress};

use super::plan::{Plan, check_memory};
use super::stress::KnownRows;
use crate::error::Error;
use crate::observer::Observer;

/// Samples taken by default, as in the paper's Figure 4.
const DEFAULT_COUNT: usize = 100;

/// [`Samples::Auto`] starts from this many samples.
const AUTO_FIRST: usize = 10;

/// [`Samples::Auto`] stops at this many samples.
const AUTO_LAST: usize = 640;

/// [`Samples::Auto`] stops when doubling the samples reduces the stress by less than this share.
const AUTO_GAIN: f64 = 0.01;

/// How many samples are taken; written as a number or as `auto`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Samples {
    /// This many.
    Count(usize),
    /// Doubled from 10 to at most 640, until the stress measured on the samples falls by less than 1 %.
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
    Plan::new(n_vertices, samples.count_or(AUTO_LAST))
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
}

impl Measurement<'_> {
    /// Takes samples and embeds by the distances from them.
    pub(super) fn sampled(
        &mut self,
        embed: impl Fn(&LandmarkDistances) -> Result<Embedding, NmdsError>,
    ) -> Result<(Embedding, LandmarkDistances), Error> {
        let (solver, sampling) = (self.solver, self.sampling);
        self.observer.begin("distances", self.samples.count_or(AUTO_LAST));
        let mut sampler = self.timed(|m| sampling.start(solver, m.first, m.seed))?;
        if self.streams && self.budget.spill().is_some() {
            let store = plan(solver.n_vertices(), self.samples).store(&self.budget)?;
            self.timed(|_| sampler.move_to(store))?;
        }
        match self.samples {
            Samples::Count(n) => {
                self.extend(sampler.as_mut(), n)?;
                let distances = self.timed(|_| sampler.into_distances(n))?;
                self.budget.check()?;
                let embedding = embed(&distances)?;
                self.budget.check()?;
                Ok((embedding, distances))
            }
            Samples::Auto => self.enough(sampler.as_mut(), embed),
        }
    }

    /// Doubles the samples until that hardly reduces the stress measured on their own rows.
    fn enough(
        &mut self,
        sampler: &mut dyn Sampler,
        embed: impl Fn(&LandmarkDistances) -> Result<Embedding, NmdsError>,
    ) -> Result<(Embedding, LandmarkDistances), Error> {
        let mut n = AUTO_FIRST;
        let mut embedding = embed(&self.take(sampler, n)?)?;
        loop {
            n *= 2;
            let more = self.take(sampler, n)?;
            let refined = embed(&more)?;
            let rows = KnownRows(&more);
            // All landmarks, so that both are compared on the same rows.
            let sample = RowSample::of_rows(more.landmarks().to_vec(), more.n_points());
            let stress = |e: &Embedding| Ok::<_, Error>(estimate_stress(&e.coords, &rows, &sample)?.value);
            let settled = stress(&embedding)? <= (1.0 + AUTO_GAIN) * stress(&refined)?;
            if settled || more.n_landmarks() < n || n >= AUTO_LAST {
                return Ok((refined, more));
            }
            embedding = refined;
        }
    }

    /// Takes samples until there are `n`, or as many as there are vertices.
    fn extend(&mut self, sampler: &mut dyn Sampler, n: usize) -> Result<(), Error> {
        if !self.streams || self.budget.spill().is_none() {
            let p = self.solver.n_vertices();
            check_memory(p, n.min(p), &self.budget)?;
        }
        Ok(self.timed(|_| sampler.extend_to(n))?)
    }

    fn take(&mut self, sampler: &mut dyn Sampler, n: usize) -> Result<LandmarkDistances, Error> {
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
        self.take(sampler.as_mut(), self.samples.count_or(DEFAULT_COUNT))
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
