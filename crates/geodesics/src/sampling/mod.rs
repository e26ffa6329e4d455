//! Choice of landmarks.

mod columns;
mod farthest;
mod random;
mod sampler;
mod spread;
mod variance;

use crate::error::GeodesicError;
use crate::solver::DistanceSolver;
pub use farthest::{FarthestPointSampler, farthest_point_sampling};
pub use random::RandomSampler;
pub use sampler::{FirstSample, Sampler};
pub use spread::SpreadSamples;
pub use variance::{Variance, VarianceSampler};

/// A rule for choosing landmarks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Sampling {
    /// [`FarthestPointSampler`]: each the farthest from those before it.
    #[default]
    Farthest,
    /// [`RandomSampler`]: all vertices are equally likely.
    Random,
    /// [`VarianceSampler`]: each the vertex whose squared distances to those before it vary least, or most.
    #[serde(untagged)]
    Incremental(Variance),
}

impl Sampling {
    /// All rules.
    pub const ALL: [Self; 4] = [
        Self::Farthest,
        Self::Random,
        Self::Incremental(Variance::Least),
        Self::Incremental(Variance::Greatest),
    ];

    /// The name on the command line and in records.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.entry().0
    }

    /// How landmarks are chosen, in one line.
    #[must_use]
    pub fn summary(self) -> &'static str {
        self.entry().1
    }

    fn entry(self) -> (&'static str, &'static str) {
        match self {
            Self::Farthest => ("farthest", "Each sample is the vertex farthest from the earlier ones"),
            Self::Random => ("random", "Vertices drawn uniformly at random"),
            Self::Incremental(Variance::Least) => (
                "min-variance",
                "Each sample is the vertex whose squared distances to the earlier ones vary least",
            ),
            Self::Incremental(Variance::Greatest) => (
                "max-variance",
                "Each sample is the vertex whose squared distances to the earlier ones vary most",
            ),
        }
    }

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
    ) -> Result<Box<dyn Sampler + 'a>, GeodesicError> {
        Ok(match self {
            Self::Farthest => Box::new(FarthestPointSampler::new(solver, first)?),
            Self::Random => Box::new(RandomSampler::new(solver, first, seed)?),
            Self::Incremental(variance) => Box::new(VarianceSampler::new(solver, first, seed, variance)?),
        })
    }
}

#[cfg(test)]
mod tests {
    use linalg::LandmarkDistances;
    use mesh::TriMesh;
    use mesh::shapes::{disjoint, grid, icosphere};
    use surface::VertexId;

    use super::*;
    use crate::dijkstra::Dijkstra;

    const ALL: [Sampling; 4] = Sampling::ALL;

    fn solver(mesh: &TriMesh) -> Dijkstra {
        Dijkstra::new(&mesh.intrinsic())
    }

    fn sample(sampling: Sampling, first: FirstSample, seed: u64, n: usize) -> LandmarkDistances {
        let solver = solver(&icosphere(2));
        let mut sampler = sampling.start(&solver, first, seed).unwrap();
        sampler.extend_to(n).unwrap();
        sampler.distances(n).unwrap()
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
            assert_eq!(sampler.distances(7).unwrap(), few, "{sampling:?}");
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
    fn the_first_landmark_can_be_given() {
        for sampling in ALL {
            let chosen = sample(sampling, FirstSample::Vertex(VertexId(17)), 3, 5);
            assert_eq!(chosen.landmarks()[0], 17, "{sampling:?}");
        }
    }

    #[test]
    fn the_seed_determines_random_choices() {
        for sampling in ALL {
            let [a, b, c] = [3, 3, 4].map(|seed| sample(sampling, FirstSample::default(), seed, 6));
            assert_eq!(a, b, "{sampling:?}");
            assert_eq!(a == c, sampling == Sampling::Farthest, "{sampling:?}");
        }
    }

    #[test]
    fn the_function_gives_the_same_landmarks_as_the_sampler() {
        let solver = solver(&icosphere(2));
        let direct = farthest_point_sampling(&solver, 9, FirstSample::default()).unwrap();
        assert_eq!(sample(Sampling::Farthest, FirstSample::default(), 0, 9), direct);
    }

    #[test]
    fn there_are_never_more_landmarks_than_vertices() {
        for sampling in ALL {
            let all = sample(sampling, FirstSample::default(), 1, 1000);
            let mut landmarks = all.landmarks().to_vec();
            landmarks.sort_unstable();
            assert_eq!(landmarks, (0..162).collect::<Vec<_>>(), "{sampling:?}");
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
            assert_eq!(none, Err(GeodesicError::NoSamples));
        }
    }
}
