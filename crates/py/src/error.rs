//! Library errors as Python exceptions, with remedies as keyword arguments. No other place words a remedy.

use base::Exceeded;
use base::files::FileError;
use canonform::collection::CollectionError;
use canonform::geodesics::GeodesicError;
use canonform::index::IndexError;
use canonform::mesh::MeshError;
use canonform::{Error, Remedy};
use datasets::DatasetError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyModule;

/// The exceptions of `canonform.errors`.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Exception {
    Mesh,
    Option,
    Point,
    Embedding,
    Limit,
    OutOfMemory,
    OutOfTime,
    File,
    MissingFile,
    Index,
    NoSuchShape,
    Canonform,
}

impl Exception {
    fn name(self) -> &'static str {
        match self {
            Self::Mesh => "MeshError",
            Self::Option => "OptionError",
            Self::Point => "PointError",
            Self::Embedding => "EmbeddingError",
            Self::Limit => "LimitError",
            Self::OutOfMemory => "MemoryLimitError",
            Self::OutOfTime => "TimeLimitError",
            Self::File => "FileError",
            Self::MissingFile => "MissingFileError",
            Self::Index => "ShapeIndexError",
            Self::NoSuchShape => "NoSuchShapeError",
            Self::Canonform => "CanonformError",
        }
    }

    /// The exception with this message.
    pub(crate) fn with(self, message: &str) -> PyErr {
        Python::attach(|py| {
            static MODULE: PyOnceLock<Py<PyModule>> = PyOnceLock::new();
            let import = || Ok::<_, PyErr>(py.import("canonform.errors")?.unbind());
            let raised = MODULE.get_or_try_init(py, import).and_then(|module| {
                Ok(PyErr::from_value(
                    module.bind(py).getattr(self.name())?.call1((base::printable(message),))?,
                ))
            });
            raised.unwrap_or_else(|fault| fault)
        })
    }

    fn of(fault: &Error) -> Self {
        match fault {
            Error::Mesh(MeshError::Io(file)) | Error::File(file) => Self::of_file(file),
            Error::Mesh(_) | Error::Collection(CollectionError::NoShapes { .. }) => Self::Mesh,
            Error::Exceeded(Exceeded::Memory { .. } | Exceeded::Allocation { .. })
            | Error::MemoryTooSmall { .. }
            | Error::EmbeddingTooLarge { .. }
            | Error::AllPairsTooLarge { .. }
            | Error::TooManyShapes { .. } => Self::OutOfMemory,
            Error::Exceeded(Exceeded::Time { .. }) => Self::OutOfTime,
            Error::Exceeded(_) => Self::Limit,
            Error::Point(_) | Error::NoPath { .. } | Error::Geodesic(GeodesicError::NoSuchVertex { .. }) => {
                Self::Point
            }
            Error::Field(_) => Self::File,
            Error::BadDescription { .. }
            | Error::NoSuchShard { .. }
            | Error::UnusableMap(_)
            | Error::NoStress { .. }
            | Error::NoExtension { .. }
            | Error::OtherSurface { .. }
            | Error::NotThere { .. }
            | Error::ContradictoryLandmarks { .. } => Self::Option,
            Error::Index(IndexError::NoSuchShape { .. }) => Self::NoSuchShape,
            Error::Index(IndexError::Io { source, .. }) if source.kind() == std::io::ErrorKind::NotFound => {
                Self::MissingFile
            }
            Error::MeshGone { .. } => Self::MissingFile,
            Error::Index(_)
            | Error::UnknownOptions { .. }
            | Error::AlreadyThere { .. }
            | Error::MeshChanged { .. } => Self::Index,
            Error::Geodesic(_)
            | Error::Linalg(_)
            | Error::Nmds(_)
            | Error::Descriptor(_)
            | Error::Retrieval(_) => Self::Embedding,
            _ => Self::Canonform,
        }
    }

    fn of_file(fault: &FileError) -> Self {
        match fault.source.kind() {
            std::io::ErrorKind::NotFound => Self::MissingFile,
            _ => Self::File,
        }
    }
}

fn words(remedy: Remedy) -> &'static str {
    match remedy {
        Remedy::KeepLargestOrBridge => "pass components=\"largest\" or components=\"bridge\"",
        Remedy::BridgeComponents => "to keep all components, pass components=\"bridge\"",
        Remedy::BridgeOrWeld => {
            "pass components=\"bridge\" to keep all components, or weld=TOLERANCE to close gaps that wide"
        }
        Remedy::UseThreeDimensions => "leave out n_components=",
        Remedy::UseFastMarching => "use geodesic=\"fast-marching\"",
        Remedy::UseNystrom => "use method=\"nmds\", which needs only a few columns",
        Remedy::GiveSamples => "give a number of landmarks, such as n_landmarks=100",
        Remedy::RaiseMemory => "raise memory=",
        Remedy::RaiseTimeLimit => "raise timeout=",
        Remedy::RaiseMaxDistance => "choose another target, or raise max_distance=",
        Remedy::GiveLabels => "give classes with labels=",
        Remedy::ReplaceShape => "rename the new shape, remove the old one, or pass replace=True",
        Remedy::RestoreMesh => {
            "restore the file, move the index back to the place where it was built, or build the index again"
        }
        Remedy::BuildIndexAgain => "restore the index from a copy, or build it again with Index.build",
        Remedy::BuildIndexAnew => "build the index with Index.build in a new file",
        Remedy::BuildFieldAgain => "build it again with Surface.distance_field",
        Remedy::ListShapes => "Index.shapes() names its shapes",
        Remedy::EvaluateShard => "evaluate one shard at a time",
        Remedy::NameMember => "name one of them, as \"ARCHIVE/NAME\"",
    }
}

/// A message with its remedy as keyword arguments.
pub(crate) fn with_remedy(message: String, remedy: Option<Remedy>) -> String {
    remedy.map_or(message.clone(), |remedy| format!("{message}; {}", words(remedy)))
}

/// An error of the library as the exception that Python raises.
pub(crate) fn to_python(fault: &Error) -> PyErr {
    Exception::of(fault).with(&with_remedy(fault.to_string(), fault.remedy()))
}

pub(crate) fn of_dataset(fault: &DatasetError) -> PyErr {
    Exception::Option.with(&fault.to_string())
}
