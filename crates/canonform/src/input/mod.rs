//! What comes in: surfaces from files, all pairs of distances, and paths in the numbers of the input.

mod all_pairs;
mod path;
mod read;
mod rows;

pub use all_pairs::{AllPairs, Asymmetry};
pub use path::{PathPoint, SurfacePath};
pub use read::read_surface;
pub use rows::distance_rows;
