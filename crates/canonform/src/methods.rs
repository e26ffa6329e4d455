//! Every method on one surface.

use geodesics::{Method, Sampling, Variance};
use linalg::{DistanceMatrix, LandmarkDistances, Matrix};
use mesh::RepairReport;
use nmds::{
    Bandwidth, Regularization, RpiAlpha, SmacofOptions, estimate_paper_stress, paper_stress, sample_rows,
};
use serde::Serialize;
use surface::VertexId;

use crate::stress::{ESTIMATE_ROWS, EXACT_LIMIT, KnownRows};
use crate::{
    EmbedMethod, EmbedOptions, Observer, PipelineError, StressChoice, StressKind, StressReport, Surface,
    embed,
};

/// What every method makes of one surface, as `canonform methods --json` prints it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MethodsReport {
    /// Vertices of the input.
    pub n_vertices: usize,
    /// Vertices that were embedded, after the repair.
    pub n_embedded: usize,
    /// Dimensions of the embeddings.
    pub dim: usize,
    /// Name of the way distances were measured, where a method does not say otherwise, and of those that
    /// the stress is measured against.
    pub geodesic: &'static str,
    /// One entry for each method.
    pub methods: Vec<MethodReport>,
    /// Where in `methods` the least stress is.
    pub best: Option<usize>,
    /// What was repaired.
    pub repair: RepairReport,
}

/// One method.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MethodReport {
    /// Its name, as `--method` takes it.
    pub method: &'static str,
    /// What else sets it apart, as options of `canonform embed`; may be empty.
    pub options: &'static str,
    /// What it made; nothing when it failed.
    #[serde(flatten)]
    pub facts: Option<MethodFacts>,
    /// Why it failed.
    pub error: Option<String>,
}

/// What a method made and what it took.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MethodFacts {
    /// The stress, unless the coordinates have no unit.
    pub stress: Option<StressReport>,
    /// Share of negative eigenvalues among those computed.
    pub negative_mass: f64,
    /// Samples that were taken; all vertices where none are.
    pub n_samples: usize,
    /// Seconds for distances.
    pub geodesics_seconds: f64,
    /// Seconds for linear algebra.
    pub embedding_seconds: f64,
    /// Seconds from the repaired mesh to the coordinates.
    pub seconds: f64,
    /// Most bytes in use at once, as the caller's `watch` says.
    pub peak_bytes: usize,
}

/// Embeds a surface by every method in turn; `options` gives what they share, its method, sampling and
/// regularisation are not looked at. `watch` runs a piece of work and says how many bytes it had in use at most.
///
/// A method that cannot embed this surface has its error in the report and does not stop the others. The stress is
/// measured on the same rows of distances for all of them, and is no part of their time.
///
/// # Errors
/// Those of preparing the surface; when every method fails, the error of the first.
pub fn compare_methods(
    surface: &Surface,
    options: &EmbedOptions,
    observer: &dyn Observer,
    watch: &dyn Fn(&mut dyn FnMut()) -> usize,
) -> Result<MethodsReport, PipelineError> {
    let reference = Reference::new(surface, options, observer)?;
    let (mut methods, mut first_error) = (Vec::new(), None);
    for (name, changed) in variants(options) {
        let mut result = None;
        let peak_bytes = watch(&mut || result = Some(embed(surface, &changed, observer)));
        let (facts, error) = match result {
            Some(Ok(embedded)) => {
                let report = &embedded.report;
                let coords = &embedded.embedding.coords;
                let facts = MethodFacts {
                    stress: changed.method.has_unit().then(|| reference.stress(coords, options)),
                    negative_mass: report.negative_mass,
                    n_samples: report.n_samples,
                    geodesics_seconds: report.seconds.geodesics,
                    embedding_seconds: report.seconds.embedding,
                    seconds: report.seconds.geodesics + report.seconds.embedding,
                    peak_bytes,
                };
                (Some(facts), None)
            }
            Some(Err(fault)) => {
                let text = fault.to_string();
                first_error.get_or_insert(fault);
                (None, Some(text))
            }
            None => (None, Some("the watch did not run it".to_owned())),
        };
        methods.push(MethodReport { method: changed.method.name(), options: name, facts, error });
    }
    if let Some(fault) = first_error.filter(|_| methods.iter().all(|m| m.facts.is_none())) {
        return Err(fault);
    }
    let stress = |m: &MethodReport| m.facts.as_ref().and_then(|f| f.stress.as_ref()).map(|s| s.value);
    let stresses = methods.iter().enumerate().filter_map(|(i, m)| stress(m).map(|s| (i, s)));
    let best = stresses.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, _)| i);
    Ok(MethodsReport {
        n_vertices: surface.n_input_vertices(),
        n_embedded: surface.mesh().n_vertices(),
        dim: options.dim,
        geodesic: options.geodesic.name(),
        methods,
        best,
        repair: surface.repaired.report.clone(),
    })
}

