//! What can be wrong with a mesh or its file.

use std::fmt;
use std::path::PathBuf;

use surface::{Topology, VertexId};

/// Fewest different points that can become a surface.
pub const MIN_POINTS: usize = 12;

/// Why a mesh could not be read, written or repaired. The message names the file, the place, the fault and a remedy.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// The operating system could not open, read or write a file.
    #[error(transparent)]
    Io(#[from] base::files::FileError),

    /// The file was opened but does not hold a usable mesh.
    #[error("{path}{place}: {fault}")]
    File {
        /// The file; for a `.vert`/`.tri` pair the one at fault.
        path: PathBuf,
        /// Where in the file.
        place: Place,
        /// What is wrong.
        fault: Fault,
    },

    /// The file name has an unknown extension or none.
    #[error("{path}: {}; use {supported}", unknown_extension(extension))]
    UnknownFormat {
        /// The file.
        path: PathBuf,
        /// Its extension in lower case; empty if it has none.
        extension: String,
        /// The extensions of all formats, as a phrase.
        supported: String,
    },

    /// More files than one mesh has.
    #[error(
        "{extra} does not belong to {path}; provide the files of one mesh: {supported}",
        extra = extra.display(),
        path = path.display()
    )]
    StrayFile {
        /// The mesh.
        path: PathBuf,
        /// The other file.
        extra: PathBuf,
        /// What one mesh consists of, as a phrase.
        supported: String,
    },

    /// A face refers to a vertex that does not exist.
    #[error(
        "face {face} refers to vertex {vertex}, but the mesh has {n_vertices} vertices; correct or remove the face"
    )]
    VertexOutOfRange {
        /// The face.
        face: usize,
        /// The vertex.
        vertex: VertexId,
        /// Vertices of the mesh.
        n_vertices: usize,
    },

    /// A coordinate of this vertex is NaN or infinite.
    #[error("vertex {0} has a coordinate that is not finite; correct it or remove the vertex")]
    NonFinite(usize),

    /// A mesh so large or small that areas overflow or vanish.
    #[error(
        "the mesh is {size:e} units across, but sizes from {least:e} to {most:e} are supported, since areas beyond \
         overflow or vanish; scale the mesh"
    )]
    UnsupportedSize {
        /// Its size.
        size: f64,
        /// The smallest supported one.
        least: f64,
        /// The largest supported one.
        most: f64,
    },

    /// A mesh without a usable face.
    #[error(
        "none of the {n_faces} faces is usable ({degenerate} degenerate); \
         a surface needs at least one triangle with three distinct corners"
    )]
    NoUsableFace {
        /// Its faces.
        n_faces: usize,
        /// Faces without area.
        degenerate: usize,
    },

    /// Too few points at different places for a surface through them.
    #[error("{0} different points without faces; a surface needs faces, or at least {MIN_POINTS} points")]
    TooFewPoints(usize),

    /// Points that lie on no surface, this many.
    #[error("no two of the {0} points agree on a triangle; they do not lie on a surface, or are too sparse")]
    NoSurface(usize),

    /// A format that is not written, or not with this content.
    #[error("{path}: {format} files cannot be written with {content}; use {supported}", path = path.display())]
    NotWritable {
        /// The file.
        path: PathBuf,
        /// Its format.
        format: &'static str,
        /// What should be written.
        content: &'static str,
        /// The extensions that can be, as a phrase.
        supported: String,
    },

    /// A field of another number of vertices.
    #[error(
        "{n_values} values for {n_vertices} vertices; provide exactly one value and one color per vertex"
    )]
    FieldLength {
        /// Values of the field.
        n_values: usize,
        /// Vertices of the mesh.
        n_vertices: usize,
    },

    /// A field that a PLY file cannot name so.
    #[error(
        "`{0}` is not a valid name of a PLY property; use letters, digits and `_`, begin with a letter, \
         and avoid x y z red green blue"
    )]
    FieldName(String),

    /// A coordinate that a format of single precision cannot hold.
    #[error(
        "vertex {vertex} has the coordinate {value:e}, beyond the 32-bit floats of {format}; scale the mesh down or use \
         another format"
    )]
    BeyondSinglePrecision {
        /// The vertex.
        vertex: usize,
        /// The coordinate.
        value: f64,
        /// The format.
        format: &'static str,
    },

    /// A face that a format of single precision would collapse.
    #[error(
        "corners of face {face} coincide in the 32-bit floats of {format}; move the mesh to the origin or use another format"
    )]
    CollapsedFace {
        /// The face.
        face: usize,
        /// The format.
        format: &'static str,
    },

    /// More vertices or faces than a mesh may have.
    #[error(
        "the mesh has {n_vertices} vertices and {n_faces} faces, but at most {} and {} are supported; simplify it",
        Topology::MAX_VERTICES,
        Topology::MAX_FACES
    )]
    TooLarge {
        /// Its vertices.
        n_vertices: usize,
        /// Its faces.
        n_faces: usize,
    },

    /// A limit on time or memory, or a cancellation.
    #[error(transparent)]
    Exceeded(#[from] base::Exceeded),

    /// The mesh has several components and the policy is [`ComponentPolicy::Error`](crate::ComponentPolicy::Error).
    #[error(
        "the mesh is disconnected: {unreached} of {n_vertices} vertices lie outside the largest component"
    )]
    Disconnected {
        /// Vertices outside the largest component.
        unreached: usize,
        /// Vertices of the mesh that a face uses.
        n_vertices: usize,
    },
}

