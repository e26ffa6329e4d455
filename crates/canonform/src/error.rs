//! Whatever can go wrong on the way from a file to a score.

use std::path::PathBuf;

use surface::{FaceId, VertexId};

use crate::InputPoint;

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
    /// The index.
    #[error(transparent)]
    Index(#[from] index::IndexError),
    /// The text of an index.
    #[error(transparent)]
    Export(#[from] index::ExportError),
    /// An index whose options this program cannot read.
    #[error(
        "{path} describes its shapes in a way that this program does not know ({options}); build it again",
        path = path.display()
    )]
    UnknownOptions {
        /// The index.
        path: PathBuf,
        /// What it says.
        options: String,
    },
    /// A shape that would take the place of another.
    #[error(
        "`{id}` is in the index already, from {path}; remove it first, rename the new one, or pass --replace",
        path = path.display()
    )]
    AlreadyThere {
        /// The name.
        id: String,
        /// Where the known one came from.
        path: PathBuf,
    },
    /// The mesh of an indexed shape is where it was no longer.
    #[error(
        "the mesh of `{id}` cannot be read from {path} ({source}); put it back, start in the folder that the \
         index was built in, or build the index again",
        path = path.display()
    )]
    MeshGone {
        /// Name of the shape.
        id: String,
        /// Where its mesh was.
        path: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// The mesh of an indexed shape is another one now.
    #[error(
        "the mesh of `{id}` in {path} has changed since it was indexed; restore it, or build the index again",
        path = path.display()
    )]
    MeshChanged {
        /// Name of the shape.
        id: String,
        /// Where its mesh was.
        path: PathBuf,
    },
    /// A share of a collection that is none.
    #[error("shard {shard} of {n_shards} does not exist; count shards from 1 to {n_shards}, or from 0")]
    NoSuchShard {
        /// The shard.
        shard: usize,
        /// How many there are.
        n_shards: usize,
    },
    /// Too many shapes for a matrix.
    #[error(
        "distances between all pairs of {n_shapes} shapes are too many; evaluate up to {limit} at once, for example          one shard"
    )]
    TooManyShapes {
        /// Shapes of the index.
        n_shapes: usize,
        /// Largest number.
        limit: usize,
    },
    /// A file of distances that is no matrix.
    #[error("{path}, line {line}: {what}", path = path.display())]
    BadMatrix {
        /// The file.
        path: PathBuf,
        /// The line, counted from one.
        line: usize,
        /// What is wrong and what is expected.
        what: String,
    },
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
    /// A face of the input that is not there.
    #[error("face {face} does not exist; the mesh has {n_faces} faces, counted from 0")]
    NoSuchFace {
        /// The face asked for.
        face: FaceId,
        /// Faces of the input.
        n_faces: usize,
    },
    /// A face of the input that the repair left out.
    #[error(
        "face {face} was left out by the repair (degenerate, or not in the largest component); choose another \
         one, or pass --components bridge"
    )]
    DroppedFace {
        /// The face asked for.
        face: FaceId,
    },
    /// Two vertices of the input without an edge between them.
    #[error("there is no edge between vertices {a} and {b}; take two vertices of one face", a = ends[0], b = ends[1])]
    NoSuchEdge {
        /// The vertices.
        ends: [VertexId; 2],
    },
    /// An edge of the input that the repair left out.
    #[error(
        "the edge between vertices {a} and {b} was left out by the repair (it has no length); \
         take one of its vertices",
        a = ends[0],
        b = ends[1]
    )]
    DroppedEdge {
        /// Its vertices.
        ends: [VertexId; 2],
    },
    /// Text that is no point of a mesh.
    #[error(
        "`{text}` is no point of a mesh; write 17 for a vertex, 17-42@0.3 for a point of an edge (here 0.3 of \
         the way from 17 to 42), or f8@2:1:1 for a point of a face with these weights of its corners"
    )]
    BadPoint {
        /// The text.
        text: String,
    },
    /// A path to where no distance is known.
    #[error(
        "no way is known from a source to {target}: it lies beyond the limit of the distances; choose another \
         target or raise --max-distance"
    )]
    NoWay {
        /// The end of the path.
        target: InputPoint,
    },
    /// An option of a description that is too small.
    #[error("a description needs at least {least} {option}, got {value}")]
    BadDescription {
        /// Name of the option.
        option: &'static str,
        /// The value given.
        value: usize,
        /// The least it can be.
        least: usize,
    },
    /// Too little memory for distances between all pairs.
    #[error(
        "distances between all pairs of {n_vertices} vertices need at least {needed} bytes of memory at once, \
         more than the {limit} allowed; raise --memory"
    )]
    MemoryTooSmall {
        /// Vertices of the input.
        n_vertices: usize,
        /// The least that is needed, in bytes.
        needed: usize,
        /// The limit, in bytes.
        limit: usize,
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
         a mesh is {meshes}",
        path = path.display(),
        meshes = mesh::io::mesh_files()
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
