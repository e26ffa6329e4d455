//! Library errors as Python exceptions, with remedies as keyword arguments.

use std::fmt::Display;

use base::Exceeded;
use base::files::FileError;
use canonform::collection::CollectionError;
use canonform::geodesics::GeodesicError;
use canonform::index::IndexError;
use canonform::mesh::MeshError;
use canonform::{Error, Remedy};
use pyo3::prelude::*;

/// The exceptions of `canonform.errors`.
#[expect(clippy::enum_variant_names, reason = "as Python names them")]
#[derive(Debug, Clone, Copy, strum::IntoStaticStr)]
pub(crate) enum Exception {
    MeshError,
    OptionError,
    PointError,
    EmbeddingError,
    LimitError,
    MemoryLimitError,
    TimeLimitError,
    FileError,
    MissingFileError,
    ShapeIndexError,
    NoSuchShapeError,
    CanonformError,
}

impl Exception {
    /// The exception with this message.
    pub(crate) fn with(self, message: impl Display) -> PyErr {
        let message = message.to_string();
        Python::attach(|py| {
            let class = py.import("canonform.errors").and_then(|errors| errors.getattr(<&str>::from(self)));
            let raised = class.and_then(|class| class.call1((base::printable(&message),)));
            raised.map_or_else(|fault| fault, PyErr::from_value)
        })
    }

    fn of(fault: &Error) -> Self {
        match fault {
            Error::Mesh(MeshError::Io(file)) | Error::File(file) => Self::of_file(file),
            Error::Mesh(_) | Error::Collection(CollectionError::NoShapes { .. }) => Self::MeshError,
            Error::Exceeded(Exceeded::Memory { .. } | Exceeded::Allocation { .. })
            | Error::TooLarge { .. } => Self::MemoryLimitError,
            Error::Exceeded(Exceeded::Time { .. }) => Self::TimeLimitError,
            Error::Exceeded(_) => Self::LimitError,
            Error::Point(_) | Error::NoPath { .. } | Error::Geodesic(GeodesicError::NoSuchVertex { .. }) => {
                Self::PointError
            }
            Error::Field(_) => Self::FileError,
            Error::Refused { .. } | Error::ContradictoryLandmarks { .. } => Self::OptionError,
            Error::Index(IndexError::NoSuchShape { .. }) => Self::NoSuchShapeError,
            Error::Index(IndexError::Io { source, .. }) if source.kind() == std::io::ErrorKind::NotFound => {
                Self::MissingFileError
            }
            Error::MeshGone { .. } => Self::MissingFileError,
            Error::Index(_)
            | Error::UnknownOptions { .. }
            | Error::AlreadyThere { .. }
            | Error::MeshChanged { .. } => Self::ShapeIndexError,
            Error::Geodesic(_)
            | Error::Linalg(_)
            | Error::Nmds(_)
            | Error::Descriptor(_)
            | Error::Retrieval(_) => Self::EmbeddingError,
            _ => Self::CanonformError,
        }
    }

    fn of_file(fault: &FileError) -> Self {
        match fault.source.kind() {
            std::io::ErrorKind::NotFound => Self::MissingFileError,
            _ => Self::FileError,
        }
    }
}

/// An option of the library as a keyword argument with the values that it may have, or a command as a function.
pub(crate) fn spelled(name: &str, values: &[&str]) -> String {
    let name = match name {
        "index build" => return "Index.build".to_owned(),
        "index list" => return "Index.shapes()".to_owned(),
        "field build" => return "Surface.distance_field".to_owned(),
        "replace" => return "replace=True".to_owned(),
        "dim" => "n_components",
        "samples" => "n_landmarks",
        name => name,
    };
    let values: Vec<_> = values.iter().map(|value| format!("{value:?}")).collect();
    format!("{name}={}", values.join(" or "))
}

/// A message with its remedy as keyword arguments.
pub(crate) fn with_remedy(message: String, remedy: Option<Remedy>) -> String {
    match remedy {
        Some(remedy) => format!("{message}; {}", remedy.in_words(spelled)),
        None => message,
    }
}

/// An error of the library as the exception that Python raises.
pub(crate) fn to_python(fault: &Error) -> PyErr {
    Exception::of(fault).with(with_remedy(fault.to_string(), fault.remedy()))
}

/// A result of the library as one of Python.
pub(crate) fn raised<T>(found: Result<T, impl Into<Error>>) -> PyResult<T> {
    found.map_err(|fault| to_python(&fault.into()))
}
