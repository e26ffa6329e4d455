//! What a mesh file says beside the mesh.

use serde::Serialize;

use super::field::ScalarField;
use mesh::TriMesh;

/// A mesh and what else its file says.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MeshFile {
    /// The mesh, in the coordinates of the file.
    pub mesh: TriMesh,
    /// A value per vertex, if the file has one.
    pub field: Option<ScalarField>,
    /// Everything else.
    pub facts: FileFacts,
}

/// What a mesh file says beside the mesh. Formats that say nothing have the default.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
pub struct FileFacts {
    /// The unit of the coordinates, which are not converted. `None` if the format has no unit.
    pub unit: Option<LengthUnit>,
    /// Number of copies of meshes that were put together. `None` if the format has a single mesh.
    pub instances: Option<usize>,
    /// What was ignored although it has to do with the shape, in words.
    pub ignored: Vec<&'static str>,
    /// What is uncertain about the surface, in words.
    pub notes: Vec<String>,
}

/// A unit of length.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum LengthUnit {
    /// 1e-6 m.
    Micron,
    /// 1e-3 m.
    Millimeter,
    /// 1e-2 m.
    Centimeter,
    /// 0.0254 m.
    Inch,
    /// 0.3048 m.
    Foot,
    /// The metre.
    Meter,
}

impl LengthUnit {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Micron, Self::Millimeter, Self::Centimeter, Self::Inch, Self::Foot, Self::Meter];

    /// The name, as in a 3MF file.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Micron => "micron",
            Self::Millimeter => "millimeter",
            Self::Centimeter => "centimeter",
            Self::Inch => "inch",
            Self::Foot => "foot",
            Self::Meter => "meter",
        }
    }
}
