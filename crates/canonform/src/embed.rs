//! From a surface to coordinates.

use std::time::Instant;

use descriptors::{CanonicalForm, LaplaceSpectrum};
use geodesics::FirstSample;
use linalg::{LandmarkDistances, SparseSymmetric};
use nmds::{
    Embedding, KernelPcaOptions, NystromOptions, SmacofReport, SpectralBasis, SpectralOptions, classical,
    fmds, kernel_pca, landmark_mds, nystrom, smacof, spectral,
};
use surface::VertexId;
use surface::laplacian::Laplacian;

use crate::observer::Observed;
use crate::run::Run;
use crate::stress::measure;
use crate::{
    EmbedMethod, EmbedOptions, EmbedReport, Observer, PipelineError, SecondsReport, StressChoice, Surface,
};

/// An embedded surface.
#[derive(Debug, Clone)]
pub struct Embedded {
    /// Coordinates of the vertices of the repaired mesh.
    pub embedding: Embedding,
    /// Facts about the run.
    pub report: EmbedReport,
    /// Whether coordinates are lengths; the components of a kernel are not.
    has_unit: bool,
}

impl Embedded {
    /// The canonical form: the embedded surface, weighted by the areas of the mesh.
    ///
    /// # Errors
    /// [`PipelineError::Descriptor`] when the embedding is not three-dimensional.
    pub fn form(&self, surface: &Surface) -> Result<CanonicalForm, PipelineError> {
        let form = CanonicalForm::new(&self.embedding, surface.mesh())?;
        Ok(if self.has_unit { form } else { form.without_unit() })
    }
}

/// What a method made, and of what.
struct Outcome {
    embedding: Embedding,
    /// The samples, unless all vertices are.
    samples: Option<LandmarkDistances>,
    descent: Option<SmacofReport>,
}

impl From<(Embedding, LandmarkDistances)> for Outcome {
    fn from((embedding, samples): (Embedding, LandmarkDistances)) -> Self {
        Self { embedding, samples: Some(samples), descent: None }
    }
}

/// Embeds a surface: distances, then coordinates, then their stress. Every run of the geodesic solver
/// is a step that `observer` hears of.
///
/// # Errors
/// [`PipelineError::AllPairsTooLarge`], [`PipelineError::NoSuchVertex`], [`PipelineError::DroppedVertex`]
/// and those of the stages.
pub fn embed(
    surface: &Surface,
    options: &EmbedOptions,
    observer: &dyn Observer,
) -> Result<Embedded, PipelineError> {
    let mut seconds =
        SecondsReport { load: surface.load_seconds, repair: surface.repair_seconds, ..Default::default() };
    let first = match options.first_sample {
        FirstSample::Farthest => FirstSample::Farthest,
        FirstSample::Vertex(input) => FirstSample::Vertex(surface.repaired_vertex(input)?),
    };
    let start = Instant::now();
    let solver = options.geodesic.prepare(&surface.intrinsic)?;
    let solver = Observed { solver: solver.as_ref(), observer };
    let geodesic_seconds = start.elapsed().as_secs_f64();
    let mut run = Run { solver: &solver, options, first, observer, geodesic_seconds };
    let Outcome { embedding, samples, descent } = outcome(surface, &mut run)?;
    let elapsed = start.elapsed().as_secs_f64();
    seconds.geodesics = run.geodesic_seconds;
    seconds.embedding = elapsed - seconds.geodesics;
    seconds.total = seconds.load + seconds.repair + elapsed;

    let start = Instant::now();
    let has_unit = options.method.has_unit();
    let stress = match options.stress_against {
        _ if !has_unit || options.stress == StressChoice::Skip => None,
        Some(other) if other != options.geodesic => {
            let solver = other.prepare(&surface.intrinsic)?;
            let solver = Observed { solver: solver.as_ref(), observer };
            Some(measure(&embedding.coords, &solver, other, options, observer))
        }
        _ => Some(measure(&embedding.coords, &solver, options.geodesic, options, observer)),
    };
    seconds.stress = start.elapsed().as_secs_f64();

    let n_samples = samples.as_ref().map_or(embedding.n_points(), LandmarkDistances::n_landmarks);
    let sampling = samples.as_ref().map(|_| options.sampling.name());
    let samples = samples.map_or(Vec::new(), |distances| {
        distances.landmarks().iter().map(|&v| surface.input_vertex(VertexId::from(v)).0).collect()
    });
    let report = EmbedReport {
        method: options.method.name(),
        geodesic: options.geodesic.name(),
        sampling,
        regularization: options.method.regularization().map(|chosen| chosen.name()),
        n_vertices: surface.n_input_vertices(),
        n_faces: surface.input_faces.len(),
        n_embedded: embedding.n_points(),
        n_samples,
        rank: embedding.rank,
        dim: embedding.dim(),
        samples,
        eigenvalues: embedding.eigenvalues.clone(),
        negative_mass: embedding.negative_mass,
        empty_dimensions: embedding.dim() - embedding.positive_dims(),
        stress,
        descent: descent.map(Into::into),
        seconds,
        repair: surface.repaired.report.clone(),
    };
    Ok(Embedded { embedding, report, has_unit })
}

/// Runs the method: which distances it needs, and what it makes of them.
fn outcome(surface: &Surface, run: &mut Run<'_>) -> Result<Outcome, PipelineError> {
    let dim = run.options.dim;
    Ok(match run.options.method {
        EmbedMethod::Classical => {
            let embedding = classical(&run.all_pairs()?, dim)?;
            Outcome { embedding, samples: None, descent: None }
        }
        EmbedMethod::Nystrom { regularization } => {
            run.sampled(|distances| nystrom(distances, &NystromOptions { regularization, dim }))?.into()
        }
        EmbedMethod::Landmark => run.sampled(|distances| landmark_mds(distances, dim))?.into(),
        EmbedMethod::Spectral { eigenvectors, mu } => {
            let LaplaceSpectrum { values, vectors, masses, .. } =
                LaplaceSpectrum::new(&surface.intrinsic, eigenvectors)?;
            let basis = SpectralBasis { values: &values, vectors: &vectors, masses: &masses };
            run.sampled(|distances| spectral(distances, &basis, &SpectralOptions { mu, dim }))?.into()
        }
        EmbedMethod::Fmds => {
            let laplacian = Laplacian::new(&surface.intrinsic);
            let (p, masses) = (laplacian.n_vertices(), laplacian.masses());
            let stiffness = SparseSymmetric::from_entries(p, laplacian.stiffness_entries());
            run.sampled(|distances| fmds(distances, &stiffness, &masses, dim))?.into()
        }
        EmbedMethod::KernelPca { rank, bandwidth } => {
            run.sampled(|distances| kernel_pca(distances, &KernelPcaOptions { bandwidth, rank, dim }))?.into()
        }
        EmbedMethod::Smacof { regularization, descent } => {
            let (begun, samples) =
                run.sampled(|distances| nystrom(distances, &NystromOptions { regularization, dim }))?;
            let (embedding, report) = smacof(&begun.coords, &run.all_pairs()?, &descent)?;
            let embedding = Embedding { rank: begun.rank, ..embedding };
            Outcome { embedding, samples: Some(samples), descent: Some(report) }
        }
    })
}
