//! Facts about an embedding.

use mesh::{InputMap, RepairReport};
use nmds::{Embedding, SamplesReport, SmacofReport};
use serde::Serialize;
use surface::VertexId;

use super::options::FormOptions;
use super::stress::StressReport;

/// Facts about an embedding; `canonform embed --json` prints them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EmbedReport {
    /// Name of the method.
    pub method: &'static str,
    /// Name of the method that measured the distances.
    pub geodesic: &'static str,
    /// How samples were taken; `None` for classical scaling.
    pub sampling: Option<&'static str>,
    /// Name of the regularization, for methods that have one.
    pub regularization: Option<&'static str>,
    /// Vertices of the input.
    pub n_vertices: usize,
    /// Faces of the input.
    pub n_faces: usize,
    /// Vertices that were embedded, after the repair.
    pub n_embedded: usize,
    /// Number of samples; all vertices for classical scaling.
    pub n_samples: usize,
    /// Eigenpairs of the sample matrix used (columns, for the CUR decomposition).
    pub rank: usize,
    /// Dimensions of the embedding.
    pub dim: usize,
    /// The samples, as vertices of the input; empty for classical scaling.
    pub samples: Vec<u32>,
    /// Eigenvalues of the embedding, descending, in squared mesh units.
    pub eigenvalues: Vec<f64>,
    /// Share of negative eigenvalues among those computed.
    pub negative_mass: f64,
    /// Dimensions without a positive eigenvalue; their coordinates are zero.
    pub empty_dimensions: usize,
    /// The stress, unless it was not measured or the coordinates have no unit.
    pub stress: Option<StressReport>,
    /// How the number of samples was found; `None` if it was given.
    pub auto: Option<SamplesReport>,
    /// How SMACOF reduced the stress.
    pub descent: Option<SmacofReport>,
    /// Wall-clock seconds.
    pub seconds: SecondsReport,
    /// What was repaired.
    pub repair: RepairReport,
}

impl EmbedReport {
    /// The facts about an embedding by distances from `landmarks`, without its stress and what came before it.
    pub(super) fn new(
        options: &FormOptions,
        map: &InputMap,
        embedding: &Embedding,
        landmarks: &[usize],
        seconds: SecondsReport,
    ) -> Self {
        let is_sampled = options.method.is_sampled();
        let samples = if is_sampled { landmarks } else { &[] };
        Self {
            method: options.method.name(),
            geodesic: options.geodesic.name(),
            sampling: is_sampled.then(|| options.sampling.name()),
            regularization: options.method.regularization().map(|chosen| chosen.name()),
            n_vertices: map.report.input_vertices,
            n_faces: map.report.input_faces,
            n_embedded: embedding.n_points(),
            n_samples: if is_sampled { samples.len() } else { embedding.n_points() },
            rank: embedding.rank,
            dim: embedding.dim(),
            samples: samples.iter().map(|&v| map.remap.to_old(VertexId::from(v)).0).collect(),
            eigenvalues: embedding.eigenvalues.clone(),
            negative_mass: embedding.negative_mass,
            empty_dimensions: embedding.dim() - embedding.positive_dims(),
            stress: None,
            auto: None,
            descent: None,
            seconds,
            repair: map.report.clone(),
        }
    }
}

/// Wall-clock seconds of the stages of an embedding.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct SecondsReport {
    /// Reading the file.
    pub load: f64,
    /// Repair and connectivity.
    pub repair: f64,
    /// Preparing the solver, sampling and distances.
    pub geodesics: f64,
    /// Linear algebra.
    pub embedding: f64,
    /// Measuring the stress; not part of `total`, since an embedding does not need it.
    pub stress: f64,
    /// Everything from the file to the coordinates.
    pub total: f64,
}
