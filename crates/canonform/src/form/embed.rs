//! From a surface to coordinates.

use std::borrow::Cow;
use std::time::Instant;

use descriptors::CanonicalForm;
use geodesics::{DistanceSolver, FirstSample, Observed};
use linalg::LandmarkDistances;
use mesh::RepairReport;
use nmds::{Embedding, OutOfSample};
use surface::{IntrinsicMesh, VertexId};

use super::distances::{KnownColumns, Measurement, Samples, plan};
use super::method::Outcome;
use super::options::FormOptions;
use super::report::{EmbedReport, SecondsReport};
use super::stress::{Known, Rows, StressChoice, StressOptions};
use crate::error::Error;
use base::Observer;
use mesh::{InputMap, Surface};

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
    /// What placed the points, if the coordinates are those of a coarser mesh.
    pub(super) extension: Option<OutOfSample>,
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
/// [`Budget`](base::Budget) is itself an observer.
///
/// ```
/// use canonform::{FormOptions, Samples, Surface, embed, mesh::shapes};
///
/// let surface = Surface::new(&shapes::torus(24, 12, 2.0, 0.7), &Default::default(), &())?;
/// let options = FormOptions { samples: Samples::Count(40), ..FormOptions::default() };
/// let embedded = embed(&surface, &options, &())?;
/// assert_eq!(embedded.embedding.coords.shape(), (288, 3));
/// let form = embedded.form(&surface)?;
/// assert_eq!(form.points().len(), 288);
/// # Ok::<(), canonform::Error>(())
/// ```
///
/// # Errors
/// [`Error::AllPairsTooLarge`], [`Error::Point`] for the first sample, [`Error::NoStress`],
/// [`Error::Exceeded`], and the errors of the stages.
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
    let first = first_sample(surface, &options)?;
    run(Cow::Borrowed(surface.intrinsic()), &Origin::of(surface), options, first, None, stress, observer)
}

/// Embeds a surface as [`embed_and_measure`] does, and looks up the distances that an earlier embedding of the same surface has
/// measured: to take more samples, or to try another method or rank on the same ones. The result is the same, bit for bit.
///
/// ```
/// use canonform::{FormOptions, Samples, StressOptions, Surface, embed_again, embed_and_measure, mesh::shapes};
///
/// let surface = Surface::new(&shapes::torus(24, 12, 2.0, 0.7), &Default::default(), &())?;
/// let few = FormOptions { samples: Samples::Count(20), ..FormOptions::default() };
/// let many = FormOptions { samples: Samples::Count(50), ..few.clone() };
/// let stress = StressOptions::default();
/// let first = embed_and_measure(&surface, &few, &stress, &())?;
///
/// // Measures the distances from 30 samples, not from 50.
/// let more = embed_again(&surface, &first, &many, &stress, &())?;
/// assert_eq!(more.embedding, embed_and_measure(&surface, &many, &stress, &())?.embedding);
/// # Ok::<(), canonform::Error>(())
/// ```
///
/// # Errors
/// [`Error::OtherSurface`] if the earlier embedding has another number of vertices, or other distances between them, and as
/// [`embed`].
pub fn embed_again(
    surface: &Surface,
    earlier: &Embedded,
    options: &FormOptions,
    stress: &StressOptions,
    observer: &dyn Observer,
) -> Result<Embedded, Error> {
    earlier.check_surface(surface)?;
    let options = FormOptions { repair: surface.repair, ..options.clone() }.normalized();
    let first = first_sample(surface, &options)?;
    let known = (options.geodesic == earlier.options.geodesic).then_some(&earlier.distances);
    run(Cow::Borrowed(surface.intrinsic()), &Origin::of(surface), options, first, known, stress, observer)
}

