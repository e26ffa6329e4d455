//! The description of a family.

use crate::implicit::Body;
use crate::pose::Pose;
use crate::skeleton::Skeleton;

/// A body at rest, its skeleton and its poses.
#[derive(Debug, Clone)]
pub(crate) struct Model {
    pub(crate) body: Body,
    pub(crate) skeleton: Skeleton,
    /// Typical poses; the first is the rest pose.
    pub(crate) poses: Vec<Pose>,
    /// Number of handles of the rest surface.
    pub(crate) genus: usize,
    /// Area of the rest surface, in squared body units; families are scaled to a common one.
    pub(crate) area: f64,
    /// Coarsest lattice that resolves the smallest features, in body units.
    pub(crate) spacing: f64,
}
