//! A surface as the viewer in the browser takes it.

use mesh::TriMesh;
use nalgebra::{Point3, Vector3};
use serde::{Deserialize, Serialize};
use surface::VertexId;

use super::words;

/// A surface in single precision. In JSON, arrays are base64 of their little-endian bytes.
///
/// `{"positions": f32 x, y, z of every vertex, "faces": u32 a, b, c of every face, "values": f32 of every vertex,
/// "values_name": string}`; the last two are optional.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Geometry {
    /// Vertex positions, in mesh units.
    #[serde(with = "words")]
    pub positions: Vec<[f32; 3]>,
    /// The vertices of every face.
    #[serde(with = "words")]
    pub faces: Vec<[u32; 3]>,
    /// A number per vertex, for its color, or nothing; NaN if the vertex has none.
    #[serde(with = "words", default, skip_serializing_if = "Vec::is_empty")]
    pub values: Vec<f32>,
    /// The name and unit of the values, for the color bar.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub values_name: Option<String>,
}

impl Geometry {
    /// A surface whose bounding box is centered at the origin.
    ///
    /// Faces with a corner that does not exist or is not finite are left out.
    pub fn new(mesh: &TriMesh) -> Self {
        let middle =
            mesh.bounds().map_or_else(Vector3::zeros, |[low, high]| (low.coords + high.coords) / 2.0);
        Self::around(mesh, middle)
    }

    /// A surface where it is, for several surfaces in one scene.
    pub fn in_place(mesh: &TriMesh) -> Self {
        Self::around(mesh, Vector3::zeros())
    }

    fn around(mesh: &TriMesh, middle: Vector3<f64>) -> Self {
        // A middle that is not finite would make every vertex so.
        let middle = if middle.iter().all(|c| c.is_finite()) { middle } else { Vector3::zeros() };
        let single = |p: &Point3<f64>| (p - middle).coords.map(|c| c as f32).into();
        let positions: Vec<[f32; 3]> = mesh.positions.iter().map(single).collect();
        let usable = |v: &u32| positions.get(*v as usize).is_some_and(|p| p.iter().all(|c| c.is_finite()));
        let faces =
            mesh.faces.iter().map(|face| face.map(|v| v.0)).filter(|f| f.iter().all(usable)).collect();
        Self { positions, faces, ..Self::default() }
    }

    /// The surface as a mesh.
    pub fn mesh(&self) -> TriMesh {
        TriMesh {
            positions: self.positions.iter().map(|p| Point3::from(p.map(f64::from))).collect(),
            faces: self.faces.iter().map(|face| face.map(VertexId)).collect(),
        }
    }

    /// The surface with a number per vertex. Missing numbers are NaN, excess ones are dropped.
    pub fn with_values(self, name: impl Into<String>, values: &[f64]) -> Self {
        let value = |v: usize| values.get(v).map_or(f32::NAN, |value| *value as f32);
        let values = (0..self.positions.len()).map(value).collect();
        Self { values, values_name: Some(name.into()), ..self }
    }
}
