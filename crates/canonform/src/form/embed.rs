//! From a surface to coordinates.

use std::time::Instant;

use descriptors::CanonicalForm;
use geodesics::FirstSample;
use linalg::LandmarkDistances;
use nmds::Embedding;
use surface::VertexId;

use super::distances::Measurement;
use super::method::Outcome;
use super::options::FormOptions;
use super::report::{EmbedReport, SecondsReport};
use super::stress::{StressChoice, StressOptions, measure};
use crate::error::Error;
use crate::input::Surface;
use crate::observer::{Observed, Observer};

/// An embedded surface.
#[derive(Debug, Clone)]
pub struct Embedded {
    /// How it was made.
    pub options: FormOptions,
    /// Coordinates of the vertices of the repaired mesh.
    pub embedding: Embedding,
    /// Distances from the samples to all vertices, in mesh units. A method without samples keeps the columns of as many.
    pub distances: LandmarkDistances,
    /// Facts about the run.
    pub report: EmbedReport,
}

impl Embedded {
    /// The canonical form: the embedded surface, weighted by the areas of the mesh.
    ///
    /// # Errors
    /// [`Error::Descriptor`] when the embedding is not three-dimensional or all points coincide.
    pub fn form(&self, surface: &Surface) -> Result<CanonicalForm, Error> {
        let form = CanonicalForm::new(&self.embedding, surface.mesh())?;
        Ok(if self.options.method.has_unit() { form } else { form.without_unit() })
    }
}

/// Embeds a surface: measures distances and turns them into coordinates. All forms are made here.
///
/// `observer` counts every run of the distance solver as a step. The result does not depend on the number of
/// threads. A surface that was repaired in another way than the options say keeps its repair, and the
/// [options of the result](Embedded::options) tell. The [budget](Observer::budget) of the observer limits the work; a
/// [`Budget`](budget::Budget) is itself an observer.
///
/// ```
/// use canonform::{FormOptions, Samples, Surface, embed, mesh::shapes};
///
/// let surface = Surface::new(&shapes::torus(24, 12, 2.0, 0.7), &Default::default())?;
/// let options = FormOptions { samples: Samples::Count(40), ..FormOptions::default() };
/// let embedded = embed(&surface, &options, &())?;
/// assert_eq!(embedded.embedding.coords.shape(), (288, 3));
/// let form = embedded.form(&surface)?;
/// assert_eq!(form.points().len(), 288);
/// # Ok::<(), canonform::Error>(())
/// ```
///
/// # Errors
/// [`Error::AllPairsTooLarge`], [`Error::NoSuchPoint`] and [`Error::DroppedPoint`] for the first sample, [`Error::Exceeded`],
/// and the errors of the stages.
pub fn embed(surface: &Surface, options: &FormOptions, observer: &dyn Observer) -> Result<Embedded, Error> {
    let skip = StressOptions { choice: StressChoice::Skip, ..StressOptions::default() };
    embed_and_measure(surface, options, &skip, observer)
}

/// Embeds a surface as [`embed`] does and measures the stress of the result.
///
/// # Errors
/// As [`embed`].
pub fn embed_and_measure(
    surface: &Surface,
    options: &FormOptions,
    stress: &StressOptions,
    observer: &dyn Observer,
) -> Result<Embedded, Error> {
    let options = FormOptions { repair: surface.repair, ..options.clone() }.normalized();
    let first = match options.first_sample {
        FirstSample::Farthest => FirstSample::Farthest,
        FirstSample::Vertex(input) => FirstSample::Vertex(surface.repaired_vertex(input)?),
    };
    let start = Instant::now();
    let budget = observer.budget();
    let solver = options.geodesic.prepare_within(&surface.intrinsic, &budget)?;
    let solver = Observed { solver: solver.as_ref(), observer };
    let mut measurement = Measurement {
        solver: &solver,
        samples: options.samples,
        sampling: options.sampling,
        first,
        seed: options.seed,
        observer,
        budget: budget.clone(),
        seconds: start.elapsed().as_secs_f64(),
    };
    let Outcome { embedding, distances, descent } =
        options.method.run(&surface.intrinsic, options.dim, &mut measurement)?;
    let (elapsed, geodesics) = (start.elapsed().as_secs_f64(), measurement.seconds);

    let start = Instant::now();
    let stress_report = match stress.against {
        _ if !options.method.has_unit() || stress.choice == StressChoice::Skip => None,
        Some(other) if other != options.geodesic => {
            let solver = other.prepare_within(&surface.intrinsic, &budget)?;
            let solver = Observed { solver: solver.as_ref(), observer };
            Some(measure(&embedding.coords, &solver, other, stress, observer)?)
        }
        _ => Some(measure(&embedding.coords, &solver, options.geodesic, stress, observer)?),
    };
    let seconds = SecondsReport {
        load: surface.load_seconds,
        repair: surface.repair_seconds,
        geodesics,
        embedding: elapsed - geodesics,
        stress: start.elapsed().as_secs_f64(),
        total: surface.load_seconds + surface.repair_seconds + elapsed,
    };
    let samples = match options.method.is_sampled() {
        true => distances.landmarks(),
        false => &[],
    };
    let report = EmbedReport {
        method: options.method.name(),
        geodesic: options.geodesic.name(),
        sampling: options.method.is_sampled().then(|| options.sampling.name()),
        regularization: options.method.regularization().map(|chosen| chosen.name()),
        n_vertices: surface.n_input_vertices(),
        n_faces: surface.input_faces.len(),
        n_embedded: embedding.n_points(),
        n_samples: if options.method.is_sampled() { samples.len() } else { embedding.n_points() },
        rank: embedding.rank,
        dim: embedding.dim(),
        samples: samples.iter().map(|&v| surface.input_vertex(VertexId::from(v)).0).collect(),
        eigenvalues: embedding.eigenvalues.clone(),
        negative_mass: embedding.negative_mass,
        empty_dimensions: embedding.dim() - embedding.positive_dims(),
        stress: stress_report,
        descent: descent.map(Into::into),
        seconds,
        repair: surface.repaired.report.clone(),
    };
    Ok(Embedded { options, embedding, distances, report })
}
