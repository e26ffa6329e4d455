//! Surfaces for tests.

use mesh::{TriMesh, shapes};
use nalgebra::Point3;

/// A torus with a bump: no symmetry.
pub(crate) fn lopsided() -> TriMesh {
    let mut mesh = shapes::torus(40, 20, 2.0, 0.7);
    for p in &mut mesh.positions {
        let bump = (-(*p - Point3::new(2.4, 0.5, 0.3)).norm_squared()).exp();
        p.coords *= 1.0 + 0.5 * bump + 0.1 * p.y;
    }
    mesh
}
