//! Whatever can go wrong on the way from a file to a score.

use std::path::PathBuf;

use mesh::VertexId;

/// Errors of this crate and of every stage beneath it.
#[derive(Debug, thiserror::Error)]
pub enum PipelineError {
    /// Reading, writing, validation or repair.
    #[error(transparent)]
    Mesh(#[from] mesh::MeshError),
    /// Distances on the surface.
    #[error(transparent)]
    Geodesic(#[from] geodesics::GeodesicError),
    /// Matrices.
    #[error(transparent)]
    Linalg(#[from] linalg::LinalgError),
    /// The embedding.
    #[error(transparent)]
    Nmds(#[from] nmds::NmdsError),
    /// The form and its alignment.
    #[error(transparent)]
    Descriptor(#[from] descriptors::DescriptorError),
    /// The scores.
    #[error(transparent)]
    Retrieval(#[from] retrieval::RetrievalError),
    /// A vertex of the input that is not there.
    #[error("vertex {vertex} does not exist; the mesh has {n_vertices} vertices, counted from 0")]
    NoSuchVertex {
        /// The vertex asked for.
        vertex: VertexId,
        /// Vertices of the input.
        n_vertices: usize,
    },
    /// A vertex of the input that the repair left out.
    #[error(
        "vertex {vertex} was left out by the repair (unreferenced, or not in the largest component); \
         choose another one, or pass --components bridge"
    )]
    DroppedVertex {
        /// The vertex asked for.
        vertex: VertexId,
    },
    /// All pairs of distances would not fit.
    #[error(
        "all distances between {n_vertices} vertices need {needed_mib} MiB, more than the {limit_mib} MiB \
         allowed; use --method nmds, which needs a few columns only"
    )]
    AllPairsTooLarge {
        /// Vertices of the surface.
        n_vertices: usize,
        /// Memory for the matrix.
        needed_mib: usize,
        /// The limit.
        limit_mib: usize,
    },
    /// A folder that cannot be listed, or a label file that cannot be read.
    #[error("cannot read {path}: {source}", path = path.display())]
    Io {
        /// The folder or file.
        path: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// A folder without meshes.
    #[error(
        "{path}: no mesh found in this folder or its sub-folders; \
         meshes end in .off .obj .ply .stl .vert or .mat",
        path = path.display()
    )]
    NoShapes {
        /// The folder.
        path: PathBuf,
    },
    /// A line of a label file.
    #[error("{path}, line {line}: expected `name,label`, found `{found}`", path = path.display())]
    BadLabelLine {
        /// The file.
        path: PathBuf,
        /// The line, counted from one.
        line: usize,
        /// What is there.
        found: String,
    },
    /// A shape without a line in the label file.
    #[error("{path}: no label for `{name}`; add a line `{name},LABEL`", path = path.display())]
    NoLabel {
        /// The label file.
        path: PathBuf,
        /// The shape's name.
        name: String,
    },
}