/// Embeds a surface as [`embed_and_measure`] does, in less memory: the mesh is dropped before distances are measured. The
/// result is the same.
///
/// If the [budget](Observer::budget) limits memory and names a folder for temporary files, distances that do not fit are
/// kept in a file there, by methods that can read them in blocks: NMDS and landmark MDS.
///
/// ```
/// use canonform::{FormOptions, StressOptions, Surface, embed_and_measure, embed_and_release, mesh::shapes};
///
/// let surface = Surface::new(&shapes::torus(40, 20, 2.0, 0.7), &Default::default(), &())?;
/// let (options, stress) = (FormOptions::default(), StressOptions::default());
/// let usual = embed_and_measure(&surface, &options, &stress, &())?;
/// let (lean, map) = embed_and_release(surface, &options, &stress, &())?;
/// assert_eq!(lean.embedding, usual.embedding);
/// assert_eq!(map.n_input_vertices(), 800);
/// # Ok::<(), canonform::Error>(())
/// ```
///
/// # Errors
/// As [`embed`], and [`Error::EmbeddingTooLarge`].
pub fn embed_and_release(
    surface: Surface,
    options: &FormOptions,
    stress: &StressOptions,
    observer: &dyn Observer,
) -> Result<(Embedded, InputMap), Error> {
    let options = FormOptions { repair: surface.repair, ..options.clone() }.normalized();
    let first = first_sample(&surface, &options)?;
    let (intrinsic, map) = surface.into_parts();
    let origin = Origin {
        report: &map.report,
        input_vertex: Box::new(|v| map.input_vertex(v)),
        load_seconds: map.load_seconds,
        repair_seconds: map.repair_seconds,
    };
    let embedded = run(Cow::Owned(intrinsic), &origin, options, first, None, stress, observer)?;
    drop(origin);
    Ok((embedded, map))
}

/// Distances on one surface differ by less than this share of the largest: what compilers and processors change.
const SAME_DISTANCES: f64 = 1e-9;

/// Refuses distances that were measured on another surface, by those from the first landmark.
///
/// # Errors
/// [`Error::OtherSurface`].
fn check_distances(solver: &dyn DistanceSolver, known: &LandmarkDistances) -> Result<(), Error> {
    let Some(&first) = known.landmarks().first() else { return Ok(()) };
    let (n_vertices, n_points) = (solver.n_vertices(), known.n_points());
    let mut column = solver.budget().vector(n_vertices)?;
    solver.distances_into(VertexId::from(first), &mut column)?;
    let (known, most) = (known.column(0)?, SAME_DISTANCES * known.max());
    match column.iter().zip(known.iter()).all(|(a, b)| (a - b).abs() <= most) {
        true => Ok(()),
        false => Err(Error::OtherSurface { n_vertices, n_points }),
    }
}

/// The first sample, as a vertex of the repaired mesh.
fn first_sample(surface: &Surface, options: &FormOptions) -> Result<FirstSample, Error> {
    Ok(match options.first_sample {
        FirstSample::Farthest => FirstSample::Farthest,
        FirstSample::Vertex(input) => FirstSample::Vertex(surface.repaired_vertex(input)?),
    })
}

/// What the report tells of the input.
pub(super) struct Origin<'a> {
    report: &'a RepairReport,
    /// The input vertex of a vertex of the repaired mesh.
    input_vertex: Box<dyn Fn(VertexId) -> VertexId + 'a>,
    load_seconds: f64,
    repair_seconds: f64,
}

impl<'a> Origin<'a> {
    pub(super) fn of(surface: &'a Surface) -> Self {
        Self {
            report: &surface.repaired.report,
            input_vertex: Box::new(|v| surface.input_vertex(v)),
            load_seconds: surface.load_seconds,
            repair_seconds: surface.repair_seconds,
        }
    }
}

