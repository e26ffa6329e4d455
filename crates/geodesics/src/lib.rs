//! Geodesic distances on triangle meshes.
//!
//! `surface::IntrinsicMesh` -> **geodesics** -> `linalg::LandmarkDistances` -> `nmds`
//!
//! **Invariant.** Nothing here reads vertex coordinates: solvers see edge lengths only, so an
//! isometry of the surface cannot change their output.

mod breadth_first;
mod dijkstra;
mod error;
mod exact;
mod fast_marching;
mod graph;
mod heap;
mod heat;
mod method;
mod path;
mod prefetch;
mod samplers;
mod sampling;
mod solver;
mod source;
#[cfg(test)]
mod testing;

pub use breadth_first::BreadthFirst;
pub use dijkstra::Dijkstra;
pub use error::GeodesicError;
pub use exact::Exact;
pub use fast_marching::{FastMarching, FastMarchingOptions, ObtuseTreatment, Update};
pub use heat::{HeatMethod, HeatOptions};
pub use method::Method;
pub use path::{GeodesicPath, PathTracer};
pub use samplers::{RandomSampler, Sampler, Sampling, Variance, VarianceSampler};
pub use sampling::{FarthestPointSampler, FirstSample, farthest_point_sampling};
pub use solver::{DistanceSolver, PrunedSolver};
pub use source::{Source, SurfacePoint};
