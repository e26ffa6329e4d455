//! A straight step of a path.

use surface::SurfacePoint;

/// A straight step of a path towards the source: where it leads, and its length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Step {
    pub(super) to: SurfacePoint,
    pub(super) length: f64,
}
