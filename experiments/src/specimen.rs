//! The shapes that several experiments examine closely, with cached measurements.

use std::sync::Arc;

use anyhow::{Result, bail};
use base::Cache;
use canonform::DescribeOptions;
use canonform::embed::{EmbedMethod, FormOptions, Samples};
use descriptors::LaplaceSpectrum;
use geodesics::{DistanceSolver, FirstSample, Method, Sampling};
use linalg::{DistanceMatrix, LandmarkDistances};
use nmds::{Embedding, Reconstruction, classical, paper_stress, sample_rows};
use surface::VertexId;

use crate::collection::{LabeledSurface, SurfaceCollection};

/// The classes of Figures 3 and 5 to 9 of the paper, in its order.
const PAPER: [&str; 2] = ["david", "cat"];

/// Dimensions of canonical forms.
pub(crate) const DIM: usize = 3;

/// A shape, and what has been measured on it.
pub(crate) struct Specimen<'a> {
    pub(crate) shape: &'a LabeledSurface,
    all_pairs: Cache<Method, Arc<DistanceMatrix>>,
    optimum: Cache<Method, Arc<Optimum>>,
    spectrum: Cache<usize, Arc<LaplaceSpectrum>>,
    reconstruction: Cache<(usize, VertexId), Arc<Reconstruction>>,
}

/// Classical scaling of all pairs.
pub(crate) struct Optimum {
    pub(crate) embedding: Embedding,
    pub(crate) stress: f64,
}

/// The first david and the first cat; in other collections, the first shapes of two classes.
pub(crate) fn specimens(collection: &SurfaceCollection) -> Vec<Specimen<'_>> {
    let first = |class: &str| collection.shapes.iter().find(|shape| shape.label == class);
    let mut chosen: Vec<&LabeledSurface> = PAPER.into_iter().filter_map(first).collect();
    if chosen.len() < PAPER.len() {
        chosen = collection.first_of_each_class(1).into_iter().take(PAPER.len()).collect();
    }
    chosen.into_iter().map(Specimen::new).collect()
}

impl<'a> Specimen<'a> {
    pub(crate) fn new(shape: &'a LabeledSurface) -> Self {
        Self {
            shape,
            all_pairs: Cache::new(usize::MAX),
            optimum: Cache::new(usize::MAX),
            spectrum: Cache::new(usize::MAX),
            reconstruction: Cache::new(usize::MAX),
        }
    }

    pub(crate) fn n_vertices(&self) -> usize {
        self.shape.surface.mesh().n_vertices()
    }

    fn solver(&self, method: Method) -> Result<Box<dyn DistanceSolver>> {
        Ok(method.prepare(self.shape.surface.intrinsic(), &())?)
    }

    /// The distances between all pairs of vertices.
    pub(crate) fn all_pairs(&self, method: Method) -> Result<Arc<DistanceMatrix>> {
        self.all_pairs.get_or_put(&method, || {
            let p = self.n_vertices();
            if p.saturating_mul(p) > canonform::embed::DISTANCES_LIMIT / size_of::<f64>() {
                bail!(
                    "{}: this experiment needs the distances of all pairs, {} GiB for {p} vertices; use shapes of at \
                     most 23,000 vertices",
                    self.shape.name,
                    (p * p * size_of::<f64>()) >> 30
                );
            }
            Ok(Arc::new(self.solver(method)?.distance_matrix()?))
        })
    }

    /// Classical scaling of all pairs, the optimum of strain.
    pub(crate) fn optimum(&self, method: Method) -> Result<Arc<Optimum>> {
        self.optimum.get_or_put(&method, || {
            let all = self.all_pairs(method)?;
            let embedding = classical(&all, DIM, &())?;
            let stress = paper_stress(&embedding.coords, all.as_ref())?;
            Ok(Arc::new(Optimum { embedding, stress }))
        })
    }

    /// Eigenfunctions of the surface.
    pub(crate) fn spectrum(&self, n_eigenvectors: usize) -> Result<Arc<LaplaceSpectrum>> {
        self.spectrum.get_or_put(&n_eigenvectors, || {
            Ok(Arc::new(LaplaceSpectrum::new(self.shape.surface.intrinsic(), n_eigenvectors, &())?))
        })
    }

    /// The reconstruction of all squared distances from `n` farthest samples, for the default distances.
    pub(crate) fn reconstruction(&self, n: usize, first: VertexId) -> Result<Arc<Reconstruction>> {
        self.reconstruction.get_or_put(&(n, first), || {
            let samples = self.nested(Method::default(), Sampling::Farthest, first, &[n])?;
            let all = self.all_pairs(Method::default())?;
            Ok(Arc::new(Reconstruction::new(&samples[0], all.as_ref())?))
        })
    }

    /// Distinct first samples of repeated runs, drawn with `seed`.
    pub(crate) fn first_samples(&self, runs: usize, seed: u64) -> Vec<VertexId> {
        sample_rows(self.n_vertices(), runs, seed).into_iter().map(VertexId::from).collect()
    }

    /// For each n of `counts`, the distances from the first n samples of the sequence that begins with `first`.
    pub(crate) fn nested(
        &self,
        method: Method,
        sampling: Sampling,
        first: VertexId,
        counts: &[usize],
    ) -> Result<Vec<LandmarkDistances>> {
        let solver = self.solver(method)?;
        let seed = u64::from(first.0);
        let mut sampler = sampling.start(solver.as_ref(), FirstSample::Vertex(first), seed)?;
        sampler.extend_to(counts.iter().copied().max().unwrap_or(0))?;
        counts.iter().map(|&n| Ok(sampler.distances(n)?)).collect()
    }
}

/// The options of the paper's method.
pub(crate) fn low_rank(samples: usize, rank: usize, seed: u64) -> FormOptions {
    FormOptions {
        samples: Samples::Count(samples),
        method: EmbedMethod::low_rank(rank),
        seed,
        ..FormOptions::default()
    }
}

/// Descriptions by forms with these options.
pub(crate) fn describing(form: FormOptions) -> DescribeOptions {
    DescribeOptions { form, ..DescribeOptions::default() }
}
