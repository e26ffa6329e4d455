//! A map between two surfaces.

use linalg::Matrix;
use serde::Serialize;
use surface::VertexId;

use super::part_of_whole::PartOfWhole;

/// How a map treats the orientation of the surfaces.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum MapKind {
    /// It keeps the orientation: left goes to left.
    Direct,
    /// It reverses the orientation, as a mirror does: left goes to right.
    Mirrored,
    /// A surface cannot be oriented, or the map is too irregular to tell.
    Unoriented,
}

impl MapKind {
    /// The name on the command line and in records.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Direct => "direct",
            Self::Mirrored => "mirrored",
            Self::Unoriented => "unoriented",
        }
    }
}

/// A map from the vertices of one surface to those of another.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceMap {
    /// Whether it keeps the orientation.
    pub kind: MapKind,
    /// The mean change of distances, as a share of the square root of the area: `|d(x, g y) - d(f x, y)|` over landmarks `x` of
    /// the first and `y` of the second surface, both at unit area, with the map `f` and its inverse `g` (the codistortion of
    /// `memoli2005`, as a mean).
    pub distortion: f64,
    /// How far the map preserves orientation, from -1 to 1; `None` if a surface cannot be oriented.
    pub agreement: Option<f64>,
    /// How likely this map is the right one of its kind, and not the next best: the odds follow from the ratio of their scores
    /// (decision 19). At most 1/2 for a mixture of two maps, which agrees with an orientation in some places only.
    pub confidence: f64,
    /// The partner of each vertex of the first surface.
    pub vertices: Vec<VertexId>,
    /// How well the map keeps the distances of each vertex of the first surface to points near it, from 0, where it is torn or
    /// takes a region to a point, to 1: one less their relative change. It does not tell whether the whole map is right, which
    /// [`confidence`](Self::confidence) does.
    pub vertex_confidence: Vec<f64>,
    /// The map of functions of the second surface to functions of the first, in their eigenfunctions: `C`, as in
    /// [`LaplaceSpectrum`](descriptors::LaplaceSpectrum).
    pub functional: Matrix,
    /// The next best map of this kind, unless this one is [certain](Self::CERTAIN).
    pub alternative: Option<Box<SurfaceMap>>,
    /// Which surface is a part of the other; `None` if both are mapped as wholes.
    pub part: Option<PartOfWhole>,
}

impl SurfaceMap {
    /// Maps of at least this confidence are certain: the next best one is so much worse that it is not refined. A convention.
    pub const CERTAIN: f64 = 0.7;
}
