//! What a mesh file holds, and how much of it may be read.

use mesh::{Fault, MeshError, TriMesh};
use serde::Serialize;

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

/// A scalar field read from a file.
#[derive(Debug, Clone, PartialEq)]
pub struct ScalarField {
    /// Its name in the file.
    pub name: String,
    /// One value per vertex, in the order of the file; NaN and infinities are allowed.
    pub values: Vec<f64>,
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
    /// The meter.
    Meter,
}

impl LengthUnit {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Micron, Self::Millimeter, Self::Centimeter, Self::Inch, Self::Foot, Self::Meter];

    /// The name, as in a 3MF file.
    pub fn name(self) -> &'static str {
        ["micron", "millimeter", "centimeter", "inch", "foot", "meter"][self as usize]
    }
}

/// A scalar field on the vertices of a mesh, with the colors to show it in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VertexField<'a> {
    /// Name of the property in the file: letters, digits and `_`, beginning with a letter.
    pub name: &'a str,
    /// One value per vertex; NaN and infinities are allowed.
    pub values: &'a [f64],
    /// One color per vertex: red, green, blue.
    pub colors: &'a [[u8; 3]],
}

impl VertexField<'_> {
    /// Refuses a field that does not fit the mesh or whose name a file cannot carry.
    pub(crate) fn check(&self, n_vertices: usize) -> Result<(), MeshError> {
        let lengths = [self.values.len(), self.colors.len()];
        if let Some(n_values) = lengths.into_iter().find(|length| *length != n_vertices) {
            return Err(MeshError::FieldLength { n_values, n_vertices });
        }
        let is_word = self.name.starts_with(|c: char| c.is_ascii_alphabetic())
            && self.name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        match is_word && !["x", "y", "z", "red", "green", "blue"].contains(&self.name) {
            true => Ok(()),
            false => Err(MeshError::FieldName(self.name.to_owned())),
        }
    }
}

/// The most vertices that 32-bit indices can count.
const MAX_VERTICES: u64 = u32::MAX as u64;
/// The most faces whose corners 32-bit indices can count.
const MAX_FACES: u64 = u32::MAX as u64 / 3;

/// The largest mesh to read.
///
/// The numbers in a header are checked before anything else is read. A file without a header is rejected as
/// soon as it exceeds a limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ReadLimits {
    /// Vertices. Default: as many as 32-bit indices can count.
    pub max_vertices: u64,
    /// Triangles. Default: as many as have corners that 32-bit indices can count.
    pub max_faces: u64,
    /// Bytes of a stream, whose size is not known in advance. Default: 8 GiB.
    pub max_bytes: u64,
}

impl Default for ReadLimits {
    fn default() -> Self {
        Self { max_vertices: MAX_VERTICES, max_faces: MAX_FACES, max_bytes: 8 << 30 }
    }
}

impl ReadLimits {
    /// At most `max_vertices` vertices and four times as many faces, twice as many as a closed surface has.
    pub fn of_vertices(max_vertices: u64) -> Self {
        let max_vertices = max_vertices.min(MAX_VERTICES);
        Self { max_vertices, max_faces: max_vertices.saturating_mul(4).min(MAX_FACES), ..Self::default() }
    }

    /// Returns a fault if a count exceeds its limit.
    pub(crate) fn check(&self, n_vertices: u64, n_faces: u64) -> Result<(), Fault> {
        let check = |items, count, limit, max| match count {
            _ if count <= limit => Ok(()),
            _ if limit >= max => {
                let text = format!("too many {items}: {count} (maximum {max}); simplify the mesh");
                Err(Fault::Malformed(text))
            }
            _ => Err(Fault::OverLimit { items, limit }),
        };
        check("vertices", n_vertices, self.max_vertices.min(MAX_VERTICES), MAX_VERTICES)?;
        check("faces", n_faces, self.max_faces.min(MAX_FACES), MAX_FACES)
    }
}
