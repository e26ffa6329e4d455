//! When two vertices are in the same place.

use nalgebra::Point3;

/// The bits of a position, for exact comparison and sorting; minus zero is zero.
#[inline]
pub(crate) fn position_key(p: &Point3<f64>) -> [u64; 3] {
    [p.x, p.y, p.z].map(|x| (x + 0.0).to_bits())
}
