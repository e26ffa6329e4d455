//! Errors of the library, and typed remedies that programs put into their own words.

use std::path::PathBuf;

use base::Exceeded;
use base::files::FileError;
use collection::CollectionError;
use descriptors::DescriptorError;
use fields::FieldError;
use geodesics::GeodesicError;
use index::IndexError;
use linalg::LinalgError;
use maps::LandmarkConflict;
use mesh::{InputPoint, MeshError, PointError};
use nmds::NmdsError;
use retrieval::RetrievalError;
use surface::VertexId;

/// Errors of this crate and of the crates it builds on; [`remedy`](Error::remedy) says what would help.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Reading, writing, validation or repair.
    #[error(transparent)]
    Mesh(MeshError),
    /// A point that the surface does not have.
    #[error(transparent)]
    Point(#[from] PointError),
    /// Distances on the surface.
    #[error(transparent)]
    Geodesic(GeodesicError),
    /// Matrices.
    #[error(transparent)]
    Linalg(LinalgError),
    /// The embedding.
    #[error(transparent)]
    Nmds(NmdsError),
    /// A limit on time or memory, or a cancellation.
    #[error(transparent)]
    Exceeded(#[from] Exceeded),
    /// The form, its alignment or its signatures.
    #[error(transparent)]
    Descriptor(DescriptorError),
    /// The scores.
    #[error(transparent)]
    Retrieval(#[from] RetrievalError),
    /// The index.
    #[error(transparent)]
    Index(#[from] IndexError),
    /// An index whose options this version cannot read.
    #[error(
        "the shapes of {path} were described with options that this version does not know: {options}",
        path = path.display()
    )]
    UnknownOptions {
        /// The index.
        path: PathBuf,
        /// The options as the index states them.
        options: String,
    },
    /// A shape whose name another shape of the index has.
    #[error("the index already has another shape `{id}`, from {path}", path = path.display())]
    AlreadyThere {
        /// The name.
        id: String,
        /// Mesh of the shape in the index.
        path: PathBuf,
    },
    /// The mesh of an indexed shape cannot be read any more.
    #[error("cannot read the mesh of `{id}` from {path}: {source}", path = path.display())]
    MeshGone {
        /// Name of the shape.
        id: String,
        /// Path of its mesh when it was indexed.
        path: PathBuf,
        /// The error of the operating system.
        source: std::io::Error,
    },
    /// The mesh of an indexed shape is not the one that was indexed.
    #[error("the mesh of `{id}` in {path} has changed since it was indexed", path = path.display())]
    MeshChanged {
        /// Name of the shape.
        id: String,
        /// Path of its mesh.
        path: PathBuf,
    },
    /// A path to a point without a known distance.
    #[error("there is no path to {target}: it lies beyond the distance limit")]
    NoPath {
        /// The end of the path.
        target: String,
    },
    /// Options, files and shapes that do not go together.
    #[error("{what}")]
    Refused {
        /// What is wrong.
        what: String,
        /// What would help.
        remedy: Option<Remedy>,
    },
    /// Something that does not fit into memory.
    #[error("{what}")]
    TooLarge {
        /// What, and how large it would be.
        what: String,
        /// What would help.
        remedy: Remedy,
    },
    /// Landmarks of a map that contradict each other.
    #[error(
        "the landmarks {},{} and {},{} contradict each other: {how}; correct or leave out one of them",
        pairs[0][0], pairs[0][1], pairs[1][0], pairs[1][1]
    )]
    ContradictoryLandmarks {
        /// The landmarks, a vertex of the first input and one of the second.
        pairs: [[VertexId; 2]; 2],
        /// Why.
        how: LandmarkConflict,
    },
    /// A folder or a text file that cannot be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// A folder, an archive, a list or a file of labels or distances that cannot be read.
    #[error(transparent)]
    Collection(CollectionError),
    /// A file that is no distance field, or a damaged one.
    #[error(transparent)]
    Field(FieldError),
}

