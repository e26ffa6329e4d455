//! Normals for smooth shading of faces without consistent orientation.

use std::collections::{BTreeMap, HashMap};

use mesh::TriMesh;
use nalgebra::Vector3;
use surface::Rows;

use super::camera::Camera;

/// Faces at a vertex that are compared with each other one by one.
const MANY: usize = 256;

/// Directions are told apart by this many steps on either side of a face of a cube.
const STEPS: f64 = 6.0;

/// Sums the area vectors of about the same direction, up to sign: some hundred sums at most, none of them zero.
fn by_direction(faces: impl Iterator<Item = (Vector3<f64>, Vector3<f64>)>) -> Vec<Vector3<f64>> {
    let mut sums = BTreeMap::<[i8; 3], Vector3<f64>>::new();
    for (area, unit) in faces {
        let axis = unit.iamax();
        let scale = STEPS / unit[axis];
        let cell = [0, 1, 2].map(|i| if i == axis { i8::MAX } else { (unit[i] * scale).round() as i8 });
        *sums.entry(cell).or_insert_with(Vector3::zeros) += if unit[axis] < 0.0 { -area } else { area };
    }
    sums.into_values().filter(|sum| sum.norm() > 0.0).collect()
}

/// One unit normal per corner of every face, in camera axes (right, up, towards the viewer), on the visible side.
///
/// The normal of a corner sums the area vectors of the faces at its vertex whose angle to the corner's own face is
/// below `crease` degrees, each first turned to the side of that face. So the result does not depend on the
/// orientation of faces, and the two sides of a thin sheet do not cancel. At a vertex of more than [`MANY`] faces, those
/// of about the same direction count as one.
pub(super) fn corner_normals(
    mesh: &TriMesh,
    faces: &[[usize; 3]],
    camera: &Camera,
    crease: f64,
) -> Vec<[Vector3<f32>; 3]> {
    let areas: Vec<Vector3<f64>> = faces
        .iter()
        .map(|f| {
            let [a, b, c] = f.map(|v| mesh.positions[v]);
            camera.axes * (b - a).cross(&(c - a))
        })
        .map(|area| if area.z < 0.0 { -area } else { area })
        .collect();
    let units: Vec<Vector3<f64>> =
        areas.iter().map(|a| a.try_normalize(0.0).unwrap_or_else(Vector3::z)).collect();
    let at_vertices = faces.iter().enumerate().flat_map(|(f, face)| face.map(|v| (v, f as u32)));
    let around = Rows::collect(mesh.n_vertices(), at_vertices);
    let merged: HashMap<usize, Vec<Vector3<f64>>> = (0..mesh.n_vertices())
        .filter(|v| around.row(*v).len() > MANY)
        .map(|v| (v, by_direction(around.row(v).iter().map(|&g| (areas[g as usize], units[g as usize])))))
        .collect();
    let limit = crease.to_radians().cos() - 1e-9;
    let normal = |face: usize, vertex: usize| {
        let own = units[face];
        let turned = |area: Vector3<f64>, unit: Vector3<f64>| {
            let bend = unit.dot(&own);
            if bend.abs() < limit { Vector3::zeros() } else { area * bend.signum() }
        };
        let sum: Vector3<f64> = match merged.get(&vertex) {
            Some(merged) => merged.iter().map(|area| turned(*area, area.normalize())).sum(),
            None => around.row(vertex).iter().map(|&g| turned(areas[g as usize], units[g as usize])).sum(),
        };
        sum.try_normalize(0.0).unwrap_or(own).cast::<f32>()
    };
    faces.iter().enumerate().map(|(f, face)| face.map(|v| normal(f, v))).collect()
}
