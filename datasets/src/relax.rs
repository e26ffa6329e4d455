//! Improvement of triangles on a surface: edge flips, tangential smoothing, projection.

use base::{Budget, Exceeded};
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;
use surface::{CornerId, VertexId};

use crate::implicit::ImplicitBody;
use crate::simplify::RestSurface;

/// Vertices per task of the thread pool.
const CHUNK: usize = 1024;
/// Smallest cosine of a dihedral angle, before and after a flip; beyond it, a flip would cut off a ridge.
const RIDGE_COSINE: f64 = 0.7;
/// Operations that a corner counts for in the meter of a budget.
const OPERATIONS: usize = 16;

/// Alternates flips and smoothing for `n_rounds` rounds; vertices end on the surface of the body. `surface` has
/// no removed vertices.
pub(crate) fn relax(
    surface: &mut RestSurface,
    body: &ImplicitBody,
    n_rounds: usize,
    budget: &Budget,
) -> Result<(), Exceeded> {
    flip_to_delaunay(surface, budget)?;
    for _ in 0..n_rounds {
        smooth(surface, body, budget)?;
        flip_to_delaunay(surface, budget)?;
    }
    Ok(())
}

/// Flips edges whose opposite angles add up to more than 180 degrees, in a few sweeps.
fn flip_to_delaunay(surface: &mut RestSurface, budget: &Budget) -> Result<(), Exceeded> {
    const N_SWEEPS: usize = 3;
    let mut meter = budget.meter();
    for _ in 0..N_SWEEPS {
        let mut n_flips = 0usize;
        for c in (0..surface.table.n_corners()).map(CornerId::from) {
            meter.count(OPERATIONS)?;
            if surface.wants_flip(c) && surface.table.can_flip(c) {
                surface.table.flip(c);
                n_flips += 1;
            }
        }
        if n_flips == 0 {
            break;
        }
    }
    Ok(())
}

impl RestSurface {
    fn wants_flip(&self, c: CornerId) -> bool {
        let o = self.table.twin(c);
        if o < c {
            return false;
        }
        let at = |corner: CornerId| self.positions[self.table.vertex(corner).index()];
        let (p, q, u, w) = (at(c), at(o), at(c.next()), at(c.prev()));
        let cotangents = cotangent(p, u, w) + cotangent(q, u, w);
        if cotangents >= -1e-9 {
            return false;
        }
        let cosine = |[a, b]: [Vector3<f64>; 2]| a.dot(&b) / (a.norm() * b.norm());
        let before = [(u - p).cross(&(w - p)), (w - q).cross(&(u - q))];
        let after = [(u - p).cross(&(q - p)), (w - q).cross(&(p - q))];
        cosine(before) > RIDGE_COSINE && cosine(after) > RIDGE_COSINE
    }
}

/// Cotangent of the angle at `apex` between `a` and `b`.
fn cotangent(apex: Point3<f64>, a: Point3<f64>, b: Point3<f64>) -> f64 {
    let (x, y) = (a - apex, b - apex);
    x.dot(&y) / x.cross(&y).norm().max(1e-300)
}

/// Moves each vertex in its tangent plane towards the weighted center of its neighbors, then back onto the surface.
/// The weights are proportional to the length of an edge over its grain, so that edges approach lengths proportional
/// to the grain. All vertices move at once, so the result does not depend on their order or on the number of threads.
fn smooth(surface: &mut RestSurface, body: &ImplicitBody, budget: &Budget) -> Result<(), Exceeded> {
    let (table, old, grain) = (&surface.table, &surface.positions, &surface.grain);
    let target = |v: usize| {
        let mut pull = Vector3::zeros();
        let (mut total, mut shortest) = (0.0, f64::INFINITY);
        for x in table.neighbors(VertexId::from(v)).map(VertexId::index) {
            let edge = old[x] - old[v];
            let length = edge.norm();
            let weight = length / (grain[x] + grain[v]);
            pull += edge * weight;
            total += weight;
            shortest = shortest.min(length);
        }
        let (value, gradient) = body.sample(old[v]);
        let squared = gradient.norm_squared().max(1e-12);
        let step = pull / total.max(1e-300);
        let tangential = step - gradient * (step.dot(&gradient) / squared);
        // The value corrects what the curvature caused in the last round.
        let moved = old[v] + tangential * 0.6 - gradient * (value / squared).clamp(-shortest, shortest);
        body.project(moved, 1, shortest)
    };
    let mut moved = old.clone();
    moved.par_chunks_mut(CHUNK).enumerate().try_for_each(|(chunk, positions)| {
        budget.check()?;
        for (i, p) in positions.iter_mut().enumerate() {
            *p = target(chunk * CHUNK + i);
        }
        Ok(())
    })?;
    surface.positions = moved;
    Ok(())
}
