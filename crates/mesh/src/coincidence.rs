//! Vertices in the same position.

use nalgebra::Point3;

/// The bits of a position, for exact comparison and sorting; minus zero equals zero.
#[inline]
pub(crate) fn position_key(p: &Point3<f64>) -> [u64; 3] {
    [p.x, p.y, p.z].map(|x| (x + 0.0).to_bits())
}

/// Pairs of vertices in the same position, `m - 1` pairs in ascending order for `m` vertices; `O(n log n)`.
pub(crate) fn coincident_pairs(
    positions: &[Point3<f64>],
    vertices: impl IntoIterator<Item = u32>,
) -> Vec<[u32; 2]> {
    let key = |v: u32| (position_key(&positions[v as usize]), v);
    let mut placed: Vec<_> = vertices.into_iter().map(key).collect();
    placed.sort_unstable();
    let pairs = placed.windows(2).filter(|pair| pair[0].0 == pair[1].0);
    pairs.map(|pair| [pair[0].1, pair[1].1]).collect()
}
