//! Distances that a function measures.

use std::fmt;

use base::{Budget, Exceeded, Observer};
use surface::VertexId;

use crate::solver::DistanceSolver;
use crate::source::Source;

/// Any distances: a function that writes the distances from one point to all others stands for the surface. So samplers and
/// embeddings take distances in a graph, travel times, or the distances of another program.
///
/// The function is called once for each source, from several threads. Distances are symmetric and not negative; NaN counts as
/// infinite, where nothing leads.
///
/// The canonical form of a graph, a ring of 60 stations that take a minute each:
///
/// ```
/// use canonform_geodesics::{DistanceOracle, FirstSample, Sampling};
/// use surface::VertexId;
///
/// let stations = 60;
/// let minutes = DistanceOracle::new(stations, |from: VertexId, to: &mut [f64]| {
///     for (station, minutes) in to.iter_mut().enumerate() {
///         let apart = station.abs_diff(from.index());
///         *minutes = apart.min(stations - apart) as f64;
///     }
/// }, &());
/// let mut sampler = Sampling::Farthest.start(&minutes, FirstSample::default(), 0)?;
/// sampler.extend_to(20)?;
/// let landmarks = sampler.distances(20)?;
/// assert_eq!((landmarks.n_points(), landmarks.max()), (60, 30.0));
/// // Next: `nmds::nystrom(&landmarks, ...)`, and `descriptors::CanonicalForm::from_points`.
/// # Ok::<(), canonform_geodesics::GeodesicError>(())
/// ```
#[derive(Clone)]
pub struct DistanceOracle<F> {
    n_points: usize,
    measure: F,
    budget: Budget,
}

impl<F: Fn(VertexId, &mut [f64]) + Send + Sync> DistanceOracle<F> {
    /// `measure(from, to)` writes the distances from the point `from` to all points. The budget of the observer is
    /// checked before every call of it.
    pub fn new(n_points: usize, measure: F, observer: &dyn Observer) -> Self {
        Self { n_points, measure, budget: observer.budget() }
    }
}

impl<F> fmt::Debug for DistanceOracle<F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("DistanceOracle").field("n_points", &self.n_points).finish_non_exhaustive()
    }
}

impl<F: Fn(VertexId, &mut [f64]) + Send + Sync> DistanceSolver for DistanceOracle<F> {
    fn n_vertices(&self) -> usize {
        self.n_points
    }

    fn budget(&self) -> Budget {
        self.budget.clone()
    }

    fn solve_into(&self, sources: &[Source], max_distance: f64, out: &mut [f64]) -> Result<(), Exceeded> {
        assert_eq!(out.len(), self.n_points, "one distance per point");
        out.fill(f64::INFINITY);
        let mut row = vec![f64::INFINITY; self.n_points];
        for &(vertex, offset) in sources.iter().flat_map(Source::reach) {
            self.budget.check()?;
            assert!(vertex.index() < self.n_points, "point {vertex} of {}", self.n_points);
            row.fill(f64::INFINITY);
            (self.measure)(vertex, &mut row);
            // `min` ignores NaN.
            out.iter_mut().zip(&row).for_each(|(nearest, d)| *nearest = nearest.min(offset + d));
        }
        out.iter_mut().filter(|d| **d > max_distance).for_each(|d| *d = f64::INFINITY);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use mesh::shapes;

    use super::*;
    use crate::{Dijkstra, FirstSample, Sampling, SurfacePoint};

    #[test]
    fn an_oracle_that_asks_a_solver_is_that_solver() {
        let mesh = shapes::icosphere(2).intrinsic();
        let solver = Dijkstra::new(&mesh, &());
        let oracle = DistanceOracle::new(
            mesh.n_vertices(),
            |from, to: &mut [f64]| {
                solver.distances_into(from, to).unwrap();
            },
            &(),
        );
        let face = SurfacePoint::Face { face: surface::FaceId(9), barycentric: [0.2, 0.3, 0.5] };
        let sources = [Source::vertex(VertexId(3)), Source::new(&mesh, face).unwrap()];
        for limit in [f64::INFINITY, 0.7] {
            let [mut found, mut expected] = [(); 2].map(|()| vec![0.0; mesh.n_vertices()]);
            oracle.solve_into(&sources, limit, &mut found).unwrap();
            solver.solve_into(&sources, limit, &mut expected).unwrap();
            for (found, expected) in found.iter().zip(&expected) {
                assert!(found == expected || (found - expected).abs() < 1e-12);
            }
        }
        let samples = |solver: &dyn DistanceSolver| {
            let mut sampler = Sampling::Farthest.start(solver, FirstSample::default(), 0).unwrap();
            sampler.extend_to(12).unwrap();
            sampler.distances(12).unwrap()
        };
        assert_eq!(samples(&oracle).landmarks(), samples(&solver).landmarks());
    }

    #[test]
    fn distances_that_are_missing_are_infinite_and_budgets_are_kept() {
        let measure = |_, to: &mut [f64]| to[..2].copy_from_slice(&[1.0, f64::NAN]);
        let oracle = DistanceOracle::new(3, measure, &());
        assert_eq!(oracle.distances(VertexId(0)).unwrap(), [1.0, f64::INFINITY, f64::INFINITY]);
        let late = DistanceOracle::new(3, measure, &Budget::unlimited().with_time(Duration::ZERO));
        assert!(late.distances(VertexId(0)).is_err());
    }
}