/// What a user can do about an [`Error`], in [words](Self::in_words) of a program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, strum::VariantArray)]
pub enum Remedy {
    /// Keep the largest component of the mesh, or bridge its components.
    KeepLargestOrBridge,
    /// Bridge the components of the mesh, so that none is dropped.
    BridgeComponents,
    /// Bridge the components of the mesh or close the gaps between them, so that none is dropped; or accept the loss.
    BridgeOrWeld,
    /// Embed in three dimensions.
    UseThreeDimensions,
    /// Measure distances by fast marching, which takes every surface.
    UseFastMarching,
    /// Embed by NMDS, which needs a few columns of distances only.
    UseNystrom,
    /// Give the number of samples.
    GiveSamples,
    /// Allow more memory.
    RaiseMemory,
    /// Allow more time.
    RaiseTimeLimit,
    /// Allow larger distances.
    RaiseMaxDistance,
    /// Name the classes in a label file.
    GiveLabels,
    /// Remove or replace the shape in the index, or rename the new one.
    ReplaceShape,
    /// Put the mesh file back, start in the folder that the index was built in, or build the index again.
    RestoreMesh,
    /// Build the index again.
    BuildIndexAgain,
    /// Build the index again in a new file, so that every shape is described again.
    BuildIndexAnew,
    /// Build the distance field again from its mesh.
    BuildFieldAgain,
    /// Look at the names in the index.
    ListShapes,
    /// Evaluate a part of the collection, such as one shard.
    EvaluateShard,
    /// Name one mesh of the archive.
    NameMember,
}

impl Remedy {
    /// What to do, with options as `spell` writes them: a name, and the values that it may have, or none. Names of two words
    /// are those of commands.
    pub fn in_words(self, spell: impl Fn(&str, &[&str]) -> String) -> String {
        let named = |name: &str| spell(name, &[]);
        let valued = |name: &str, value: &str| spell(name, &[value]);
        let bridge = valued("components", "bridge");
        match self {
            Self::KeepLargestOrBridge => format!("pass {} or {bridge}", valued("components", "largest")),
            Self::BridgeComponents => format!("to keep all components, pass {bridge}"),
            Self::BridgeOrWeld => {
                let weld = valued("weld", "TOL");
                format!("pass {bridge} to keep all components, or {weld} to close gaps up to TOL wide")
            }
            Self::UseThreeDimensions => format!("leave out {}", named("dim")),
            Self::UseFastMarching => "use fast-marching".to_owned(),
            Self::UseNystrom => format!("use {}, which needs only a few columns", valued("method", "nmds")),
            Self::GiveSamples => format!("give {}, the number of samples, such as 100", named("samples")),
            Self::RaiseMemory => format!("raise {}", named("memory")),
            Self::RaiseTimeLimit => format!("raise {}", named("timeout")),
            Self::RaiseMaxDistance => format!("choose another target, or raise {}", named("max_distance")),
            Self::GiveLabels => format!("give classes with {}", named("labels")),
            Self::ReplaceShape => {
                format!("rename the new shape, remove the old one, or pass {}", named("replace"))
            }
            Self::RestoreMesh => {
                "restore the file, move the index back to the place where it was built, or build the index again"
                    .to_owned()
            }
            Self::BuildIndexAgain => {
                format!("restore the index from a copy, or build it again with {}", named("index build"))
            }
            Self::BuildIndexAnew => format!("build the index with {} in a new file", named("index build")),
            Self::BuildFieldAgain => format!("build it again with {}", named("field build")),
            Self::ListShapes => format!("{} names its shapes", named("index list")),
            Self::EvaluateShard => "evaluate one shard at a time".to_owned(),
            Self::NameMember => "name one of them, as ARCHIVE/NAME".to_owned(),
        }
    }
}

