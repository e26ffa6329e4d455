//! What comes in: repaired surfaces, points and paths in the numbers of the input, folders of meshes.

mod all_pairs;
mod dataset;
mod locate;
mod path;
pub(crate) mod point;
mod repaired;

pub use all_pairs::{AllPairs, Asymmetry};
pub(crate) use dataset::label_in;
pub use dataset::{LabelFile, ShapeFile, label_of, list_shapes};
pub use path::{PathPoint, SurfacePath};
pub use point::{BadPoint, InputPoint};
pub use repaired::Surface;
