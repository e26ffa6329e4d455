//! Decimation and remeshing.

use base::Budget;
use mesh::{TriMesh, collapse_edges, shapes};

use crate::stream::Stream;

/// Vertices per new vertex before a mesh is triangulated anew.
const SURPLUS: usize = 6;

/// Triangulates a mesh anew, with the given share of its vertices: splits its faces into many and collapses short edges, in
/// an order that is partly random.
pub(super) fn remeshed(mesh: &TriMesh, share: f64, stream: &mut Stream) -> TriMesh {
    let n_vertices = (share * mesh.n_vertices() as f64) as usize;
    let mut fine = mesh.without_unused_vertices();
    while !fine.faces.is_empty() && fine.n_vertices() < SURPLUS * n_vertices {
        fine = shapes::subdivide(&fine);
    }
    let factors: Vec<f64> = (0..fine.n_vertices()).map(|_| stream.uniform(0.7, 1.4)).collect();
    collapsed(&fine, n_vertices, &|_, sq_length, [a, b]| sq_length * factors[a] * factors[b])
}

/// Collapses edges by their cost until `n_vertices` vertices are left.
pub(super) fn collapsed(
    mesh: &TriMesh,
    n_vertices: usize,
    cost: &dyn Fn(f64, f64, [usize; 2]) -> f64,
) -> TriMesh {
    match collapse_edges(mesh, n_vertices, cost, &Budget::unlimited()) {
        Ok(found) => found.mesh,
        Err(_) => unreachable!("the budget is unlimited"),
    }
}
