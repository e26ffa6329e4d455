//! What a distance field holds.

use std::sync::{Mutex, PoisonError};

use base::{Exceeded, Observer};
use geodesics::{Exact, GeodesicError, Method};
use mesh::{Remap, RepairOptions};
use serde::{Deserialize, Serialize};
use surface::{IntrinsicMesh, VertexId};

use crate::error::FieldError;
use crate::metric::LandmarkMetric;

/// The distances between all pairs of vertices of a surface, in a few hundred bytes per vertex instead of eight bytes per
/// pair.
///
/// Every answer is an estimate, the Nystrom approximation of [`nmds::low_rank_factor`], and an interval that holds the true
/// distance by the triangle inequality with every landmark (`goldberg2005` in `REFERENCES.bib`). With columns by
/// [`Method::Exact`] the intervals are [certified](FieldBounds::Certified). With other methods they are widened by the error of
/// the method, [measured](FieldBounds::Measured) on this surface.
///
/// | query | time | answer |
/// |---|---|---|
/// | [`pair`](Self::pair) | well below a microsecond | estimate and interval |
/// | [`pairs`](Self::pairs) | the same, and 1 to 20 milliseconds for each pair that is finished | exact where the interval is wide |
/// | [`row`](Self::row) | the same for all vertices | as `pairs` |
/// | [`nearest`](Self::nearest) | some milliseconds | exact |
///
/// The field keeps the edge lengths of the surface, 48 bytes per vertex, so it can finish pairs by itself: by exact
/// propagation from one vertex, no farther than the interval allows.
///
/// ```
/// use canonform_fields::{DistanceField, FieldOptions, Finish};
/// use mesh::{Surface, shapes};
/// use surface::VertexId;
///
/// let surface = Surface::new(&shapes::icosphere(3), &Default::default(), &())?;
/// let field = DistanceField::build(&surface, &FieldOptions::default(), &())?;
///
/// // From pole to pole of the unit sphere: half of its circumference.
/// let [a, b] = [VertexId(0), VertexId(3)];
/// let pair = field.pair(a, b)?;
/// assert!(pair.lower <= pair.distance && pair.distance <= pair.upper);
/// // Every vertex, exact wherever the landmarks leave more than 5 % open.
/// let row = field.row(a, Finish::default(), &())?;
/// assert_eq!(row[3].b, b);
/// // The six neighbors of a vertex.
/// assert_eq!(field.nearest(VertexId(100), 6, &())?.len(), 6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct DistanceField {
    /// How it was made.
    pub(crate) provenance: Provenance,
    pub(crate) metric: LandmarkMetric,
    /// Vertices of the repaired mesh.
    pub(crate) landmarks: Vec<VertexId>,
    pub(crate) surface: IntrinsicMesh,
    /// From the vertices of the input to those of the repaired mesh.
    pub(crate) remap: Remap,
    /// Prepared when the first pair is finished.
    pub(crate) exact: Mutex<Option<Exact>>,
}

/// How the columns of a field were measured.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) struct Provenance {
    pub(crate) method: Method,
    pub(crate) repair: RepairOptions,
}

/// What the intervals of a field rest on.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "kind")]
pub enum FieldBounds {
    /// Exact distances from all landmarks and the triangle inequality: no interval can miss the distance.
    Certified,
    /// Distances by an approximate method. Twice its largest error in the exact columns widens the intervals.
    Measured {
        /// The most that a distance of the method counts as too long, in mesh units.
        over: f64,
        /// The most that it counts as too short.
        under: f64,
        /// Number of exact columns; they are not widened.
        exact_columns: usize,
    },
}

/// Facts about a field.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FieldFacts {
    /// Name of the method that measured the columns.
    pub method: &'static str,
    /// What the intervals rest on.
    pub bounds: FieldBounds,
    /// Vertices of the input.
    pub n_vertices: usize,
    /// Number of landmarks.
    pub n_landmarks: usize,
    /// Number of eigenpairs behind the estimates.
    pub rank: usize,
    /// The largest distance of a vertex from its nearest landmark, in mesh units.
    pub covering_radius: f64,
    /// Size of the file, in bytes.
    pub bytes: usize,
}

impl DistanceField {
    /// Number of vertices of the input.
    pub fn n_vertices(&self) -> usize {
        self.remap.n_old()
    }

    /// Facts about the field.
    pub fn facts(&self) -> FieldFacts {
        let tables = self.metric.tables();
        FieldFacts {
            method: self.provenance.method.name(),
            bounds: self.bounds(),
            n_vertices: self.n_vertices(),
            n_landmarks: tables.n_landmarks,
            rank: tables.rank,
            covering_radius: self.metric.covering_radius(),
            bytes: self.n_bytes(),
        }
    }

    /// What its intervals rest on.
    pub fn bounds(&self) -> FieldBounds {
        let tables = self.metric.tables();
        match tables.n_exact == tables.n_landmarks {
            true => FieldBounds::Certified,
            false => FieldBounds::Measured {
                over: tables.error.over,
                under: tables.error.under,
                exact_columns: tables.n_exact,
            },
        }
    }

    /// The landmarks: vertices of the input.
    pub fn landmarks(&self) -> Vec<VertexId> {
        self.landmarks.iter().map(|landmark| self.remap.to_old(*landmark)).collect()
    }

    /// The vertex of the repaired mesh that an input vertex became; `None` if it was dropped.
    pub(crate) fn repaired(&self, input: VertexId) -> Result<Option<VertexId>, FieldError> {
        match input.index() < self.n_vertices() {
            true => Ok(self.remap.to_new(input)),
            false => Err(GeodesicError::NoSuchVertex { vertex: input, n_vertices: self.n_vertices() }.into()),
        }
    }

    /// The exact solver of the surface, with the budget of a query.
    pub(crate) fn exact(&self, observer: &dyn Observer) -> Result<Exact, Exceeded> {
        // Other queries wait while one prepares it.
        let mut exact = self.exact.lock().unwrap_or_else(PoisonError::into_inner);
        observer.budget().check()?;
        let solver = exact.get_or_insert_with(|| Exact::new(&self.surface, observer)).observed_by(observer);
        observer.budget().check()?;
        Ok(solver)
    }
}
