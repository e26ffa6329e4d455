//! A map between two surfaces.

use descriptors::Side;
use linalg::Matrix;
use serde::Serialize;
use surface::VertexId;

/// Which of two mapped surfaces is a part of the other.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PartOfWhole {
    /// The surface that is a part.
    pub part: Side,
    /// The share of the area of the whole that has partners.
    pub covered: f64,
    /// For each vertex of the first surface and of the second, its partner on the other, if it has one. All of the part have.
    #[serde(skip)]
    pub partners: [Vec<Option<VertexId>>; 2],
}

/// Maps agree with an orientation beyond this. A safety limit: it is near 1 or -1 for smooth maps, and 0 for random ones.
const AGREEMENT: f64 = 0.1;

/// How a map treats the orientation of the surfaces.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, strum::IntoStaticStr)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum MapKind {
    /// It keeps the orientation: left goes to left.
    Direct,
    /// It reverses the orientation, as a mirror does: left goes to right.
    Mirrored,
    /// A surface cannot be oriented, or the map is too irregular to tell.
    Unoriented,
}

impl MapKind {
    /// All kinds.
    pub(crate) const ALL: [Self; 3] = [Self::Direct, Self::Mirrored, Self::Unoriented];

    /// The name on the command line and in records.
    pub fn name(self) -> &'static str {
        self.into()
    }
}

/// The kind of a map of some agreement.
impl From<Option<f64>> for MapKind {
    fn from(agreement: Option<f64>) -> Self {
        match agreement {
            Some(value) if value > AGREEMENT => Self::Direct,
            Some(value) if value < -AGREEMENT => Self::Mirrored,
            _ => Self::Unoriented,
        }
    }
}

/// The most confidence in a map that misses a landmark, that mixes two maps, or whose rival is better after refinement: as likely
/// wrong as right.
pub(crate) const DOUBTED: f64 = 0.5;

/// A map from the vertices of one surface to those of another. [`map_surfaces`](crate::map_surfaces) numbers vertices as its surfaces do.
#[derive(Debug, Clone, PartialEq, Serialize)]
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
    /// The next best map of this kind, unless the odds of this one are [certain](descriptors::Boundary::CERTAIN).
    pub alternative: Option<Box<SurfaceMap>>,
    /// Which surface is a part of the other, and how much of the whole it covers; `None` if both are mapped as wholes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub part: Option<PartOfWhole>,
    /// The partner of each vertex of the first surface, if it has one.
    #[serde(skip)]
    pub vertices: Vec<Option<VertexId>>,
    /// How well the map keeps the distances of each vertex of the first surface to points near it, from 0, where it is torn or
    /// takes a region to a point, to 1: one less their relative change. It does not tell whether the whole map is right, which
    /// [`confidence`](Self::confidence) does.
    #[serde(skip)]
    pub vertex_confidence: Vec<f64>,
    /// The map of functions of the second surface to functions of the first, in their eigenfunctions: `C`, as in
    /// [`LaplaceSpectrum`](descriptors::LaplaceSpectrum). That of a part has fewer eigenfunctions of the part, and functions of the
    /// part are zero elsewhere.
    #[serde(skip)]
    pub functional: Matrix,
    /// The landmarks that it was given and contains.
    #[serde(skip)]
    pub landmarks: Vec<[VertexId; 2]>,
}

impl SurfaceMap {
    /// Maps of at least this confidence are certain. A convention.
    pub const CERTAIN: f64 = 0.7;

    /// Whether no other map of its kind is nearly as good.
    pub fn is_certain(&self) -> bool {
        self.confidence >= Self::CERTAIN
    }
}

/// The mean of `|d(x_i, g y_j) - d(f x_i, y_j)|` over landmarks, from the distances on the first and on the second surface
/// from its landmarks to the images of those of the other one.
pub(crate) fn codistortion(on_a: &Matrix, on_b: &Matrix) -> f64 {
    let gaps = (0..on_a.nrows()).flat_map(|i| (0..on_a.ncols()).map(move |j| (i, j)));
    let sum: f64 = gaps.map(|(i, j)| (on_a[(i, j)] - on_b[(j, i)]).abs()).sum();
    sum / on_a.len().max(1) as f64
}
