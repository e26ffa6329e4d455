//! Small analytic shapes for tests, benches and documentation.
//!
//! The faces of closed shapes are counter-clockwise as seen from outside. Sizes too small for a shape are
//! programming errors and panic.
//!
//! ```
//! use canonform_mesh::{shapes, validate};
//!
//! let torus = shapes::torus(40, 20, 2.0, 0.5);
//! assert_eq!(validate(&torus).genus, Some(1));
//!
//! // Folding a sheet along a column of vertices keeps all edge lengths.
//! let sheet = shapes::folded_sheet(9, 4, 0.5, 4, 1.0);
//! assert!((sheet.area() - 6.0).abs() < 1e-12);
//! ```

mod closed;
mod flat;
mod subdivision;

pub use closed::{cube, cylinder, icosphere, lopsided_torus, tetrahedron, torus};
pub use flat::{fold, folded_sheet, grid, jittered_grid, sheared_grid};
pub use subdivision::subdivide;

use surface::VertexId;

use crate::tri_mesh::TriMesh;

/// Joins copies of all meshes, in order, into one mesh of several components.
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
