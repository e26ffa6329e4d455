//! Several embeddings of one surface, side by side.

use base::Exceeded;
use geodesics::Method;
use linalg::{LandmarkDistances, Matrix};
use mesh::RepairReport;
use nmds::{DistanceRows, RowSample};
use serde::Serialize;
use surface::VertexId;

use super::embed::embed;
use super::options::FormOptions;
use super::plan::check_memory;
use super::stress::{StressOptions, StressReport};
use crate::error::Error;
use base::Observer;
use mesh::Surface;

/// The results of every method on one surface, as `canonform methods --json` prints them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MethodsReport {
    /// Vertices of the input.
    pub n_vertices: usize,
    /// Vertices that were embedded, after the repair.
    pub n_embedded: usize,
    /// Dimensions of the embeddings.
    pub dim: usize,
    /// Name of the method that measured the distances, unless an entry says otherwise; the stress of all
    /// entries is measured against it.
    pub geodesic: &'static str,
    /// One entry for each method.
    pub methods: Vec<MethodReport>,
    /// Index of the entry of least stress.
    pub best: Option<usize>,
    /// What was repaired.
    pub repair: RepairReport,
}

/// One method.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MethodReport {
    /// Its name.
    pub method: &'static str,
    /// The name of the variant; may be empty.
    pub options: &'static str,
    /// The result; `None` when the method failed.
    #[serde(flatten)]
    pub facts: Option<MethodFacts>,
    /// Why it failed.
    pub error: Option<String>,
}

/// The result of a method and its cost.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MethodFacts {
    /// The stress, unless the coordinates have no unit.
    pub stress: Option<StressReport>,
    /// Share of negative eigenvalues among those computed.
    pub negative_mass: f64,
    /// Number of samples; all vertices for a method without samples.
    pub n_samples: usize,
    /// Seconds for distances.
    pub geodesics_seconds: f64,
    /// Seconds for linear algebra.
    pub embedding_seconds: f64,
    /// Seconds from the repaired mesh to the coordinates.
    pub seconds: f64,
    /// Most bytes in use at once, as measured by the caller's `watch`.
    pub peak_bytes: usize,
}

/// Embeds a surface with the options of each variant in turn; the name of a variant tells in what it differs from the
/// shared `options`. `watch` runs a piece of work and returns the most bytes that were in use.
///
/// A method that cannot embed this surface reports its error and does not stop the others. The stress of all
/// methods is measured on the same rows of distances and does not count as their time.
///
/// # Errors
/// Those of preparing the surface; when every method fails, the error of the first.
pub fn compare_methods(
    surface: &Surface,
    options: &FormOptions,
    variants: &[(&'static str, FormOptions)],
    stress: &StressOptions,
    observer: &dyn Observer,
    watch: &dyn Fn(&mut dyn FnMut()) -> usize,
) -> Result<MethodsReport, Error> {
    let (reference, rows) = reference(surface, options.geodesic, stress, observer)?;
    let sample = |_: &Matrix, _: f64| Ok(rows.clone());
    let (mut methods, mut first_error) = (Vec::new(), None);
    for (name, changed) in variants {
        let mut result = None;
        let peak_bytes = watch(&mut || result = Some(embed(surface, changed, observer)));
        let (facts, error) = match result {
            Some(Ok(embedded)) => {
                let report = &embedded.report;
                let stress = || {
                    let coords = &embedded.embedding.coords;
                    StressReport::new(coords, reference.as_ref(), &sample, options.geodesic)
                };
                let facts = MethodFacts {
                    stress: changed.method.has_unit().then(stress).transpose()?,
                    negative_mass: report.negative_mass,
                    n_samples: report.n_samples,
                    geodesics_seconds: report.seconds.geodesics,
                    embedding_seconds: report.seconds.embedding,
                    seconds: report.seconds.geodesics + report.seconds.embedding,
                    peak_bytes,
                };
                (Some(facts), None)
            }
            Some(Err(Error::Exceeded(Exceeded::Cancelled))) => return Err(Exceeded::Cancelled.into()),
            Some(Err(fault)) => {
                let text = fault.to_string();
                first_error.get_or_insert(fault);
                (None, Some(text))
            }
            None => (None, Some("`watch` did not run the method".to_owned())),
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
        repair: surface.input.report.clone(),
    })
}

/// The distances that the stress of all embeddings is measured against, and the rows that are used.
type Reference = (Box<dyn DistanceRows>, RowSample);

fn reference(
    surface: &Surface,
    method: Method,
    stress: &StressOptions,
    observer: &dyn Observer,
) -> Result<Reference, Error> {
    let p = surface.mesh().n_vertices();
    let rows = stress.choice.shared_rows(p, stress.seed);
    let budget = observer.budget();
    check_memory(p, rows.as_ref().map_or(p, Vec::len), &budget)?;
    observer.begin("stress", 1);
    let solver = method.prepare(surface.intrinsic(), observer)?;
    let Some(rows) = rows else { return Ok((Box::new(solver.distance_matrix()?), RowSample::all(p))) };
    let sources: Vec<VertexId> = rows.iter().copied().map(VertexId::from).collect();
    let known = LandmarkDistances::new(rows.clone(), solver.distance_columns(&sources)?)?;
    Ok((Box::new(known), RowSample::of_rows(rows, p)))
}
