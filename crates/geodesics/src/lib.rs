//! Geodesic distances, shortest paths and landmark sampling on triangle meshes.
//!
//! `surface::IntrinsicMesh` -> **geodesics** -> `linalg::LandmarkDistances` -> `nmds`
//!
//! * A [`Method`] names a solver; [`Method::prepare`] makes a [`DistanceSolver`] for one surface. The solvers are
//!   [`FastMarching`] (the default), [`Exact`], [`HeatMethod`] and [`Dijkstra`], along edges or in [hops](Dijkstra::of_hops).
//! * A [`Source`] is a vertex, or any [`SurfacePoint`].
//! * A [`PathTracer`] finds shortest paths with exact distances; [`log_map`] unrolls the surface about a point.
//! * A [`Sampling`] names a choice of landmarks; [`Sampling::start`] makes a [`Sampler`].
//! * A solver keeps to the budget of the observer it is prepared with; [`Observed`] tells an observer of every solve.
//!
//! **Invariant.** This crate knows edge lengths only and cannot depend on vertex coordinates, so an isometry of the
//! surface changes no result.
//!
//! ```
//! use canonform_geodesics::{FirstSample, Method, PathTracer, Sampling, Source, SurfacePoint};
//! use mesh::shapes;
//! use surface::VertexId;
//!
//! let surface = shapes::torus(40, 16, 2.0, 0.7).intrinsic();
//! let solver = Method::default().prepare(&surface, &())?;
//!
//! // Distances from one vertex to all, and the shortest path to one of them.
//! let distances = solver.distances(VertexId(0))?;
//! let sources = [Source::vertex(VertexId(0))];
//! let exact = Method::Exact.prepare(&surface, &())?.distances(VertexId(0))?;
//! let path = PathTracer::new(&surface, &sources, &exact, &()).path_to(SurfacePoint::Vertex(VertexId(330)))?;
//! assert!((path.length / distances[330] - 1.0).abs() < 0.05);
//!
//! // Ten landmarks spread over the surface, with their distances to all vertices.
//! let mut sampler = Sampling::Farthest.start(solver.as_ref(), FirstSample::Farthest, 0)?;
//! sampler.extend_to(10)?;
//! assert_eq!(sampler.distances(10)?.n_landmarks(), 10);
//! # Ok::<(), canonform_geodesics::GeodesicError>(())
//! ```

mod dijkstra;
mod error;
mod exact;
mod fast_marching;
mod flat;
mod heat;
mod method;
mod observed;
mod order;
mod path;
mod plane;
mod prefetch;
mod sampling;
mod sight;
mod solver;
mod source;
#[cfg(test)]
mod tests;

pub use dijkstra::Dijkstra;
pub use error::GeodesicError;
pub use exact::{Exact, log_map};
pub use fast_marching::{FastMarching, FastMarchingOptions, ObtuseTreatment, Update};
pub use heat::{HeatMethod, HeatOptions};
pub use method::Method;
pub use observed::Observed;
pub use path::{GeodesicPath, PathTracer};
pub use sampling::{FirstSample, Sampler, Sampling, SpreadSamples};
pub use solver::DistanceSolver;
pub use source::Source;
pub use surface::SurfacePoint;
