//! From a surface to coordinates.

use std::time::Instant;

use descriptors::CanonicalForm;
use geodesics::{DistanceSolver, FarthestPointSampler, FirstSample};
use linalg::{DistanceMatrix, LandmarkDistances};
use mesh::{RepairReport, VertexId};
use nmds::{
    Embedding, KernelPcaOptions, NystromOptions, classical, estimate_paper_stress, kernel_pca, nystrom,
};
use serde::Serialize;

use crate::observer::Observed;
use crate::stress::{KnownRows, MarchedRows, measure};
use crate::{EmbedMethod, EmbedOptions, Observer, PipelineError, Samples, StressReport, Surface};

/// Samples [`Samples::Auto`] starts from.
const AUTO_FIRST: usize = 10;

/// Samples [`Samples::Auto`] ends at.
const AUTO_LAST: usize = 640;

/// Doubling the samples must gain this share of the stress to be worth another doubling.
const AUTO_GAIN: f64 = 0.01;

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

/// Facts about an embedding; what `canonform embed --json` prints.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EmbedReport {
    /// Name of the method.
    pub method: &'static str,
    /// Name of the way distances were measured.
    pub geodesic: &'static str,
    /// Vertices of the input.
    pub n_vertices: usize,
    /// Faces of the input.
    pub n_faces: usize,
    /// Vertices that were embedded, after the repair.
    pub n_embedded: usize,
    /// Number of samples; all vertices for classical scaling.
    pub n_samples: usize,
    /// Eigenpairs of the sample matrix used.
    pub rank: usize,
    /// Dimensions of the embedding.
    pub dim: usize,
    /// The samples, as vertices of the input; empty for classical scaling, where all are.
    pub samples: Vec<u32>,
    /// Eigenvalues of the embedding, descending, in squared mesh units.
    pub eigenvalues: Vec<f64>,
    /// Share of negative eigenvalues among those computed.
    pub negative_mass: f64,
    /// Dimensions that found no positive eigenvalue and are zero.
    pub empty_dimensions: usize,
    /// The stress, unless it was not asked for or the method's coordinates have no unit.
    pub stress: Option<StressReport>,
    /// Wall-clock seconds.
    pub seconds: SecondsReport,
    /// What was repaired.
    pub repair: RepairReport,
}

/// Wall-clock seconds of the stages of an embedding.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct SecondsReport {
    /// Reading the file.
    pub load: f64,
    /// Repair and connectivity.
    pub repair: f64,
    /// Preparation of the surface, sampling and distances.
    pub geodesics: f64,
    /// Linear algebra.
    pub embedding: f64,
    /// Measuring the stress; not part of `total`, since an embedding does not need it.
    pub stress: f64,
    /// Everything from the file to the coordinates.
    pub total: f64,
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
    let (embedding, samples) = match &options.method {
        EmbedMethod::Classical => {
            observer.begin("distances", solver.n_vertices());
            let distances = all_pairs(&solver, options.all_pairs_limit)?;
            seconds.geodesics = start.elapsed().as_secs_f64();
            (classical(&distances, options.dim)?, None)
        }
        method => {
            let expected = match options.samples {
                Samples::Count(n) => n,
                Samples::Auto => AUTO_LAST,
            };
            observer.begin("distances", expected);
            let mut sampler = FarthestPointSampler::new(&solver, first)?;
            let embed = |distances: &LandmarkDistances| embed_landmarks(distances, method, options.dim);
            let (embedding, distances) = match options.samples {
                Samples::Count(n) => {
                    sampler.extend_to(n)?;
                    let distances = sampler.distances(n)?;
                    seconds.geodesics = start.elapsed().as_secs_f64();
                    (embed(&distances)?, distances)
                }
                Samples::Auto => {
                    seconds.geodesics = start.elapsed().as_secs_f64();
                    enough_samples(&mut sampler, embed, &mut seconds.geodesics)?
                }
            };
            (embedding, Some(distances))
        }
    };
    let elapsed = start.elapsed().as_secs_f64();
    seconds.embedding = elapsed - seconds.geodesics;
    seconds.total = seconds.load + seconds.repair + elapsed;

    let start = Instant::now();
    // Components of a kernel have no unit that a distance could be compared with.
    let has_unit = !matches!(options.method, EmbedMethod::KernelPca { .. });
    let rows = MarchedRows(&solver);
    let stress = match has_unit {
        true => measure(&embedding.coords, &rows, options.stress, options.seed, observer),
        false => None,
    };
    seconds.stress = start.elapsed().as_secs_f64();

    let n_samples = samples.as_ref().map_or(embedding.n_points(), LandmarkDistances::n_landmarks);
    let samples = samples.map_or(Vec::new(), |distances| {
        distances.landmarks().iter().map(|&v| surface.input_vertex(VertexId::from(v)).0).collect()
    });
    let report = EmbedReport {
        method: options.method.name(),
        geodesic: options.geodesic.name(),
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
        seconds,
        repair: surface.repaired.report.clone(),
    };
    Ok(Embedded { embedding, report, has_unit })
}

fn embed_landmarks(
    distances: &LandmarkDistances,
    method: &EmbedMethod,
    dim: usize,
) -> Result<Embedding, PipelineError> {
    Ok(match *method {
        EmbedMethod::Nystrom { rank } => nystrom(distances, &NystromOptions { rank, dim })?,
        EmbedMethod::KernelPca { rank, bandwidth } => {
            kernel_pca(distances, &KernelPcaOptions { bandwidth, rank, dim })?
        }
        EmbedMethod::Classical => unreachable!("classical scaling takes all pairs"),
    })
}

/// Doubles the samples until that hardly lowers the stress on their own rows.
fn enough_samples(
    sampler: &mut FarthestPointSampler<'_>,
    embed: impl Fn(&LandmarkDistances) -> Result<Embedding, PipelineError>,
    geodesic_seconds: &mut f64,
) -> Result<(Embedding, LandmarkDistances), PipelineError> {
    let mut distances_of = |n: usize| {
        let start = Instant::now();
        sampler.extend_to(n)?;
        let distances = sampler.distances(n)?;
        *geodesic_seconds += start.elapsed().as_secs_f64();
        Ok::<_, PipelineError>(distances)
    };
    let mut n = AUTO_FIRST;
    let mut embedding = embed(&distances_of(n)?)?;
    loop {
        n *= 2;
        let more = distances_of(n)?;
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

/// The distances between all pairs of vertices.
fn all_pairs(solver: &dyn DistanceSolver, limit: usize) -> Result<DistanceMatrix, PipelineError> {
    let p = solver.n_vertices();
    let needed = p.saturating_mul(p).saturating_mul(size_of::<f64>());
    if needed > limit {
        let [needed_mib, limit_mib] = [needed, limit].map(|bytes| bytes >> 20);
        return Err(PipelineError::AllPairsTooLarge { n_vertices: p, needed_mib, limit_mib });
    }
    let sources: Vec<VertexId> = (0..p).map(VertexId::from).collect();
    let columns = solver.distance_columns(&sources);
    Ok(DistanceMatrix::from_rows(p, columns.data.into())?)
}