fn run(
    surface: Cow<'_, IntrinsicMesh>,
    origin: &Origin<'_>,
    options: FormOptions,
    first: FirstSample,
    known: Option<&LandmarkDistances>,
    stress: &StressOptions,
    observer: &dyn Observer,
) -> Result<Embedded, Error> {
    let start = Instant::now();
    let budget = observer.budget();
    if !options.method.has_unit() && options.samples == Samples::Auto {
        return Err(Error::NoStress { method: options.method.name() });
    }
    if options.method.streams() {
        plan(surface.n_vertices(), options.samples).check(&budget)?;
    }
    let measures = options.method.has_unit() && stress.choice != StressChoice::Skip;
    let against = stress.against.filter(|other| measures && *other != options.geodesic);
    let (solver, surface) = match surface {
        Cow::Owned(surface) if against.is_none() && !options.method.needs_surface() => {
            (options.geodesic.prepare(surface, observer)?, None)
        }
        surface => (options.geodesic.prepare(surface.as_ref(), observer)?, Some(surface)),
    };
    if let Some(known) = known {
        check_distances(solver.as_ref(), known)?;
    }
    let solver = Observed { solver: solver.as_ref(), observer };
    let reused = known.map(|known| KnownColumns { solver: &solver, known });
    let mut measurement = Measurement {
        solver: reused.as_ref().map_or(&solver as &dyn DistanceSolver, |reused| reused),
        samples: options.samples,
        sampling: options.sampling,
        first,
        seed: options.seed,
        observer,
        budget: budget.clone(),
        streams: options.method.streams(),
        seconds: start.elapsed().as_secs_f64(),
        search: None,
    };
    let Outcome { embedding, distances, all, descent } =
        options.method.run(surface.as_deref(), options.dim, &mut measurement)?;
    let (elapsed, geodesics) = (start.elapsed().as_secs_f64(), measurement.seconds);
    let search = measurement.search.take();

    let start = Instant::now();
    let known = Known { coords: &embedding.coords, samples: &distances, searched: search.is_some() };
    let stress_report = match (against, surface.as_deref()) {
        _ if !measures => None,
        (Some(other), Some(surface)) => {
            let solver = other.prepare(surface, observer)?;
            let solver = Observed { solver: solver.as_ref(), observer };
            Some(known.stress(Rows::Solved(&solver), other, stress, observer)?)
        }
        _ => {
            let rows = all.as_ref().map_or(Rows::Solved(&solver), Rows::Known);
            Some(known.stress(rows, options.geodesic, stress, observer)?)
        }
    };
    drop(all);
    let [embedding_seconds, stress_seconds] = [elapsed - geodesics, start.elapsed().as_secs_f64()];
    let seconds = origin.seconds(geodesics, embedding_seconds, stress_seconds);
    let report = EmbedReport {
        auto: search,
        descent: descent.map(Into::into),
        ..origin.facts(&options, &embedding, &distances)
    };
    let report = EmbedReport { stress: stress_report, seconds, ..report };
    Ok(Embedded { options, embedding, distances, report, extension: None })
}

impl Origin<'_> {
    /// Wall-clock seconds of the stages.
    pub(super) fn seconds(&self, geodesics: f64, embedding: f64, stress: f64) -> SecondsReport {
        let [load, repair] = [self.load_seconds, self.repair_seconds];
        SecondsReport {
            load,
            repair,
            geodesics,
            embedding,
            stress,
            total: load + repair + geodesics + embedding,
        }
    }

    /// The report on an embedding, without what was measured on the way.
    pub(super) fn facts(
        &self,
        options: &FormOptions,
        embedding: &Embedding,
        distances: &LandmarkDistances,
    ) -> EmbedReport {
        let samples = match options.method.is_sampled() {
            true => distances.landmarks(),
            false => &[],
        };
        EmbedReport {
            method: options.method.name(),
            geodesic: options.geodesic.name(),
            sampling: options.method.is_sampled().then(|| options.sampling.name()),
            regularization: options.method.regularization().map(|chosen| chosen.name()),
            n_vertices: self.report.input_vertices,
            n_faces: self.report.input_faces,
            n_embedded: embedding.n_points(),
            n_samples: if options.method.is_sampled() { samples.len() } else { embedding.n_points() },
            rank: embedding.rank,
            dim: embedding.dim(),
            samples: samples.iter().map(|&v| (self.input_vertex)(VertexId::from(v)).0).collect(),
            eigenvalues: embedding.eigenvalues.clone(),
            negative_mass: embedding.negative_mass,
            empty_dimensions: embedding.dim() - embedding.positive_dims(),
            auto: None,
            stress: None,
            descent: None,
            seconds: SecondsReport::default(),
            repair: self.report.clone(),
        }
    }
}
