//! Normals for smooth shading of faces without consistent orientation.

use mesh::TriMesh;
use nalgebra::Vector3;
use surface::Rows;

use super::camera::Camera;

/// Most faces at a vertex that are compared with each other.
const MANY: usize = 256;

/// One unit normal per corner of every face, in camera axes (right, up, towards the viewer), on the visible side.
///
/// The normal of a corner sums the area vectors of the faces at its vertex whose angle to the corner's own face is
/// below `crease` degrees, each first turned to the side of that face. So the result does not depend on the
/// orientation of faces, and the two sides of a thin sheet do not cancel. At a vertex of more than [`MANY`] faces, each keeps
/// its own normal.
pub(super) fn corner_normals(mesh: &TriMesh, camera: &Camera, crease: f64) -> Vec<[Vector3<f32>; 3]> {
    let areas = (0..mesh.n_faces()).map(|f| camera.axes * mesh.area_vector(f));
    let areas: Vec<Vector3<f64>> = areas.map(|area| if area.z < 0.0 { -area } else { area }).collect();
    let units: Vec<Vector3<f64>> =
        areas.iter().map(|a| a.try_normalize(0.0).unwrap_or_else(Vector3::z)).collect();
    let at_vertices = mesh.faces.iter().enumerate().flat_map(|(f, face)| face.map(|v| (v.index(), f as u32)));
    let around = Rows::collect(mesh.n_vertices(), at_vertices);
    let limit = crease.to_radians().cos() - 1e-9;
    let normal = |face: usize, vertex: usize| {
        let (own, around) = (units[face], around.row(vertex));
        let turned = |&other: &u32| {
            let bend = units[other as usize].dot(&own);
            if bend.abs() < limit { Vector3::zeros() } else { areas[other as usize] * bend.signum() }
        };
        let sum: Vector3<f64> = if around.len() > MANY { own } else { around.iter().map(turned).sum() };
        sum.try_normalize(0.0).unwrap_or(own).cast::<f32>()
    };
    mesh.faces.iter().enumerate().map(|(f, face)| face.map(|v| normal(f, v.index()))).collect()
}
