//! From a surface to coordinates.

use std::borrow::Cow;
use std::time::Instant;

use base::Observer;
use geodesics::{FirstSample, Observed};
use mesh::{InputMap, Surface};
use nmds::DistanceRows;
use surface::IntrinsicMesh;

use super::distances::{Measurement, Samples, plan};
use super::embedded::Embedded;
use super::extend::Coarser;
use super::options::FormOptions;
use super::outcome::Outcome;
use super::report::{EmbedReport, SecondsReport};
use super::stress::{SolvedRows, StressChoice, StressOptions, StressReport};
use crate::error::Error;

/// What [`embed`] embeds: a [`Surface`], or the parts of one, [without its mesh](Surface::into_parts), which needs less memory.
pub struct EmbedInput<'a> {
    intrinsic: Cow<'a, IntrinsicMesh>,
    map: &'a InputMap,
}

impl<'a> From<&'a Surface> for EmbedInput<'a> {
    fn from(surface: &'a Surface) -> Self {
        Self { intrinsic: Cow::Borrowed(surface.intrinsic()), map: &surface.input }
    }
}

impl<'a> From<(IntrinsicMesh, &'a InputMap)> for EmbedInput<'a> {
    fn from((intrinsic, map): (IntrinsicMesh, &'a InputMap)) -> Self {
        Self { intrinsic: Cow::Owned(intrinsic), map }
    }
}

/// How [`embed`] embeds: the options of the form, whether the stress is measured, and in what coordinates. Made from [`FormOptions`].
#[derive(Debug, Clone)]
pub struct EmbedOptions<'a> {
    /// How the form is made.
    pub form: &'a FormOptions,
    /// How the stress of the result is measured. Default: not.
    pub stress: StressOptions,
    /// The form of a coarser mesh, in whose coordinates this one is embedded.
    coarser: Option<Coarser<'a>>,
}

impl<'a> From<&'a FormOptions> for EmbedOptions<'a> {
    fn from(form: &'a FormOptions) -> Self {
        let stress = StressOptions { choice: StressChoice::Skip, ..StressOptions::default() };
        Self { form, stress, coarser: None }
    }
}

impl<'a> EmbedOptions<'a> {
    /// Measures the stress of the result.
    #[must_use]
    pub fn stress(self, stress: StressOptions) -> Self {
        Self { stress, ..self }
    }

    /// Embeds `fine`, a finer mesh of the surface `coarse`, in the coordinates of its `form`: measures distances from the samples of
    /// the form and places all vertices by them. Levels of one surface then have forms that lie on top of each other.
    ///
    /// A sample is found on the finer mesh as the vertex nearest to its position, which must not be farther than a mean edge of
    /// the coarser mesh: both meshes are in the same place.
    ///
    /// ```
    /// use canonform::Surface;
    /// use canonform::embed::{EmbedOptions, FormOptions, embed};
    /// use canonform::mesh::shapes;
    ///
    /// let [coarse, fine] = [3, 4].map(|level| Surface::new(&shapes::icosphere(level), &Default::default(), &()));
    /// let (coarse, fine) = (coarse?, fine?);
    /// let form = embed(&coarse, &FormOptions::default(), &())?;
    /// let finer = embed(&fine, EmbedOptions::finer(&fine, &coarse, &form)?, &())?;
    /// assert_eq!(finer.embedding.n_points(), 2562);
    /// // The first vertices are those of the coarser sphere.
    /// let gap = finer.embedding.coords.rows(0, 642) - &form.embedding.coords;
    /// assert!(gap.amax() < 0.02);
    /// # Ok::<(), canonform::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Refused`] if a sample has no vertex of the finer mesh near it, if the method of `form` cannot place further points,
    /// or if `form` is not of `coarse`.
    pub fn finer(fine: &Surface, coarse: &Surface, form: &'a Embedded) -> Result<Self, Error> {
        let coarser = Some(Coarser::new(fine, coarse, form)?);
        Ok(Self { coarser, ..Self::from(&form.options) })
    }
}

