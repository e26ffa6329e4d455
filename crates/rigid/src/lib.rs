//! Rigid alignment in space: motions, changes of size and reflections that bring two point sets or two surfaces together.
//!
//! ```text
//! points  -> PointSet     -> align_points   -> Alignment { map: Similarity, gap: Gap } -> Handedness
//! TriMesh -> RigidSurface -> align_surfaces -> the same
//! ```
//!
//! Starts come from principal axes, turns about them, and main directions of planes; iterative closest points refine them
//! towards points or towards tangent planes. Knows nothing of forms or files.

mod align_points;
mod align_surfaces;
mod farthest_points;
mod handedness;
mod icp;
mod nearest;
mod point_set;
mod rigid_surface;
mod similarity;
mod starts;
mod triangles;

pub use align_points::{Reflections, align_points, alignments};
pub use align_surfaces::{MAX_DEVIATION, align_surfaces, axis_deviation, is_symmetric};
pub use farthest_points::{FarthestPoints, farthest_points, farthest_points_by};
pub use handedness::{Handedness, OrientedPoints};
pub use icp::{Alignment, Gap, MIN_DAMPING, SmallStep, fitted_step, moved_along};
pub use nearest::{NearestPoints, NoExtent};
pub use point_set::PointSet;
pub use rigid_surface::{RigidSurface, rms_radius};
pub use similarity::{Similarity, nearest_rotation};
pub use triangles::{NearestOnSurface, OnTriangle, TriangleTree};
