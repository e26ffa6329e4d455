//! What can be wrong with a mesh or its file.

use std::fmt::{self, Display};
use std::path::PathBuf;

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
    #[error("{0}")]
    UnknownFormat(String),

    /// More files than one mesh has.
    #[error("{0}")]
    StrayFile(String),

    /// A mesh that cannot be repaired, or one or its field that a format cannot hold.
    #[error("{0}")]
    Invalid(String),

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

impl Display for Place {
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

    /// Content that the format does not allow, that is missing, or that makes no mesh.
    #[error("{0}")]
    Broken(String),

    /// A feature of the format that the reader does not support.
    #[error("{what}; {remedy}")]
    Unsupported {
        /// The feature.
        what: String,
        /// How to avoid it.
        remedy: &'static str,
    },

    /// More vertices, faces or bytes than the reader was told to accept.
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
    pub fn syntax(expected: impl Display, found: impl Display) -> Self {
        Self::Broken(format!("expected {expected}, found `{found}`; correct the file or export it again"))
    }

    /// A feature of the format that the reader does not support.
    pub fn unsupported(what: impl Into<String>, remedy: &'static str) -> Self {
        Self::Unsupported { what: what.into(), remedy }
    }

    /// Content of another format than the file name promises.
    pub fn wrong_format(expected: impl Display, found: impl Display) -> Self {
        Self::Broken(format!(
            "this is not {expected} ({found}); correct the file name or export the mesh again"
        ))
    }

    /// A file that ends early.
    pub fn cut_short(expected: impl Display) -> Self {
        Self::Broken(format!("unexpected end of file: expected {expected}; the file may be truncated"))
    }

    /// Less in the file than its header promises.
    pub fn truncated(items: impl Display, promised: u64, found: u64) -> Self {
        Self::Broken(format!(
            "the header promises {promised} {items} but the file holds only {found}; it is truncated or its header is wrong"
        ))
    }

    /// More in the file than its header promises.
    pub fn leftover(items: impl Display, promised: u64) -> Self {
        Self::Broken(format!(
            "the file continues after the {promised} {items} that its header promises; correct the header"
        ))
    }

    /// A face that refers to none of the vertices, which are counted from `first`.
    pub fn no_vertex(index: impl Display, first: u64, n_vertices: u64) -> Self {
        let last = first.saturating_add(n_vertices).saturating_sub(1);
        Self::Broken(format!(
            "a face refers to vertex {index}, but the vertices of the file run from {first} to {last}; \
             correct or remove the face"
        ))
    }

    /// A file without faces, and with too few vertices for a point cloud.
    pub fn no_faces(n_vertices: usize) -> Self {
        Self::Broken(format!(
            "the file has {n_vertices} vertices but no faces; a surface needs faces, or at least {MIN_POINTS} points"
        ))
    }

    /// A face with fewer than three corners.
    pub fn few_corners(corners: usize) -> Self {
        Self::Broken(format!("a face has {corners} corners but needs at least three; remove it"))
    }
}
