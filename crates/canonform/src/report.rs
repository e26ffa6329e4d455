//! Facts about an embedding.

use mesh::RepairReport;
use nmds::{SmacofReport, SmacofStop};
use serde::Serialize;

use crate::StressReport;

/// Facts about an embedding; what `canonform embed --json` prints.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EmbedReport {
    /// Name of the method.
    pub method: &'static str,
    /// Name of the way distances were measured.
    pub geodesic: &'static str,
    /// Name of the way samples were taken; none for classical scaling.
    pub sampling: Option<&'static str>,
    /// Name of the regularisation, of methods that have one.
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
    /// How the stress was made smaller, by SMACOF.
    pub descent: Option<DescentReport>,
    /// Wall-clock seconds.
    pub seconds: SecondsReport,
    /// What was repaired.
    pub repair: RepairReport,
}

/// Facts about a run of SMACOF.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DescentReport {
    /// Steps that were taken.
    pub iterations: usize,
    /// `converged` or `iteration-limit`.
    pub stop: &'static str,
    /// Kruskal's stress of the start and after every step: never ascending.
    pub normalized_stress: Vec<f64>,
}

impl From<SmacofReport> for DescentReport {
    fn from(report: SmacofReport) -> Self {
        let stop = match report.stop {
            SmacofStop::Converged => "converged",
            SmacofStop::IterationLimit => "iteration-limit",
        };
        Self { iterations: report.iterations(), stop, normalized_stress: report.normalized_stress }
    }
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