fn unknown_extension(extension: &str) -> String {
    match extension {
        "" => "the file name has no extension".into(),
        "las" | "laz" => {
            format!(
                "unknown mesh format `.{extension}`, which `pdal translate in.{extension} out.ply` converts"
            )
        }
        _ => format!("unknown mesh format `.{extension}`"),
    }
}

/// Where in a file a fault is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// In the file as a whole, or at an unknown place.
    File,
    /// In this line, counted from one.
    Line(usize),
    /// At this byte, counted from zero.
    Byte(u64),
    /// In a numbered part of the file, such as an accessor.
    Part(&'static str, usize),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File => Ok(()),
            Self::Line(line) => write!(f, ", line {line}"),
            Self::Byte(byte) => write!(f, ", byte {byte}"),
            Self::Part(kind, number) => write!(f, ", {kind} {number}"),
        }
    }
}

/// What is wrong with a mesh file, and the remedy.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Fault {
    /// The file has no content.
    #[error("the file is empty")]
    Empty,

    /// More vertices, faces or bytes than the reader was told to accept.
    #[error("the mesh exceeds the limit of {limit} {items}; simplify it or raise the limit")]
    OverLimit {
        /// What is counted, such as `vertices`.
        items: &'static str,
        /// The limit.
        limit: u64,
    },

    /// Any other fault, which only its message tells.
    #[error("{0}")]
    Malformed(String),
}

impl Fault {
    /// Text or data that the format does not allow here.
    pub fn syntax(expected: &str, found: impl fmt::Display) -> Self {
        Self::Malformed(format!("expected {expected}, found `{found}`; correct the file or export it again"))
    }

    /// A feature of the format that the reader does not support.
    pub fn unsupported(what: impl fmt::Display, remedy: &str) -> Self {
        Self::Malformed(format!("{what}; {remedy}"))
    }

    /// Content of another format than the file name promises, and the evidence.
    pub fn wrong_format(expected: &str, found: impl fmt::Display) -> Self {
        Self::Malformed(format!(
            "this is not {expected} ({found}); correct the file name or export the mesh again"
        ))
    }

    /// A file that ends early.
    pub fn cut_short(expected: &str) -> Self {
        Self::Malformed(format!("unexpected end of file: expected {expected}; the file may be truncated"))
    }

    /// Less in the file than its header promises.
    pub fn truncated(items: impl fmt::Display, promised: u64, found: u64) -> Self {
        Self::Malformed(format!(
            "the header promises {promised} {items} but the file holds only {found}; \
             it is truncated or its header is wrong"
        ))
    }

    /// More in the file than its header promises.
    pub fn leftover(items: &str, promised: u64) -> Self {
        Self::Malformed(format!(
            "the file continues after the {promised} {items} that its header promises; correct the header"
        ))
    }

    /// A face that refers to none of the vertices, which are counted from `first`.
    pub fn no_vertex(index: impl fmt::Display, first: u64, n_vertices: u64) -> Self {
        let last = first.saturating_add(n_vertices).saturating_sub(1);
        Self::Malformed(format!(
            "a face refers to vertex {index}, but the vertices of the file run from {first} to {last}; \
             correct or remove the face"
        ))
    }

    /// A face with fewer than three corners.
    pub fn too_few_corners(corners: usize) -> Self {
        Self::Malformed(format!("a face has {corners} corners but needs at least three; remove it"))
    }

    /// A file without faces, and with too few vertices for a point cloud.
    pub fn no_faces(n_vertices: u64) -> Self {
        Self::Malformed(format!(
            "the file has {n_vertices} vertices but no faces; a surface needs faces, or at least {MIN_POINTS} points"
        ))
    }

    /// Compressed data that grows out of proportion, beyond this many bytes.
    pub fn decompression_bomb(limit: u64) -> Self {
        Self::Malformed(format!(
            "the compressed data grows beyond {limit} bytes, out of proportion to the file; \
             the file is damaged or malicious: if it is neither, save it without compression"
        ))
    }
}
