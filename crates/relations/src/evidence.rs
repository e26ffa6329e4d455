//! What a relation is told from.

use base::ContentHash;
use descriptors::{Boundary, ShapeDistance};
use rigid::{Gap, Handedness};
use serde::{Serialize, Serializer};

use super::cut::CutPiece;
use super::parts::Parts;
use super::units::UnitChange;
use super::variant::Difference;

/// What a relation is taken from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Basis {
    /// The bytes of both files.
    Files,
    /// Both meshes. In a search, the file of the shape was read again.
    Meshes,
    /// What an index stores of the shapes: the file of one is missing or has changed, or was not read.
    #[default]
    Descriptions,
}

/// Everything that a relation is told from.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Evidence {
    /// What the relation is taken from.
    pub basis: Basis,
    /// How far the shapes are apart: of meshes with several components, the largest ones.
    #[serde(flatten)]
    pub distance: ShapeDistance,
    /// Probability, by this distance, that both are one shape in any pose.
    pub same_shape: f64,
    /// Probability, by this distance, that both are of one class.
    pub same_class: f64,
    /// The boundary of classes of a collection, if it has any: only then are classes spoken of.
    #[serde(skip)]
    pub classes: Option<Boundary>,
    /// Whether the second shape is the mirror image of the first.
    pub handedness: Handedness,
    /// Size of the second over that of the first.
    pub scale: f64,
    /// The change of the unit of length that explains the scale.
    pub units: Option<UnitChange>,
    /// Hashes of the files, where they are known.
    #[serde(serialize_with = "as_text")]
    pub content: [Option<ContentHash>; 2],
    /// Numbers of vertices in different positions.
    pub vertices: Option<[usize; 2]>,
    /// Numbers of faces.
    pub faces: Option<[usize; 2]>,
    /// Numbers of connected components.
    pub components: Option<[usize; 2]>,
    /// The angle of the rotation of the second mesh relative to the first, in degrees, if they have the same vertices and are
    /// not mirror images.
    pub rotation: Option<f64>,
    /// The largest distance between corresponding vertices of one geometry, relative to the size, the square root of the
    /// area.
    pub vertex_gap: Option<f64>,
    /// How far the surfaces are apart in space.
    pub surface_gap: Option<Gap>,
    /// The same in multiples of what triangles, rounding and noise explain: about 1 or less for copies of one surface.
    #[serde(skip)]
    pub gap_ratio: Option<f64>,
    /// How often one mesh occurs among the components of the other.
    pub parts: Option<Parts>,
    /// What was cut out of what.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cut: Option<CutPiece>,
    /// The dimensions in which variants of one part differ.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub differences: Vec<Difference>,
}

fn as_text<S: Serializer>(hashes: &[Option<ContentHash>; 2], out: S) -> Result<S::Ok, S::Error> {
    hashes.map(|hash| hash.map(|hash| hash.to_string())).serialize(out)
}
