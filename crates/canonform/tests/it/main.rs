//! Laws of the crate, through what it exports.

// Helper functions are test code too, which clippy cannot see.
#![allow(clippy::unwrap_used)]

mod budgets;
mod collections;
mod explained;
mod flat;
mod progress;
mod threads;

use canonform::mesh::TriMesh;
use nalgebra::Point3;

fn moved(mesh: &TriMesh, motion: impl Fn(&Point3<f64>) -> Point3<f64>) -> TriMesh {
    TriMesh { positions: mesh.positions.iter().map(motion).collect(), faces: mesh.faces.clone() }
}
