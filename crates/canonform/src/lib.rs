//! The facade.

mod compare;
mod error;
mod form;
mod input;
mod observer;
mod shape_index;

pub use compare::{
    Comparison, FormMatches, Overlay, PreparedForms, SurfaceComparison, Triangulation, compare,
    compare_surfaces, embedded_distances, form_distances, form_matches, map_of,
};
pub use error::{Error, Remedy};
pub use form::{
    DISTANCES_LIMIT, DescentReport, DescribeOptions, EmbedMethod, EmbedReport, Embedded, FormOptions,
    MethodFacts, MethodReport, MethodsReport, Samples, SecondsReport, ShapeDescription, StressChoice,
    StressKind, StressOptions, StressReport, compare_methods, describe, embed, embed_and_measure,
};
pub use input::{
    AllPairs, Asymmetry, BadPoint, InputPoint, LabelFile, PathPoint, ShapeFile, Surface, SurfacePath,
    label_of, list_shapes,
};
pub use observer::Observer;
pub use shape_index::{
    BuildOptions, BuildReport, Explain, Failure, Inputs, Measure, MergeReport, Prediction, Ranked, Reranked,
    SearchOptions, SearchReport, SearchResult, SearchSeconds, ShapeSearch, Shard, add_to_index, build_index,
    evaluate_index, evaluate_matrix, merge_indexes, remove_from_index, rerank,
};

pub use {descriptors, geodesics, index, linalg, mesh, nmds, retrieval, surface};
