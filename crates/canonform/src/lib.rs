//! Nonrigid 3D shapes: surface distances, canonical forms, comparison and retrieval.
//!
//! A cat that sits and a cat that leaps are one shape: bending changes positions, but not distances along the surface.
//! This crate embeds a surface so that straight-line distances equal its surface distances. The result, its *canonical
//! form*, does not depend on the pose, and rigid alignment compares it with other forms.
//!
//! ```
//! use canonform::descriptors::ShapePair;
//! use canonform::{DescribeOptions, Surface, describe, mesh::shapes};
//!
//! // A flat sheet and the same sheet, folded.
//! let flat = shapes::grid(21, 17, 0.1);
//! let folded = shapes::fold(&flat, 0.8, 1.2);
//!
//! let options = DescribeOptions::default();
//! let mut shapes = Vec::new();
//! for mesh in [&flat, &folded] {
//!     let surface = Surface::new(mesh, &options.form.repair, &())?;
//!     shapes.push(options.prepare(&describe(&surface, &options, &())?)?);
//! }
//! let distance = ShapePair::new([&shapes[0], &shapes[1]]).distance();
//! assert!(distance.is_same_shape());
//! # Ok::<(), canonform::Error>(())
//! ```
//!
//! # From a file to a relation
//!
//! Data flows one way. Each step is a noun, made from the one before it:
//!
//! 1. [`mesh::TriMesh`]: vertices and faces, read by [`read_mesh`](collection::read_mesh) from files of any format in
//!    [`FORMATS`](mesh::io::FORMATS), compressed by gzip or not, and from members of archives (`cats.zip/cat0.off`).
//! 2. [`Surface`]: the repaired mesh, with its connectivity and edge lengths. Defects that would break distance
//!    computation are repaired and reported; vertices keep their order. [`InputPoint`](mesh::InputPoint) and [`SurfacePath`](geodesics::SurfacePath) name points
//!    and shortest paths in the numbers of the input.
//! 3. Distances along the surface, by any [`geodesics::Method`], from samples or between [`AllPairs`](geodesics::AllPairs) of vertices. A
//!    [`DistanceField`](fields::DistanceField) holds all pairs in little memory, with bounds.
//! 4. [`Embedded`](embed::Embedded): coordinates by any [`EmbedMethod`](embed::EmbedMethod), made by [`embed`](embed::embed) as [`FormOptions`](embed::FormOptions) say. The options travel with
//!    everything that is made from here on. [`EmbedOptions::stress`](embed::EmbedOptions::stress) adds the stress.
//! 5. [`descriptors::CanonicalForm`]: the embedded surface, weighted by area, in three dimensions.
//! 6. [`Shape`]: form, signatures and facts, made by [`describe`]: all that an index stores of a shape.
//! 7. [`descriptors::ShapePair`]: two descriptions and the alignments of their forms, each found once. All units, weights
//!    and thresholds of its distance belong to [`descriptors::ShapeMetric`].
//! 8. [`Relation`](relations::Relation): how the two are related, by that distance and, where they are at hand, by files and meshes.
//!    [`compare_meshes`](compare::compare_meshes) goes all the way from two meshes; [`compare`](compare::compare) gives the numbers of two descriptions.
//!
//! # Collections
//!
//! [`list_shapes`](collection::list_shapes) finds the labelled meshes of a folder, an archive or a list of paths. [`build_index`](library::build_index) describes them into a durable file;
//! [`add_to_index`](library::add_to_index), [`remove_from_index`](library::remove_from_index) and [`merge_indexes`](library::merge_indexes) change it; [`ShapeSearch`](search::ShapeSearch) finds the shapes nearest to a
//! mesh; [`evaluate_index`](library::evaluate_index) scores how well an index separates classes, [`evaluate_matrix`](library::evaluate_matrix) does the same for any matrix of
//! distances. [`form_alignments`](compare::form_alignments) aligns all pairs of forms without an index.
//!
//! # Distances and samples
//!
//! The building blocks are crates of their own, re-exported here as modules: one dependency is enough.
//!
//! ```
//! use canonform::geodesics::{FirstSample, Method, Sampling};
//! use canonform::nmds::{Regularization, nystrom};
//! use canonform::surface::VertexId;
//! use canonform::{Surface, mesh::shapes};
//!
//! let surface = Surface::new(&shapes::icosphere(3), &Default::default(), &())?;
//! // Distances from vertex 0 by fast marching, at most half of the circumference of the unit sphere.
//! let solver = Method::default().prepare(surface.intrinsic(), &())?;
//! let distances = solver.distances(VertexId(0))?;
//! let farthest = distances.iter().copied().fold(0.0, f64::max);
//! assert!((3.0..3.15).contains(&farthest));
//!
//! // Twenty samples, each the farthest from those before it, and an embedding from their distances.
//! let mut sampler = Sampling::Farthest.start(solver.as_ref(), FirstSample::default(), 0)?;
//! sampler.extend_to(20)?;
//! let samples = sampler.distances(20)?;
//! let embedding = nystrom(&samples, Regularization::default(), 3)?;
//! assert_eq!((samples.n_landmarks(), embedding.dim()), (20, 3));
//! # Ok::<(), canonform::Error>(())
//! ```
//!
//! # Conventions
//!
//! * The same input, options and seed give the same bits for any number of threads.
//! * Long work reports its progress to an [`Observer`]; `&()` ignores it.
//! * [`Error::remedy`] says what would help, as a [`Remedy`] that a program words in terms of its own interface.
//! * Nothing here knows terminals, plots or HTTP.

mod correspond;
mod error;
mod form;
mod input;
mod shape_index;
mod side_by_side;
mod watched;

pub mod compare;

pub use ::mesh::Surface;
pub use base::{Budget, ContentHash, Exceeded, Observer, one_line};
pub use error::{Error, Remedy};
pub use form::{DescribeOptions, describe, settings};
pub use index::Shape;
pub use input::read_surface;
pub use side_by_side::side_by_side;
pub use watched::{Progress, Watched};
pub use {collection, descriptors, fields, index, linalg, nmds, relations, retrieval, rigid, surface};

/// From distances to coordinates, and what they tell of a shape.
pub mod embed {
    pub use crate::form::{
        DISTANCES_LIMIT, EmbedInput, EmbedMethod, EmbedOptions, EmbedReport, Embedded, FormOptions,
        MeasuredSurface, Samples, SecondsReport, SharedStress, StressChoice, StressKind, StressOptions,
        StressReport, describe_part, embed, signature,
    };
}

/// Distances and shortest paths, also in the numbers of the input.
pub mod geodesics {
    pub use crate::input::{AllPairs, Asymmetry, PathPoint, SurfacePath, distance_rows};
    pub use ::geodesics::*;
}

/// Maps between surfaces.
pub mod maps {
    pub use crate::correspond::{
        CorrespondOptions, Correspondence, FacePoint, MappedSurface, Mapping, PointMap, correspond, score_map,
    };
    pub use ::maps::*;
}

/// Libraries of shapes: building, changing and scoring an index, and its duplicates.
pub mod library {
    pub use crate::shape_index::{
        agreement::*, build::*, change::*, duplicates::*, evaluate::*, export::*, moves::*, place::*,
        source::*,
    };
}

/// Searching an index, and merging the answers of several.
pub mod search {
    pub use crate::shape_index::{
        distances::*, found::*, merge::*, options::*, predict::*, query::*, rerank::*, search::*,
    };
}

/// Triangle meshes and their files.
pub mod mesh {
    pub use ::mesh::*;
    pub use mesh_io as io;
}
