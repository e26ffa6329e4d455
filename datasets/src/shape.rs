//! One shape: body and pose of a family through extraction, simplification, relaxation and bending.

use mesh::TriMesh;
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;
use surface::VertexId;

use crate::corner_table::CornerTable;
use crate::extract::{Lattice, RawSurface, extract};
use crate::model::Model;
use crate::pose::PosedSkeleton;
use crate::relax::relax;
use crate::simplify::{Surface, simplify};
use crate::stream::Stream;

/// Vertices of a lattice surface per unit of area over squared spacing, at least.
const CROSSINGS: f64 = 1.35;
/// Vertices extracted for every vertex wanted: simplification needs some to choose from.
const SURPLUS: f64 = 1.5;
/// Lattices tried, each finer than the one before.
const N_ATTEMPTS: usize = 8;
const REFINEMENT: f64 = 0.9;
/// How far edge lengths follow what the skeleton asks for: 0 would make all alike, 1 makes hands and faces
/// as fine as they deserve. Drawn anew for every shape, for shapes that are scanned or simplified one by
/// one are denser here in one and there in another. In this range the mean distance between two vertices
/// exceeds that between two points of the surface by about as much as on the low-resolution TOSCA shapes
/// of the same families, where it is 6 to 15 %.
const GRADING: [f64; 2] = [0.25, 0.6];
/// Rounds of flips and smoothing.
const N_ROUNDS: usize = 6;

/// The rest surface with `n_vertices`, or `None` if no lattice gives a sphere (in topology) of that size.
pub(crate) fn rest_surface(model: &Model, n_vertices: usize, stream: &mut Stream) -> Option<Surface> {
    let dense = (CROSSINGS * model.area / (SURPLUS * n_vertices as f64)).sqrt();
    let mut spacing = model.spacing.min(dense);
    let grading = stream.uniform(GRADING[0], GRADING[1]);
    for _ in 0..N_ATTEMPTS {
        let rotation = stream.rotation();
        let shift = Vector3::from([(); 3].map(|()| stream.uniform(0.0, 1.0)));
        let raw = extract(&model.body, Lattice { rotation, shift, spacing });
        spacing *= REFINEMENT;
        if let Some(surface) = sphere(model, raw, grading, n_vertices) {
            return Some(surface);
        }
    }
    None
}

fn sphere(model: &Model, raw: RawSurface, grading: f64, n_vertices: usize) -> Option<Surface> {
    let n_raw = raw.positions.len();
    // On a closed surface, Euler's formula of the sphere reads F = 2 V - 4; being connected is checked
    // by walking.
    if n_raw < n_vertices || raw.faces.len() + 4 != 2 * n_raw {
        return None;
    }
    let table = CornerTable::new(n_raw, &raw.faces)?;
    if !table.is_connected() {
        return None;
    }
    let grain = raw.positions.par_iter().map(|&p| 1.0 + grading * (model.skeleton.grain(p) - 1.0)).collect();
    let mut surface = Surface { table, positions: raw.positions, grain };
    if simplify(&mut surface, n_vertices) != n_vertices {
        return None;
    }
    surface.compact();
    relax(&mut surface, &model.body, N_ROUNDS);
    Some(surface)
}

/// The surface bent into a pose, scaled and set on the ground.
pub(crate) fn posed_positions(surface: &Surface, posed: &PosedSkeleton, scale: f64) -> Vec<Point3<f64>> {
    let mut moved: Vec<Point3<f64>> =
        surface.positions.par_iter().map(|&p| posed.deform(p) * scale).collect();
    let ground = moved.iter().map(|p| p.z).fold(f64::INFINITY, f64::min);
    moved.iter_mut().for_each(|p| p.z -= ground);
    moved
}

/// A mesh of the surface with the given positions, vertices and faces in random order.
pub(crate) fn shuffled(surface: &Surface, positions: &[Point3<f64>], stream: &mut Stream) -> TriMesh {
    let order = stream.permutation(positions.len());
    let mut mesh = TriMesh { positions: vec![Point3::origin(); positions.len()], faces: Vec::new() };
    for (&p, &to) in positions.iter().zip(&order) {
        mesh.positions[to as usize] = p;
    }
    let renumbered: Vec<[VertexId; 3]> =
        surface.table.faces().map(|f| f.map(|v| VertexId(order[v as usize]))).collect();
    mesh.faces = vec![[VertexId(0); 3]; renumbered.len()];
    let order = stream.permutation(renumbered.len());
    for (mut face, to) in renumbered.into_iter().zip(order) {
        face.rotate_left(stream.below(3));
        mesh.faces[to as usize] = face;
    }
    mesh
}