/// Errors of the stages, those of what they use as the errors that these are: a limit that was exceeded is [`Error::Exceeded`] at
/// every depth.
macro_rules! from_stage {
    ($($error:ident => $variant:ident: $($inner:pat => $fault:ident),+;)+) => {$(
        impl From<$error> for Error {
            fn from(error: $error) -> Self {
                match error {
                    $($inner => $fault.into(),)+
                    other => Self::$variant(other),
                }
            }
        }
    )+};
}

from_stage! {
    MeshError => Mesh: MeshError::Exceeded(limit) => limit;
    LinalgError => Linalg: LinalgError::Exceeded(limit) => limit;
    GeodesicError => Geodesic:
        GeodesicError::Exceeded(limit) => limit,
        GeodesicError::Matrix(LinalgError::Exceeded(limit)) => limit;
    NmdsError => Nmds:
        NmdsError::Exceeded(limit) => limit,
        NmdsError::Linalg(LinalgError::Exceeded(limit)) => limit;
    DescriptorError => Descriptor:
        DescriptorError::Linalg(LinalgError::Exceeded(limit)) => limit,
        DescriptorError::Nmds(NmdsError::Exceeded(limit)) => limit,
        DescriptorError::Nmds(NmdsError::Linalg(LinalgError::Exceeded(limit))) => limit;
    CollectionError => Collection:
        CollectionError::File(fault) => fault,
        CollectionError::Mesh(fault) => fault;
    FieldError => Field:
        FieldError::File(fault) => fault,
        FieldError::Geodesic(fault) => fault,
        FieldError::Linalg(fault) => fault,
        FieldError::Nmds(fault) => fault,
        FieldError::Exceeded(limit) => limit;
}

impl Remedy {
    /// What would help against an error of an index.
    pub fn from_index(fault: &IndexError) -> Option<Self> {
        match fault {
            IndexError::Damaged { .. } | IndexError::PastVersion { .. } => Some(Self::BuildIndexAgain),
            IndexError::Foreign(_) => Some(Self::BuildIndexAnew),
            IndexError::NoSuchShape { .. } => Some(Self::ListShapes),
            _ => None,
        }
    }
}

impl Error {
    pub(crate) fn refused(what: impl Into<String>) -> Self {
        Self::Refused { what: what.into(), remedy: None }
    }

    /// What would help, if it depends on the interface of the program; other advice is part of the message.
    pub fn remedy(&self) -> Option<Remedy> {
        Some(match self {
            Self::Mesh(MeshError::Disconnected { .. })
            | Self::Geodesic(GeodesicError::Disconnected { .. }) => Remedy::KeepLargestOrBridge,
            Self::Point(PointError::Dropped { point: InputPoint::Vertex(_) | InputPoint::Face { .. } }) => {
                Remedy::BridgeComponents
            }
            Self::Descriptor(DescriptorError::NotThreeDimensional { .. }) => Remedy::UseThreeDimensions,
            Self::Geodesic(GeodesicError::NotFactorized(_)) => Remedy::UseFastMarching,
            Self::Geodesic(GeodesicError::NoPath { .. }) | Self::NoPath { .. } => Remedy::RaiseMaxDistance,
            Self::Refused { remedy, .. } => return *remedy,
            Self::TooLarge { remedy, .. } => *remedy,
            Self::Exceeded(Exceeded::Memory { .. }) => Remedy::RaiseMemory,
            Self::Exceeded(Exceeded::Time { .. }) => Remedy::RaiseTimeLimit,
            Self::Retrieval(RetrievalError::NothingToScore { .. }) => Remedy::GiveLabels,
            Self::AlreadyThere { .. } => Remedy::ReplaceShape,
            Self::MeshGone { .. } | Self::MeshChanged { .. } => Remedy::RestoreMesh,
            Self::UnknownOptions { .. } => Remedy::BuildIndexAgain,
            Self::Index(fault) => return Remedy::from_index(fault),
            Self::Field(_) => Remedy::BuildFieldAgain,
            Self::Collection(CollectionError::NotOneMesh { n_meshes: 2.., .. }) => Remedy::NameMember,
            _ => return None,
        })
    }
}