/// Every method, with its options by the names of the command line.
fn variants(shared: &EmbedOptions) -> Vec<(&'static str, EmbedOptions)> {
    let of = |method: EmbedMethod| EmbedOptions { method, stress: StressChoice::Skip, ..shared.clone() };
    let nmds = |regularization| of(EmbedMethod::Nystrom { regularization });
    let default = || nmds(Regularization::default());
    let smacof =
        EmbedMethod::Smacof { regularization: Regularization::default(), descent: SmacofOptions::default() };
    vec![
        ("", default()),
        ("--regularization rpi", nmds(Regularization::Rpi { alpha: RpiAlpha::default() })),
        ("--regularization rpi --alpha paper", nmds(Regularization::Rpi { alpha: RpiAlpha::Paper })),
        ("--regularization none", nmds(Regularization::None)),
        ("--regularization cur", nmds(Regularization::Cur { rank: None })),
        ("--sampling random", EmbedOptions { sampling: Sampling::Random, ..default() }),
        (
            "--sampling min-variance",
            EmbedOptions { sampling: Sampling::Incremental(Variance::Least), ..default() },
        ),
        ("--geodesic bfs", EmbedOptions { geodesic: Method::BreadthFirst, ..default() }),
        ("", of(EmbedMethod::Landmark)),
        ("", of(EmbedMethod::spectral())),
        ("", of(EmbedMethod::Fmds)),
        ("", of(EmbedMethod::KernelPca { rank: None, bandwidth: Bandwidth::default() })),
        ("", of(EmbedMethod::Classical)),
        ("", of(smacof)),
    ]
}

/// The distances that all forms are held against.
enum Reference {
    All(DistanceMatrix),
    Some(LandmarkDistances),
}

impl Reference {
    fn new(
        surface: &Surface,
        options: &EmbedOptions,
        observer: &dyn Observer,
    ) -> Result<Self, PipelineError> {
        let p = surface.mesh().n_vertices();
        let is_exact = match options.stress {
            StressChoice::Exact => true,
            StressChoice::Estimate | StressChoice::Skip => false,
            StressChoice::Auto => p <= EXACT_LIMIT,
        };
        options.check_memory(p, if is_exact { p } else { ESTIMATE_ROWS.min(p) })?;
        observer.begin("stress", 1);
        let solver = options.geodesic.prepare(&surface.intrinsic)?;
        if is_exact {
            return Ok(Self::All(solver.distance_matrix()?));
        }
        let rows = sample_rows(p, ESTIMATE_ROWS, options.seed);
        let sources: Vec<VertexId> = rows.iter().copied().map(VertexId::from).collect();
        let columns = solver.distance_columns(&sources);
        Ok(Self::Some(LandmarkDistances::new(rows, columns)?))
    }

    fn stress(&self, coords: &Matrix, options: &EmbedOptions) -> StressReport {
        let geodesic = options.geodesic.name();
        match self {
            Self::All(all) => {
                let value = paper_stress(coords, all);
                let (kind, interval) = (StressKind::Exact, [value; 2]);
                StressReport { measure: "paper_stress", geodesic, value, kind, interval }
            }
            Self::Some(rows) => {
                let estimate = estimate_paper_stress(coords, &KnownRows(rows), rows.landmarks());
                let (value, interval) = (estimate.value, estimate.interval);
                let kind = StressKind::Estimated;
                StressReport { measure: "paper_stress", geodesic, value, kind, interval }
            }
        }
    }
}
