//! Small analytic shapes for tests, benches and documentation.
//!
//! Closed shapes run counter-clockwise seen from outside. The functions panic, as said at each, on
//! sizes that make no shape: their arguments are written by programmers, not read from files.

mod closed;
mod flat;
mod subdivision;

pub use closed::{cube, cylinder, icosphere, tetrahedron, torus};
pub use flat::{fold, folded_sheet, grid, jittered_grid, sheared_grid};
pub use subdivision::subdivide;

use crate::TriMesh;
use surface::VertexId;

/// One mesh that holds copies of all the given ones side by side, in order, sharing nothing.
#[must_use]
pub fn disjoint(parts: &[TriMesh]) -> TriMesh {
    let mut whole = TriMesh::default();
    for part in parts {
        let shift = whole.n_vertices() as u32;
        whole.positions.extend(&part.positions);
        whole.faces.extend(part.faces.iter().map(|f| f.map(|v| VertexId(v.0 + shift))));
    }
    whole
}
