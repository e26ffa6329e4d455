//! The ends of shortest paths along edges.

/// The largest of the finite lengths with its vertex.
pub(super) fn farthest(lengths: &[f64]) -> (usize, f64) {
    let finite = lengths.iter().copied().enumerate().filter(|(_, length)| length.is_finite());
    finite.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, 0.0))
}
