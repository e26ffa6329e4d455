//! Choice of landmarks.

mod sampler;
mod spread;

use surface::VertexId;

pub use sampler::Sampler;
pub use spread::SpreadSamples;

/// A rule for choosing landmarks. Ties go to the lowest vertex, and the seed determines what is drawn at random, for any
/// number of threads.
///
/// ```
/// use canonform_geodesics::{Dijkstra, FirstSample, Sampling};
/// use mesh::shapes;
///
/// let solver = Dijkstra::new(&shapes::icosphere(2).intrinsic(), &());
/// for sampling in Sampling::ALL {
///     let mut sampler = sampling.start(&solver, FirstSample::default(), 7)?;
///     sampler.extend_to(20)?;
///     assert_eq!(sampler.distances(20)?.n_landmarks(), 20);
/// }
/// # Ok::<(), canonform_geodesics::GeodesicError>(())
/// ```
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize, strum::IntoStaticStr,
)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum Sampling {
    /// Each sample is the vertex farthest from the earlier ones
    ///
    /// Farthest point sampling, Procedure 1 of the paper.
    ///
    /// | paper | here | shape | meaning |
    /// |---|---|---|---|
    /// | `r_i` | `landmarks()` of the result | n | the samples |
    /// | `F` | `matrix()` of the result | p x n | distances |
    ///
    /// * It covers the surface at most twice as coarsely as the best `n` vertices (Hochbaum and Shmoys 1985,
    ///   `hochbaum1985`).
    /// * It ends early, with fewer landmarks than requested, if every vertex coincides with one.
    ///
    /// Cost: one run of the solver per landmark. On several threads, the runs are parallel if the solver can prune: about
    /// `1/2 + ... + 1/n` additional runs choose the landmarks in advance. The result is the same.
    #[default]
    Farthest,
    /// Vertices drawn uniformly at random
    ///
    /// The baseline: every set of n vertices is equally likely.
    ///
    /// Cost: one run of the solver per landmark, in parallel; `O(p)` to start.
    Random,
    /// Each sample is the vertex whose squared distances to the earlier ones vary least
    ///
    /// Incremental sampling by variance ("Min-Var"; Yu, Zhao, Zhang and Yang 2012, `yu2012`): two landmarks are drawn at
    /// random, then each is the vertex `j` with the least variance of the squared distances `E_ij` to the landmarks `i` so
    /// far.
    ///
    /// A vertex with equal squared distances to all landmarks is central. So the least variance avoids the tips of a
    /// surface and soon takes neighbors of landmarks: the samples are close together, and the stress is far above that
    /// of farthest point sampling.
    ///
    /// Cost: one run of the solver and `O(p)` per landmark, as means and variances are updated (Welford 1962).
    MinVariance,
    /// Each sample is the vertex whose squared distances to the earlier ones vary most
    ///
    /// The opposite rule, for comparison.
    MaxVariance,
}

/// The first landmark.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FirstSample {
    /// The vertex farthest from vertex 0, a tip of the surface, for [`Sampling::Farthest`]; a random one for the other
    /// rules.
    #[default]
    Farthest,
    /// This vertex.
    Vertex(VertexId),
}

impl Sampling {
    /// All rules.
    pub const ALL: [Self; 4] = [Self::Farthest, Self::Random, Self::MinVariance, Self::MaxVariance];

    /// The name on the command line and in records.
    pub fn name(self) -> &'static str {
        self.into()
    }
}

#[cfg(test)]
mod tests {
    use mesh::TriMesh;
    use mesh::shapes::{disjoint, grid, icosphere};
    use surface::VertexId;

    use super::*;
    use crate::dijkstra::Dijkstra;
    use crate::error::GeodesicError;
    use crate::solver::DistanceSolver;

    const ALL: [Sampling; 4] = Sampling::ALL;

    fn solver(mesh: &TriMesh) -> Dijkstra {
        Dijkstra::new(&mesh.intrinsic(), &())
    }

    fn sample(sampling: Sampling, first: FirstSample, seed: u64, n: usize) -> Vec<usize> {
        let solver = solver(&icosphere(2));
        let mut sampler = sampling.start(&solver, first, seed).unwrap();
        sampler.extend_to(n).unwrap();
        sampler.distances(n).unwrap().landmarks().to_vec()
    }

