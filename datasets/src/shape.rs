//! One shape: body and pose of a family through extraction, simplification, relaxation and bending.

use base::{Budget, Exceeded};
use mesh::TriMesh;
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;
use surface::{VertexId, components_of_faces};

use crate::corner_table::EditableCorners;
use crate::extract::{Lattice, extract};
use crate::model::BodyModel;
use crate::pose::PosedSkeleton;
use crate::relax::relax;
use crate::simplify::{RestSurface, simplify};
use crate::stream::Stream;

/// Lower bound of the number of vertices of a lattice surface, per area over squared spacing.
const CROSSINGS: f64 = 1.35;
/// Extracted vertices per requested vertex, so that simplification has a choice.
const SURPLUS: f64 = 1.5;
/// Most lattices to try, each finer than the one before.
const N_ATTEMPTS: usize = 8;
const REFINEMENT: f64 = 0.9;
/// Range of the influence of the skeleton's grain on edge lengths: 0 makes all edges equal, 1 follows the
/// grain. It is drawn for every shape, since the density of scanned shapes differs from one to the next. In
/// this range, the mean distance between two vertices exceeds that between two points of the surface by about
/// as much as on the low-resolution TOSCA shapes of the same families, 6 to 15 %.
const GRADING: [f64; 2] = [0.25, 0.6];
/// Rounds of flips and smoothing.
const N_ROUNDS: usize = 6;

/// The rest surface with `n_vertices` vertices; `None` if no lattice gives a closed surface of that size in one piece and
/// with as many handles as the model says.
pub(crate) fn rest_surface(
    model: &BodyModel,
    n_vertices: usize,
    stream: &mut Stream,
    budget: &Budget,
) -> Result<Option<RestSurface>, Exceeded> {
    let dense = (CROSSINGS * model.area / (SURPLUS * n_vertices as f64)).sqrt();
    let mut spacing = model.spacing.min(dense);
    let grading = stream.uniform(GRADING[0], GRADING[1]);
    for _ in 0..N_ATTEMPTS {
        let rotation = stream.rotation();
        let shift = Vector3::from([(); 3].map(|()| stream.uniform(0.0, 1.0)));
        let raw = extract(&model.body, Lattice { rotation, shift, spacing }, budget)?;
        spacing *= REFINEMENT;
        if let Some(surface) = closed_surface(model, raw, grading, n_vertices, budget)? {
            return Ok(Some(surface));
        }
    }
    Ok(None)
}

fn closed_surface(
    model: &BodyModel,
    raw: TriMesh,
    grading: f64,
    n_vertices: usize,
    budget: &Budget,
) -> Result<Option<RestSurface>, Exceeded> {
    let n_raw = raw.positions.len();
    if n_raw < n_vertices || genus(&raw) != Some(model.genus) {
        return Ok(None);
    }
    budget.check()?;
    let Some(table) = EditableCorners::new(n_raw, &raw.faces) else { return Ok(None) };
    let grain = raw.positions.par_iter().map(|&p| 1.0 + grading * (model.skeleton.grain(p) - 1.0)).collect();
    let mut surface = RestSurface { table, positions: raw.positions, grain };
    simplify(&mut surface, n_vertices, budget)?;
    if surface.table.n_vertices() != n_vertices {
        return Ok(None);
    }
    surface.compact();
    relax(&mut surface, &model.body, N_ROUNDS, budget)?;
    Ok(Some(surface))
}

/// The number of handles of an extracted surface; `None` unless it is in one piece.
pub(crate) fn genus(raw: &TriMesh) -> Option<usize> {
    let n_vertices = raw.positions.len();
    let is_connected = components_of_faces(n_vertices, &raw.faces).count == 1;
    // Euler's formula of a closed surface is F = 2 V - 4 + 4 g.
    let quadruple = (raw.faces.len() + 4).checked_sub(2 * n_vertices)?;
    is_connected.then_some(quadruple / 4)
}

/// The positions of the surface in a pose, scaled and standing on the ground.
pub(crate) fn posed_positions(surface: &RestSurface, posed: &PosedSkeleton, scale: f64) -> Vec<Point3<f64>> {
    let mut moved: Vec<Point3<f64>> =
        surface.positions.par_iter().map(|&p| posed.deform(p) * scale).collect();
    let ground = moved.iter().map(|p| p.z).fold(f64::INFINITY, f64::min);
    moved.iter_mut().for_each(|p| p.z -= ground);
    moved
}

/// A mesh of the surface with the given positions and with vertices and faces in random order.
pub(crate) fn shuffled(surface: &RestSurface, positions: &[Point3<f64>], stream: &mut Stream) -> TriMesh {
    let order = stream.permutation(positions.len());
    let mut mesh = TriMesh { positions: vec![Point3::origin(); positions.len()], faces: Vec::new() };
    for (&p, &to) in positions.iter().zip(&order) {
        mesh.positions[to as usize] = p;
    }
    let renumbered: Vec<[VertexId; 3]> =
        surface.table.faces().map(|f| f.map(|v| VertexId(order[v.index()]))).collect();
    mesh.faces = vec![[VertexId(0); 3]; renumbered.len()];
    let order = stream.permutation(renumbered.len());
    for (mut face, to) in renumbered.into_iter().zip(order) {
        face.rotate_left(stream.below(3));
        mesh.faces[to as usize] = face;
    }
    mesh
}
