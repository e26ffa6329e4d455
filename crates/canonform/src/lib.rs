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
//! 1. [`mesh::TriMesh`]: vertices and faces, read by [`read_mesh`] from files of any format in
//!    [`FORMATS`](mesh::io::FORMATS), compressed by gzip or not, and from members of archives (`cats.zip/cat0.off`).
//! 2. [`Surface`]: the repaired mesh, with its connectivity and edge lengths. Defects that would break distance
//!    computation are repaired and reported; vertices keep their order. [`InputPoint`] and [`SurfacePath`] name points
//!    and shortest paths in the numbers of the input.
//! 3. Distances along the surface, by any [`geodesics::Method`], from samples or between [`AllPairs`] of vertices. A
//!    [`DistanceField`] holds all pairs in little memory, with bounds.
//! 4. [`Embedded`]: coordinates by any [`EmbedMethod`], made by [`embed`] as [`FormOptions`] say. The options travel with
//!    everything that is made from here on. [`EmbedOptions::stress`] adds the stress.
//! 5. [`descriptors::CanonicalForm`]: the embedded surface, weighted by area, in three dimensions.
//! 6. [`Shape`]: form, signatures and facts, made by [`describe`]: all that an index stores of a shape.
//! 7. [`descriptors::ShapePair`]: two descriptions and the alignments of their forms, each found once. All units, weights
//!    and thresholds of its distance belong to [`descriptors::ShapeMetric`].
//! 8. [`Relation`]: how the two are related, by that distance and, where they are at hand, by files and meshes.
//!    [`compare_meshes`] goes all the way from two meshes; [`compare`] gives the numbers of two descriptions.
//!
//! # Collections
//!
//! [`list_shapes`] finds the labelled meshes of a folder, an archive or a list of paths. [`build_index`] describes them into a durable file;
//! [`add_to_index`], [`remove_from_index`] and [`merge_indexes`] change it; [`ShapeSearch`] finds the shapes nearest to a
//! mesh; [`evaluate_index`] scores how well an index separates classes, [`evaluate_matrix`] does the same for any matrix of
//! distances. [`form_alignments`] aligns all pairs of forms without an index.
//!
//! # Distances and samples
//!
//! The building blocks are crates of their own, re-exported here as modules: one dependency is enough.
//!
//! ```
//! use canonform::geodesics::{FirstSample, Method, Sampling};
//! use canonform::nmds::{NystromOptions, nystrom};
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
//! let embedding = nystrom(&samples, &NystromOptions::default())?;
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

mod compare;
mod correspond;
mod error;
mod form;
mod input;
mod shape_index;

pub use ::mesh::{BadPoint, InputMap, InputPoint, PointError, Surface};
pub use base::{Budget, ContentHash, Exceeded, Observer, one_line};
pub use collection::{
    Dataset, LabelFile, LabelOrigin, LabelSource, ShapeFile, SkipKind, Skipped, Storage, UnusedLabel,
    content_hash, is_archive_name, is_dataset, label_of, list_shapes, read_mesh, read_mesh_file, single_mesh,
};
pub use compare::{
    Compared, ComparedMesh, Comparison, FaceAgreement, FormAlignments, MeshComparison, Overlay, Residual,
    compare, compare_meshes, embedded_distances, form_alignments,
};
pub use correspond::{
    CorrespondOptions, Correspondence, FacePoint, MappedSurface, Mapping, PointMap, VertexMap, correspond,
};
pub use descriptors::Side;
pub use error::{Error, Remedy};
pub use fields::{
    DistanceField, FieldBounds, FieldFacts, FieldFault, FieldOptions, Finish, PairDistance, PairKind,
};
pub use form::{
    DISTANCES_LIMIT, DescribeOptions, EmbedInput, EmbedMethod, EmbedOptions, EmbedReport, Embedded,
    FormOptions, MeasuredSurface, Samples, SecondsReport, SharedStress, StressChoice, StressKind,
    StressOptions, StressReport, describe, describe_part, embed, settings, signature,
};
pub use index::Shape;
pub use input::{AllPairs, Asymmetry, PathPoint, SurfacePath, distance_rows, read_surface};
pub use maps::{KnownMap, MapKind, MapParams, PartOfWhole};
pub use relations::{
    Basis, Change, Evidence, MeshGeometry, MeshOverlay, Parts, Relation, RelationKind, UnitChange,
};
pub use retrieval::RankBy;
pub use rigid::Handedness;
pub use shape_index::{
    Aligned, Answer, BuildOptions, BuildReport, ClassVotes, ComponentResult, Dropped, DuplicateFile,
    DuplicateGroup, DuplicateMember, DuplicateOptions, DuplicateReport, EvaluateOptions, Failure,
    FailureReason, Hit, Inputs, Measure, MergeReport, MoveReport, NearestShape, NotMoved, OrderedBy,
    PairwiseDistance, Prediction, Query, SearchOptions, SearchRank, SearchSeconds, ShapeLimits, ShapeSearch,
    Shard, Unknown, add_to_index, bounds, build_index, check_place, evaluate_index, evaluate_matrix,
    export_index, find_duplicates, indexed_shapes, merge_answers, merge_indexes, mesh_path, move_duplicates,
    n_candidates, n_results, remove_from_index, rerank, unchanged_index, undo_moves,
};
pub use {
    collection, descriptors, fields, geodesics, index, linalg, maps, mesh, nmds, relations, retrieval, rigid,
    surface,
};