    #[test]
    fn more_landmarks_begin_with_the_same_ones_and_columns_are_their_distances() {
        let solver = solver(&icosphere(2));
        for sampling in ALL {
            let few = sample(sampling, FirstSample::default(), 3, 7);
            let mut sampler = sampling.start(&solver, FirstSample::default(), 3).unwrap();
            for n in [1, 2, 3, 7, 20] {
                sampler.extend_to(n).unwrap();
            }
            assert_eq!(sampler.distances(7).unwrap().landmarks(), few, "{sampling:?}");
            let many = sampler.distances(20).unwrap();
            assert_eq!(many.n_landmarks(), 20);
            for (i, landmark) in many.landmarks().iter().enumerate() {
                assert_eq!(
                    many.column(i).unwrap(),
                    solver.distances(VertexId::from(*landmark)).unwrap(),
                    "{sampling:?}"
                );
            }
        }
    }

    #[test]
    fn the_first_landmark_can_be_given_the_seed_draws_the_others_and_none_comes_twice() {
        for sampling in ALL {
            let chosen = sample(sampling, FirstSample::Vertex(VertexId(17)), 3, 5);
            assert_eq!(chosen[0], 17, "{sampling:?}");
            let [a, b, c] = [3, 3, 4].map(|seed| sample(sampling, FirstSample::default(), seed, 6));
            assert_eq!((a == b, a == c), (true, sampling == Sampling::Farthest), "{sampling:?}");
            let mut all = sample(sampling, FirstSample::default(), 1, 1000);
            all.sort_unstable();
            assert_eq!(all, (0..162).collect::<Vec<_>>(), "{sampling:?}");
        }
    }

    #[test]
    fn errors_name_what_cannot_be_sampled() {
        let parts = solver(&disjoint(&[grid(3, 3, 1.0), grid(3, 3, 1.0)]));
        let empty = solver(&TriMesh { positions: vec![], faces: vec![] });
        let whole = solver(&icosphere(1));
        for sampling in ALL {
            let split = sampling.start(&parts, FirstSample::default(), 1).and_then(|mut s| s.extend_to(2));
            assert!(matches!(split, Err(GeodesicError::Disconnected { unreached: 9, .. })), "{sampling:?}");
            let beyond = FirstSample::Vertex(VertexId(42));
            let fault = sampling.start(&whole, beyond, 1).map(|_| ()).unwrap_err();
            assert_eq!(fault, GeodesicError::NoSuchVertex { vertex: VertexId(42), n_vertices: 42 });
            assert!(sampling.start(&empty, FirstSample::default(), 1).is_err());
            let none = sampling.start(&whole, FirstSample::default(), 1).unwrap().distances(0);
            assert_eq!(none.unwrap_err(), GeodesicError::NoSamples);
        }
    }

    #[test]
    fn all_vertices_are_equally_likely() {
        let solver = Dijkstra::of_hops(&grid(4, 3, 1.0).intrinsic(), &());
        let p = solver.n_vertices();
        let (runs, n) = (3000, 4);
        let mut taken = vec![0usize; p];
        for seed in 0..runs {
            let mut sampler = Sampling::Random.start(&solver, FirstSample::default(), seed).unwrap();
            sampler.extend_to(n).unwrap();
            for landmark in sampler.distances(n).unwrap().landmarks() {
                taken[*landmark] += 1;
            }
        }
        // Each count is binomial; a deviation of five sigmas never happens.
        let share = n as f64 / p as f64;
        let (mean, deviation) = (runs as f64 * share, (runs as f64 * share * (1.0 - share)).sqrt());
        assert!(taken.iter().all(|count| (*count as f64 - mean).abs() < 5.0 * deviation), "{taken:?}");
    }

    #[test]
    fn every_landmark_has_the_least_or_greatest_variance() {
        let solver = Dijkstra::new(&icosphere(2).intrinsic(), &());
        for (sampling, sign) in [(Sampling::MinVariance, 1.0), (Sampling::MaxVariance, -1.0)] {
            let mut sampler = sampling.start(&solver, FirstSample::default(), 5).unwrap();
            sampler.extend_to(12).unwrap();
            let distances = sampler.distances(12).unwrap();
            for n in 2..12 {
                let spread = |v: usize| {
                    let squares: Vec<f64> = (0..n).map(|i| distances.column(i).unwrap()[v].powi(2)).collect();
                    let mean = squares.iter().sum::<f64>() / n as f64;
                    sign * squares.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / n as f64
                };
                let taken = &distances.landmarks()[..n];
                let free = (0..162).filter(|v| !taken.contains(v));
                let best = free.map(spread).fold(f64::INFINITY, f64::min);
                assert!(spread(distances.landmarks()[n]) <= best + 1e-12, "{sampling:?} {n}");
            }
        }
    }
}
