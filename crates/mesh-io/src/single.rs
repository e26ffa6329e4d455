//! Coordinates that are rounded to 32 bits.

use mesh::TriMesh;
use nalgebra::Point3;

/// A position less the origin, as 32 bits hold it.
pub(crate) fn rounded(p: &Point3<f64>, origin: &Point3<f64>) -> [f32; 3] {
    [0, 1, 2].map(|axis| (p[axis] - origin[axis]) as f32)
}

/// Share of the area that rounding may take without a word, as a repair may.
const ALLOWED_LOSS: f64 = 0.01;

/// The first face with different corners that rounding makes equal, if such faces hold more of the area than is allowed.
pub(crate) fn merged_face(mesh: &TriMesh, origin: &Point3<f64>) -> Option<usize> {
    let is_merged = |face: &usize| {
        let [a, b, c] = mesh.triangle(*face);
        [(a, b), (b, c), (c, a)].iter().any(|(p, q)| p != q && rounded(p, origin) == rounded(q, origin))
    };
    let (mut first, mut lost) = (None, 0.0);
    for (face, area) in mesh.face_areas().enumerate().filter(|(face, _)| is_merged(face)) {
        first = first.or(Some(face));
        lost += area;
    }
    first.filter(|_| lost > ALLOWED_LOSS * mesh.area())
}

/// An origin that 32 bits hold: the middle of a mesh whose faces would collapse otherwise.
pub(crate) fn origin(mesh: &TriMesh) -> Point3<f64> {
    let origin = Point3::origin();
    match mesh.bounds().filter(|_| merged_face(mesh, &origin).is_some()) {
        Some([lo, hi]) => Point3::from(rounded(&nalgebra::center(&lo, &hi), &origin)).cast(),
        None => origin,
    }
}