/// Embeds a surface: measures distances and turns them into coordinates. All forms are made here.
///
/// `observer` counts every run of the distance solver as a step. The result does not depend on the number of
/// threads. A surface that was repaired in another way than the options say keeps its repair, and the
/// [options of the result](Embedded::options) tell. The [budget](Observer::budget) of the observer limits the work; a
/// [`Budget`](base::Budget) is itself an observer. If it limits memory and names a folder for temporary files, distances that do
/// not fit are kept in a file there, by methods that can read them in blocks: NMDS and landmark MDS.
///
/// ```
/// use canonform::Surface;
/// use canonform::embed::{EmbedOptions, FormOptions, Samples, StressOptions, embed};
/// use canonform::mesh::shapes;
///
/// let surface = Surface::new(&shapes::torus(24, 12, 2.0, 0.7), &Default::default(), &())?;
/// let options = FormOptions { samples: Samples::Count(40), ..FormOptions::default() };
/// let embedded = embed(&surface, &options, &())?;
/// assert_eq!(embedded.embedding.coords.shape(), (288, 3));
/// let form = embedded.form(&surface)?;
/// assert_eq!(form.points().len(), 288);
///
/// // In less memory, since the mesh is dropped, and with the stress.
/// let (intrinsic, map) = surface.into_parts();
/// let options = EmbedOptions::from(&options).stress(StressOptions::default());
/// let lean = embed((intrinsic, &map), options, &())?;
/// assert_eq!(lean.embedding, embedded.embedding);
/// assert!(lean.report.stress.is_some());
/// # Ok::<(), canonform::Error>(())
/// ```
///
/// # Errors
/// [`Error::TooLarge`], [`Error::Point`] for the first sample, [`Error::Refused`] for a search for the number of samples by a method
/// whose coordinates are no lengths, [`Error::Exceeded`], and the errors of the stages.
pub fn embed<'a, 'b>(
    surface: impl Into<EmbedInput<'a>>,
    options: impl Into<EmbedOptions<'b>>,
    observer: &dyn Observer,
) -> Result<Embedded, Error> {
    let EmbedInput { intrinsic: surface, map } = surface.into();
    let EmbedOptions { form, stress, coarser } = options.into();
    let start = Instant::now();
    let options = FormOptions { repair: map.repair, ..form.clone() }.normalized();
    let first = match options.first_sample {
        FirstSample::Farthest => FirstSample::Farthest,
        FirstSample::Vertex(input) => FirstSample::Vertex(map.repaired_vertex(input)?),
    };
    options.check_samples()?;
    if options.method.streams() {
        plan(surface.n_vertices(), options.samples).check(&observer.budget())?;
    }
    let measures = options.method.has_unit() && stress.choice != StressChoice::Skip;
    let against = stress.against.filter(|other| measures && *other != options.geodesic);
    let (solver, surface) = match surface {
        Cow::Owned(surface) if against.is_none() && !options.method.needs_surface() => {
            (options.geodesic.prepare(surface, observer)?, None)
        }
        surface => (options.geodesic.prepare(surface.as_ref(), observer)?, Some(surface)),
    };
    let solver = Observed { solver: solver.as_ref(), observer };
    let measurement = Measurement {
        solver: &solver,
        samples: options.samples,
        sampling: options.sampling,
        first,
        seed: options.seed,
        observer,
        streams: options.method.streams(),
        seconds: start.elapsed().as_secs_f64().into(),
    };
    let (outcome, extension) = match coarser {
        Some(coarser) => (coarser.place(&measurement)?, Some(coarser.extension)),
        None => (options.method.run(surface.as_deref(), options.dim, &measurement)?, None),
    };
    let Outcome { embedding, distances, search, all, descent } = outcome;
    let (elapsed, geodesics) = (start.elapsed().as_secs_f64(), measurement.seconds.get());

    let start = Instant::now();
    let stress = if measures {
        let distances = (&distances, options.samples == Samples::Auto);
        let other = against.zip(surface.as_deref());
        let other = other.map(|(method, surface)| method.prepare(surface, observer)).transpose()?;
        let other = other.as_ref().map(|solver| Observed { solver: solver.as_ref(), observer });
        let solved = SolvedRows(other.as_ref().unwrap_or(&solver));
        let rows: (&dyn DistanceRows, bool) = match (&all, &other) {
            (Some(all), None) => (all, true),
            _ => (&solved, false),
        };
        let method = against.unwrap_or(options.geodesic);
        Some(StressReport::against(rows, method, &embedding.coords, distances, &stress, observer)?)
    } else {
        None
    };
    let seconds = SecondsReport {
        load: map.load_seconds,
        repair: map.repair_seconds,
        geodesics,
        embedding: elapsed - geodesics,
        stress: start.elapsed().as_secs_f64(),
        total: map.load_seconds + map.repair_seconds + elapsed,
    };
    let report = EmbedReport::new(&options, map, &embedding, distances.landmarks(), seconds);
    let report = EmbedReport { auto: search, stress, descent, ..report };
    Ok(Embedded { options, embedding, distances, report, extension })
}
