//! Measuring the distances that a method asks for.

use std::time::Instant;

use geodesics::{DistanceSolver, FirstSample, Sampler};
use linalg::{DistanceMatrix, LandmarkDistances};
use nmds::{Embedding, NmdsError, estimate_paper_stress};

use crate::stress::KnownRows;
use crate::{EmbedOptions, Observer, PipelineError, Samples};

/// Samples [`Samples::Auto`] starts from.
const AUTO_FIRST: usize = 10;

/// Samples [`Samples::Auto`] ends at.
const AUTO_LAST: usize = 640;

/// Doubling the samples must gain this share of the stress to be worth another doubling.
const AUTO_GAIN: f64 = 0.01;

/// One embedding under way: the surface's solver, and the time spent on distances.
pub(crate) struct Run<'a> {
    pub(crate) solver: &'a dyn DistanceSolver,
    pub(crate) options: &'a EmbedOptions,
    /// A vertex of the repaired mesh.
    pub(crate) first: FirstSample,
    pub(crate) observer: &'a dyn Observer,
    /// Seconds spent on distances so far.
    pub(crate) geodesic_seconds: f64,
}

impl Run<'_> {
    /// Takes samples and embeds by the distances from them.
    pub(crate) fn sampled(
        &mut self,
        embed: impl Fn(&LandmarkDistances) -> Result<Embedding, NmdsError>,
    ) -> Result<(Embedding, LandmarkDistances), PipelineError> {
        let expected = match self.options.samples {
            Samples::Count(n) => n,
            Samples::Auto => AUTO_LAST,
        };
        self.observer.begin("distances", expected);
        let (solver, sampling) = (self.solver, self.options.sampling);
        let mut sampler = self.timed(|run| sampling.start(solver, run.first, run.options.seed))?;
        match self.options.samples {
            Samples::Count(n) => {
                let distances = self.take(sampler.as_mut(), n)?;
                Ok((embed(&distances)?, distances))
            }
            Samples::Auto => self.enough(sampler.as_mut(), embed),
        }
    }

    /// Doubles the samples until that hardly lowers the stress on their own rows.
    fn enough(
        &mut self,
        sampler: &mut dyn Sampler,
        embed: impl Fn(&LandmarkDistances) -> Result<Embedding, NmdsError>,
    ) -> Result<(Embedding, LandmarkDistances), PipelineError> {
        let mut n = AUTO_FIRST;
        let mut embedding = embed(&self.take(sampler, n)?)?;
        loop {
            n *= 2;
            let more = self.take(sampler, n)?;
            let refined = embed(&more)?;
            let rows = KnownRows(&more);
            let stress = |e: &Embedding| estimate_paper_stress(&e.coords, &rows, more.landmarks()).value;
            let settled = stress(&embedding) <= (1.0 + AUTO_GAIN) * stress(&refined);
            if settled || more.n_landmarks() < n || n >= AUTO_LAST {
                return Ok((refined, more));
            }
            embedding = refined;
        }
    }

    fn take(&mut self, sampler: &mut dyn Sampler, n: usize) -> Result<LandmarkDistances, PipelineError> {
        self.timed(|_| {
            sampler.extend_to(n)?;
            Ok(sampler.distances(n)?)
        })
    }

    /// The distances between all pairs of vertices.
    pub(crate) fn all_pairs(&mut self) -> Result<DistanceMatrix, PipelineError> {
        let p = self.solver.n_vertices();
        self.options.check_memory(p, p)?;
        self.observer.begin("distances", p);
        self.timed(|run| Ok(run.solver.distance_matrix()?))
    }

    /// Counts the time of `work` as time spent on distances.
    fn timed<T, E>(&mut self, work: impl FnOnce(&Self) -> Result<T, E>) -> Result<T, E> {
        let start = Instant::now();
        let result = work(self);
        self.geodesic_seconds += start.elapsed().as_secs_f64();
        result
    }
}
