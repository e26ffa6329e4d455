//! What comes in: folders, archives and lists of meshes, repaired surfaces, points and paths in the numbers of the input.

mod all_pairs;
mod boundary;
mod dataset;
mod for_description;
mod locate;
mod path;
pub(crate) mod point;
mod repaired;
mod storage;

pub use all_pairs::{AllPairs, Asymmetry};
pub use dataset::{Dataset, LabelFile, ShapeFile, SkipKind, Skipped, label_of, list_shapes};
pub(crate) use dataset::{count_skipped, drop_single_class, label_in};
pub use path::{PathPoint, SurfacePath};
pub use point::{BadPoint, InputPoint};
pub use repaired::{InputMap, Surface};
pub(crate) use storage::member_of;
pub use storage::{Storage, is_dataset, read_mesh, read_mesh_file};
