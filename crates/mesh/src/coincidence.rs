//! Vertices in the same position.

use nalgebra::Point3;

/// Pairs of the first vertex in a position and each of the others there, in no particular order; minus zero equals zero.
/// `O(n log n)`.
pub(crate) fn coincident_pairs(
    positions: &[Point3<f64>],
    vertices: impl IntoIterator<Item = u32>,
) -> Vec<[u32; 2]> {
    let placed = vertices.into_iter().map(|v| {
        let p = &positions[v as usize];
        ([p.x, p.y, p.z].map(|x| (x + 0.0).to_bits()), v)
    });
    let mut placed: Vec<([u64; 3], u32)> = placed.collect();
    placed.sort_unstable();
    let together = placed.chunk_by(|a, b| a.0 == b.0);
    together.flat_map(|all| all[1..].iter().map(|other| [all[0].1, other.1])).collect()
}
