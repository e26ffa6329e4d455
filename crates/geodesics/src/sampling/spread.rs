//! More samples than distances are kept for.

use linalg::LandmarkDistances;
use surface::VertexId;

use super::sampler::farthest;
use crate::error::GeodesicError;
use crate::solver::DistanceSolver;

/// Samples spread evenly over a surface, and the cells of vertices around them.
#[derive(Debug, Clone, PartialEq)]
pub struct SpreadSamples {
    /// The samples, the landmarks first; each further one is the vertex farthest from those before it.
    pub samples: Vec<usize>,
    /// For every vertex, the position in `samples` of the nearest one, the first in case of a tie.
    pub nearest: Vec<usize>,
}

impl SpreadSamples {
    /// Continues farthest point sampling from some landmarks up to `n` samples, without keeping their distances; fewer if
    /// every vertex coincides with one, and never fewer than the landmarks.
    ///
    /// Cost: much less than a run of the solver for each sample if the solver can [prune](DistanceSolver::prunes), since a
    /// front then stops where other samples are nearer; and `O(p n)`.
    ///
    /// ```
    /// use canonform_geodesics::{FirstSample, Method, Sampling, SpreadSamples};
    /// use mesh::shapes;
    ///
    /// let solver = Method::default().prepare(shapes::icosphere(3).intrinsic(), &())?;
    /// let sampler = Sampling::Farthest.start(solver.as_ref(), FirstSample::default(), 0)?;
    /// let few = sampler.into_distances(10)?;
    /// let many = SpreadSamples::new(solver.as_ref(), &few, 100)?;
    /// assert_eq!(many.samples.len(), 100);
    /// assert!(many.samples.starts_with(few.landmarks()));
    /// # Ok::<(), canonform_geodesics::GeodesicError>(())
    /// ```
    ///
    /// # Errors
    /// [`GeodesicError::Exceeded`]; [`GeodesicError::Matrix`] if distances are in a file that cannot be read.
    pub fn new(
        solver: &dyn DistanceSolver,
        distances: &LandmarkDistances,
        n: usize,
    ) -> Result<Self, GeodesicError> {
        let n_vertices = solver.n_vertices();
        let mut samples = distances.landmarks().to_vec();
        let mut gaps = vec![f64::INFINITY; n_vertices];
        let mut nearest = vec![0; n_vertices];
        let mut lower = |gaps: &mut [f64], lowered: &[f64], sample: usize| {
            for ((gap, owner), lowered) in gaps.iter_mut().zip(&mut nearest).zip(lowered) {
                if *lowered < *gap {
                    (*gap, *owner) = (*lowered, sample);
                }
            }
        };
        for sample in 0..samples.len() {
            lower(&mut gaps, &distances.column(sample)?, sample);
        }
        let mut lowered = vec![0.0; n_vertices];
        while samples.len() < n.min(n_vertices) {
            let next = farthest(&gaps);
            if gaps[next] == 0.0 {
                break;
            }
            lowered.copy_from_slice(&gaps);
            solver.lower(VertexId::from(next), &mut lowered)?;
            lower(&mut gaps, &lowered, samples.len());
            samples.push(next);
        }
        Ok(Self { samples, nearest })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dijkstra::Dijkstra;
    use crate::sampling::{FirstSample, Sampling};
    use mesh::shapes::icosphere;

    #[test]
    fn the_samples_are_those_of_farthest_point_sampling() {
        let solver = Dijkstra::new(&icosphere(3).intrinsic(), &());
        let [few, all] = [5, 60].map(|n| {
            let sampler = Sampling::Farthest.start(&solver, FirstSample::default(), 0).unwrap();
            sampler.into_distances(n).unwrap()
        });
        let spread = SpreadSamples::new(&solver, &few, 60).unwrap();
        assert_eq!(spread.samples, all.landmarks());
        // At least the landmarks and at most all vertices.
        let samples = |n| SpreadSamples::new(&solver, &few, n).unwrap().samples;
        assert_eq!((samples(2), samples(1000).len()), (few.landmarks().to_vec(), solver.n_vertices()));
        for v in 0..solver.n_vertices() {
            let gap = |i: usize| all.column(i).unwrap()[v];
            let least = (0..60).map(gap).fold(f64::INFINITY, f64::min);
            assert_eq!(gap(spread.nearest[v]), least);
        }
    }
}
