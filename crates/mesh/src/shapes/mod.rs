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
//! let sheet = shapes::fold(&shapes::grid(9, 4, 0.5), 2.0, 1.0);
//! assert!((sheet.area() - 6.0).abs() < 1e-12);
//! ```

mod closed;
mod flat;

pub use closed::{cube, cylinder, icosphere, lopsided_torus, tetrahedron, torus};
pub use flat::{fold, grid, jittered_grid, sheared_grid};

use surface::VertexId;

use crate::refine::Splits;
use crate::tri_mesh::TriMesh;

/// Joins copies of all meshes, in order, into one mesh of several components.
pub fn disjoint(parts: &[TriMesh]) -> TriMesh {
    let mut whole = TriMesh::default();
    for part in parts {
        let shift = whole.n_vertices() as u32;
        whole.positions.extend(&part.positions);
        whole.faces.extend(part.faces.iter().map(|f| f.map(|v| VertexId(v.0 + shift))));
    }
    whole
}

/// Splits every face into four at the midpoints of its edges, without changing the surface.
///
/// The old vertices come first, unchanged, then one per edge in the order of [`surface::Topology::edges`]. Face `f` becomes
/// the faces `4 f .. 4 f + 4`, the one in the middle last.
///
/// # Panics
/// If a face has a repeated vertex or one that does not exist, see [`surface::Topology::new`].
pub fn subdivide(mesh: &TriMesh) -> TriMesh {
    let topology = mesh.topology();
    let mut splits = Splits::new(mesh.clone());
    splits.split(&topology, &(0..topology.n_edges()).collect::<Vec<_>>());
    splits.mesh
}
