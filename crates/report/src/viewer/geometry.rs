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
    /// A number per vertex, for its color; NaN if the vertex has none.
    #[serde(with = "words", default, skip_serializing_if = "Option::is_none")]
    pub values: Option<Vec<f32>>,
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
        Self { values: Some(values), values_name: Some(name.into()), ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle() -> TriMesh {
        let positions = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 6.0, 4.0]].map(Point3::from).to_vec();
        TriMesh { positions, faces: vec![[0, 1, 2].map(VertexId)] }
    }

    #[test]
    fn arrays_read_back_from_json_to_the_bit() {
        let one = Geometry::new(&triangle()).with_values("distance", &[0.0, f64::NAN, 1.0 / 3.0]);
        let json = serde_json::to_string(&one).unwrap();
        let back: Geometry = serde_json::from_str(&json).unwrap();
        assert_eq!((&back.positions, &back.faces), (&one.positions, &one.faces));
        let bits = |g: &Geometry| g.values.iter().flatten().map(|v| v.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&back), bits(&one), "NaN included");
        assert_eq!(back.values_name.as_deref(), Some("distance"));
        let bare = serde_json::to_value(Geometry::new(&triangle())).unwrap();
        assert_eq!(bare.as_object().unwrap().len(), 2, "absent fields are left out: {bare}");
        // The first vertex, little-endian: -1 is 0xbf800000, -3 is 0xc0400000, -2 is 0xc0000000.
        assert!(bare["positions"].as_str().unwrap().starts_with("AACAvwAAQMAAAADA"), "{bare}");
        assert_eq!(bare["faces"], "AAAAAAEAAAACAAAA");
    }

    #[test]
    fn surfaces_are_centered_unusable_faces_are_left_out_and_missing_values_are_nan() {
        assert_eq!(
            Geometry::new(&triangle()).positions,
            [[-1.0, -3.0, -2.0], [1.0, -3.0, -2.0], [-1.0, 3.0, 2.0]]
        );
        assert_eq!(Geometry::in_place(&triangle()).mesh(), triangle());
        assert_eq!(Geometry::new(&TriMesh::default()), Geometry::default());
        let mut mesh = triangle();
        mesh.positions.push(Point3::new(f64::NAN, 0.0, 0.0));
        mesh.faces.extend([[0, 1, 3], [0, 1, 9]].map(|f: [u32; 3]| f.map(VertexId)));
        let geometry = Geometry::new(&mesh).with_values("v", &[1.0]);
        assert_eq!(geometry.faces, [[0, 1, 2]]);
        let values = geometry.values.unwrap();
        assert!(values.len() == 4 && values[0] == 1.0 && values[1..].iter().all(|v| v.is_nan()));
    }

    #[test]
    fn strings_that_are_not_arrays_are_refused() {
        for (positions, what) in [("AAAA", "3 bytes are not a whole number of groups"), ("?", "not base64")] {
            let json = serde_json::json!({"positions": positions, "faces": ""});
            assert!(serde_json::from_value::<Geometry>(json).unwrap_err().to_string().contains(what));
        }
    }
}
