//! What can go wrong with a mesh or its file.

use std::fmt;
use std::path::{Path, PathBuf};

use surface::VertexId;

/// Why a mesh could not be read, written or repaired; the text names the file, the place, the fault
/// and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// The operating system refused.
    #[error(transparent)]
    Io(#[from] files::FileError),

    /// The file was opened but is not a usable mesh.
    #[error("{path}{place}: {fault}")]
    File {
        /// The file; of a `.vert`/`.tri` pair the one at fault.
        path: PathBuf,
        /// Where in it.
        place: Place,
        /// What is wrong.
        fault: Fault,
    },

    /// The name ends in nothing known.
    #[error("{path}: `.{extension}` is not a mesh format; use one of .off .obj .ply .stl .vert .mat")]
    UnknownFormat {
        /// The file.
        path: PathBuf,
        /// How its name ends.
        extension: String,
    },

    /// Files that are no mesh together.
    #[error(
        "{extra} does not belong to {path}; a mesh is one file, or a .vert and a .tri file of one name",
        extra = extra.display(),
        path = path.display()
    )]
    StrayFile {
        /// The mesh.
        path: PathBuf,
        /// The other file.
        extra: PathBuf,
    },

    /// The format can be read only.
    #[error("{path}: .{extension} files are only read; write one of .ply .obj .off .stl .vert instead")]
    ReadOnlyFormat {
        /// The file.
        path: PathBuf,
        /// Its extension.
        extension: &'static str,
    },

    /// The format cannot hold a value per vertex.
    #[error("{path}: a value per vertex needs the PLY format; end the name in .ply")]
    ScalarFieldNotPly {
        /// The file.
        path: PathBuf,
    },

    /// The format cannot hold lines.
    #[error("{path}: lines are written as OBJ or PLY; end the name in .obj or .ply")]
    LinesFormat {
        /// The file.
        path: PathBuf,
    },

    /// A field with more or fewer values than vertices.
    #[error("{values} values for {n_vertices} vertices; give exactly one value per vertex")]
    FieldLength {
        /// Number of values.
        values: usize,
        /// Number of vertices.
        n_vertices: usize,
    },

    /// A field name that PLY cannot carry.
    #[error(
        "`{name}` cannot name a PLY property; use letters, digits and `_`, beginning with a letter, \
             and none of x y z red green blue"
    )]
    FieldName {
        /// The name.
        name: String,
    },

    /// A coordinate that the format's 32-bit floats cannot hold.
    #[error(
        "vertex {vertex} has the coordinate {value:e}, beyond the 32-bit floats of STL; \
             write .ply, .off or .obj, or scale the mesh down"
    )]
    CoordinateOverflow {
        /// The vertex.
        vertex: VertexId,
        /// The coordinate.
        value: f64,
    },

    /// NaN or infinity in a mesh in memory.
    #[error("vertex {vertex} has a coordinate that is not finite; set it to a number or drop the vertex")]
    NonFinitePosition {
        /// The vertex.
        vertex: VertexId,
    },

    /// A face of a mesh in memory names a vertex that does not exist.
    #[error(
        "face {face} names vertex {vertex}, but the mesh has {n_vertices} vertices; \
             correct the face or drop it"
    )]
    FaceOutOfRange {
        /// Index of the face.
        face: usize,
        /// The vertex it names.
        vertex: VertexId,
        /// How many there are.
        n_vertices: usize,
    },

    /// Distances on the mesh would overflow.
    #[error("the mesh is {diagonal:e} across, so large that areas overflow (limit {limit:e}); scale it down")]
    TooWide {
        /// Diagonal of the bounding box, in mesh units.
        diagonal: f64,
        /// The largest diagonal taken.
        limit: f64,
    },

    /// Nothing is left to work on.
    #[error(
        "none of the {n_faces} faces is usable ({degenerate} degenerate); \
             a surface needs at least one triangle with three different corners"
    )]
    NoUsableFace {
        /// Faces in the input.
        n_faces: usize,
        /// Faces that name a vertex twice or have two corners in one place.
        degenerate: usize,
    },

    /// The mesh falls into pieces and [`ComponentPolicy::Error`](crate::ComponentPolicy::Error) was
    /// asked for.
    #[error(
        "mesh is disconnected: {unreached} of {n_vertices} vertices not reached; \
             keep the largest component or pass --components bridge"
    )]
    Disconnected {
        /// Vertices outside the largest component.
        unreached: usize,
        /// Vertices of the mesh, those that no face names left out.
        n_vertices: usize,
    },
}

