//! The facade: which stage follows which, and with what options.
//!
//! file -> [`Surface`] -> [`embed`] -> `descriptors::CanonicalForm` -> [`form_distances`] -> scores
//!
//! file -> [`Surface`] -> [`describe`] -> [`ShapeDescription`] -> an index
//!
//! Everything a program needs to go from a mesh or a folder of meshes to forms, distances and scores.
//! Knows nothing of terminals or plots; long work reports its progress to a callback.

mod all_pairs;
mod compare;
mod dataset;
mod describe;
mod distance;
mod embed;
mod error;
mod forms;
mod handedness;
mod indexing;
mod methods;
mod observer;
mod options;
mod paths;
mod points;
mod report;
mod rerank;
mod run;
mod stress;
mod surface;

pub use all_pairs::{AllPairs, Asymmetry};
pub use compare::{
    Comparison, MatchKind, Overlay, SurfaceComparison, Triangulation, compare_forms, compare_surfaces,
    overlay_forms,
};
pub use dataset::{LabelFile, ShapeFile, label_of, list_shapes};
pub use describe::{
    DESCRIPTION_VERSION, DescribeOptions, ShapeDescription, SurfaceForm, describe, describe_surface,
    describe_with_form, prepare_form,
};
pub use distance::{SAME_BELOW, ShapeDistance};
pub use embed::{Embedded, embed};
pub use error::PipelineError;
pub use forms::{
    FormMatches, MATCHED_POINTS, PreparedForms, embedded_distances, form_distances, form_matches, map_of,
};
pub use handedness::Handedness;
pub use indexing::{
    BuildOptions, BuildReport, Explain, Failure, Inputs, Measure, MergeReport, Prediction, SearchOptions,
    SearchReport, SearchResult, SearchSeconds, ShapeSearch, Shard, add_to_index, build_index, evaluate_index,
    evaluate_matrix, merge_indexes, remove_from_index,
};
pub use methods::{MethodFacts, MethodReport, MethodsReport, compare_methods};
pub use observer::Observer;
pub use options::{EmbedMethod, EmbedOptions, Samples, StressChoice};
pub use paths::{PathPoint, SurfacePath};
pub use points::InputPoint;
pub use report::{DescentReport, EmbedReport, SecondsReport};
pub use rerank::{FORM_UNIT, FORM_WEIGHT, combined_distance, rerank};
pub use stress::{StressKind, StressReport};
pub use surface::Surface;

pub use descriptors::{
    CanonicalForm, DescriptorError, FormDistance, MatchOptions, Normalization, PreparedForm, Reflections,
    Signature, SignatureKind,
};
pub use geodesics::{
    DistanceSolver, FastMarchingOptions, FirstSample, HeatOptions, Method as GeodesicMethod, ObtuseTreatment,
    PathTracer, Sampling, Source, SurfacePoint, Update, Variance,
};
pub use index::{ContentHash, IndexError, SearchMode, ShapeEntry};
pub use nmds::{Bandwidth, Regularization, RpiAlpha, SmacofOptions};
pub use retrieval::Evaluation;
