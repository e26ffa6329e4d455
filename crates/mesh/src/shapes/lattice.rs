//! Triangles of a lattice of vertices.

use surface::VertexId;

/// Two triangles for each of `nx` x `ny` quads, row by row; `vertex(i, j)` is the vertex at a lattice point.
pub(super) fn triangles(nx: usize, ny: usize, vertex: impl Fn(usize, usize) -> usize) -> Vec<[VertexId; 3]> {
    let quad = |q: usize| {
        let (i, j) = (q % nx, q / nx);
        [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)].map(VertexId::from)
    };
    (0..nx * ny).map(quad).flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect()
}