/// Where in a file a fault is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// In the file as a whole, or at a place the parser does not know.
    File,
    /// In this line, counted from one.
    Line(usize),
    /// At this byte, counted from zero.
    Byte(u64),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File => Ok(()),
            Self::Line(line) => write!(f, ", line {line}"),
            Self::Byte(byte) => write!(f, ", byte {byte}"),
        }
    }
}

/// What is wrong with a mesh file, and the remedy.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Fault {
    /// No content at all.
    #[error("the file is empty; copy or export it again")]
    Empty,

    /// The content is of another format.
    #[error("this is not {expected} ({found}); rename the file after its real format or export it again")]
    WrongFormat {
        /// The format that the name promises.
        expected: &'static str,
        /// What speaks against it.
        found: String,
    },

    /// A part of the format that is not read.
    #[error("{what}; {remedy}")]
    Unsupported {
        /// The part.
        what: String,
        /// How to get around it.
        remedy: &'static str,
    },

    /// Less in the file than its header says.
    #[error(
        "the header promises {promised} {items} but the file holds only {found}; \
             it is cut short or its header is wrong: copy or export it again"
    )]
    Truncated {
        /// Of what.
        items: String,
        /// How many the header promises.
        promised: u64,
        /// How many are there, or at most could be.
        found: u64,
    },

    /// The file ends in the middle of something.
    #[error("the file ends where {expected} should follow; copy or export it again")]
    CutShort {
        /// What should follow.
        expected: String,
    },

    /// More in the file than its header says.
    #[error("the file goes on after the {promised} {items} that its header promises; correct the header")]
    Leftover {
        /// Of what.
        items: &'static str,
        /// How many the header promises.
        promised: u64,
    },

    /// Something that should read otherwise.
    #[error("expected {expected}, found `{found}`; correct the file or export it again")]
    Syntax {
        /// What should stand there.
        expected: &'static str,
        /// What does.
        found: String,
    },

    /// A coordinate that is NaN or infinite.
    #[error("vertex {vertex} has the coordinate {value}; correct the coordinate or remove the vertex")]
    NonFinite {
        /// The vertex, counted as the format counts.
        vertex: u64,
        /// NaN, inf or -inf.
        value: f64,
    },

    /// A face that names a vertex which is not in the file.
    #[error(
        "a face names vertex {index}, but the file's vertices run from {first} to {last}; \
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

    /// A face with one or two corners.
    #[error("a face with {corners} corners; a face needs at least three: remove it")]
    TooFewCorners {
        /// How many it has.
        corners: usize,
    },

    /// Vertices only.
    #[error("{n_vertices} vertices but not one face; a surface is needed: triangulate the points first")]
    NoFaces {
        /// How many vertices there are.
        n_vertices: usize,
    },

    /// More vertices or faces than 32-bit indices can count.
    #[error("{count} {items} are more than the {limit} that fit into 32-bit indices; simplify the mesh")]
    TooLarge {
        /// Of what.
        items: &'static str,
        /// How many.
        count: u64,
        /// How many are taken.
        limit: u64,
    },

    /// More vertices or faces than are taken.
    #[error(
        "the mesh has more than {limit} {items}, the most that are taken here; simplify it, or raise the limit"
    )]
    OverLimit {
        /// Of what.
        items: &'static str,
        /// How many are taken.
        limit: u64,
    },

    /// Compressed data that would grow out of proportion.
    #[error(
        "the compressed data grows beyond {limit} bytes, out of proportion to the file; \
             it is damaged or hostile: save it again without compression if it is neither"
    )]
    Inflates {
        /// The most that is decompressed, in bytes.
        limit: u64,
    },

    /// Half a `.vert`/`.tri` pair.
    #[error(
        "its other half {partner} is missing; a shape in this format is a pair of files: \
             put both into the same folder"
    )]
    NoPartner {
        /// The name of the missing half.
        partner: String,
    },
}

/// A fault and its place in a file not yet named; the result of every parser.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Located {
    pub(crate) place: Place,
    pub(crate) fault: Fault,
}

impl Located {
    /// Names the file.
    pub(crate) fn in_file(self, path: &Path) -> MeshError {
        MeshError::File { path: path.to_path_buf(), place: self.place, fault: self.fault }
    }
}

impl Fault {
    /// The fault of the file as a whole.
    pub(crate) fn whole(self) -> Located {
        Located { place: Place::File, fault: self }
    }

    /// The fault in a line, counted from one.
    pub(crate) fn in_line(self, line: usize) -> Located {
        Located { place: Place::Line(line), fault: self }
    }

    /// The fault at a byte, counted from zero.
    pub(crate) fn at_byte(self, byte: usize) -> Located {
        Located { place: Place::Byte(byte as u64), fault: self }
    }
}
