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

    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} has a coordinate that is not finite; correct it or remove the vertex")]
    NonFinite {
        /// The vertex.
        vertex: usize,
    },

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

    /// Too few points for a surface through them.
    #[error(
        "{n_distinct} different points without faces; a surface needs faces, or at least {least} points",
        least = MIN_POINTS
    )]
    TooFewPoints {
        /// Points at different places.
        n_distinct: usize,
    },

    /// Points that lie on no surface.
    #[error(
        "no two of the {n_points} points agree on a triangle; they do not lie on a surface, or are too sparse"
    )]
    NoSurface {
        /// The points.
        n_points: usize,
    },

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

    /// A field that a PLY file cannot name.
    #[error(
        "`{name}` is not a valid name of a PLY property; use letters, digits and `_`, begin with a letter, \
         and avoid x y z red green blue"
    )]
    FieldName {
        /// The name.
        name: String,
    },

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

    /// The content is of another format.
    #[error("this is not {expected} ({found}); correct the file name or export the mesh again")]
    WrongFormat {
        /// The format that the file name promises.
        expected: &'static str,
        /// The evidence.
        found: String,
    },

    /// A feature of the format that the reader does not support.
    #[error("{what}; {remedy}")]
    Unsupported {
        /// The feature.
        what: String,
        /// How to avoid it.
        remedy: &'static str,
    },

    /// Less in the file than its header promises.
    #[error(
        "the header promises {promised} {items} but the file holds only {found}; \
         it is truncated or its header is wrong"
    )]
    Truncated {
        /// What is counted, such as `vertices`.
        items: String,
        /// Number in the header.
        promised: u64,
        /// Number in the file, or an upper bound of it.
        found: u64,
    },

    /// The file ends early.
    #[error("unexpected end of file: expected {expected}; the file may be truncated")]
    CutShort {
        /// What should follow.
        expected: String,
    },

    /// More in the file than its header promises.
    #[error("the file continues after the {promised} {items} that its header promises; correct the header")]
    Leftover {
        /// What is counted, such as `vertices`.
        items: &'static str,
        /// Number in the header.
        promised: u64,
    },

    /// Text or data that the format does not allow here.
    #[error("expected {expected}, found `{found}`; correct the file or export it again")]
    Syntax {
        /// What the format requires.
        expected: &'static str,
        /// What the file has.
        found: String,
    },

    /// A coordinate that is NaN, infinite or too large for its type.
    #[error("vertex {vertex} has the coordinate {value}; correct the coordinate or remove the vertex")]
    NonFinite {
        /// The vertex, counted as the format counts.
        vertex: u64,
        /// The coordinate.
        value: f64,
    },

    /// A face refers to a vertex that does not exist.
    #[error(
        "a face refers to vertex {index}, but the vertices of the file run from {first} to {last}; \
         correct or remove the face"
    )]
    IndexOutOfRange {
        /// The index as written.
        index: String,
        /// Index of the first vertex: 0 or 1.
        first: u64,
        /// Index of the last vertex.
        last: u64,
    },

    /// A face with fewer than three corners.
    #[error("a face has {corners} corners but needs at least three; remove it")]
    TooFewCorners {
        /// Number of corners.
        corners: usize,
    },

    /// A file without faces, and with too few vertices for a point cloud.
    #[error(
        "the file has {n_vertices} vertices but no faces; a surface needs faces, or at least {least} points",
        least = MIN_POINTS
    )]
    NoFaces {
        /// Number of vertices.
        n_vertices: usize,
    },

    /// More vertices or faces than 32-bit indices can count.
    #[error("too many {items}: {count} (maximum {limit}); simplify the mesh")]
    TooLarge {
        /// What is counted, such as `vertices`.
        items: &'static str,
        /// Number in the file.
        count: u64,
        /// Largest supported number.
        limit: u64,
    },

    /// More vertices or faces than the reader was told to accept.
    #[error("the mesh exceeds the limit of {limit} {items}; simplify it or raise the limit")]
    OverLimit {
        /// What is counted, such as `vertices`.
        items: &'static str,
        /// The limit.
        limit: u64,
    },

    /// Compressed data that grows out of proportion.
    #[error(
        "the compressed data grows beyond {limit} bytes, out of proportion to the file; \
         the file is damaged or malicious: if it is neither, save it without compression"
    )]
    DecompressionBomb {
        /// Largest decompressed size, in bytes.
        limit: u64,
    },
}

impl Fault {
    /// Text or data that the format does not allow here.
    pub fn syntax(expected: &'static str, found: impl Into<String>) -> Self {
        Self::Syntax { expected, found: found.into() }
    }

    /// A feature of the format that the reader does not support.
    pub fn unsupported(what: impl Into<String>, remedy: &'static str) -> Self {
        Self::Unsupported { what: what.into(), remedy }
    }

    /// Content of another format.
    pub fn wrong_format(expected: &'static str, found: impl Into<String>) -> Self {
        Self::WrongFormat { expected, found: found.into() }
    }

    /// A file that ends early.
    pub fn cut_short(expected: impl Into<String>) -> Self {
        Self::CutShort { expected: expected.into() }
    }

    /// Less in the file than its header promises.
    pub fn truncated(items: impl Into<String>, promised: u64, found: u64) -> Self {
        Self::Truncated { items: items.into(), promised, found }
    }

    /// A face that refers to none of the vertices, which are counted from `first`.
    pub fn no_vertex(index: String, first: u64, n_vertices: u64) -> Self {
        Self::IndexOutOfRange { index, first, last: first.saturating_add(n_vertices).saturating_sub(1) }
    }
}
