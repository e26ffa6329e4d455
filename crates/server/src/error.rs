//! Errors of the server, and error responses with their remedies. No other place words a remedy.

use std::net::SocketAddr;
use std::path::Path;
use std::time::Duration;

use axum::Json;
use axum::http::{HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use canonform::index::IndexError;
use canonform::mesh::io::Format;
use canonform::mesh::{Fault, MeshError};
use canonform::{Error, Exceeded, Remedy};
use serde::Serialize;

/// Why a server cannot start or continue.
#[derive(Debug, thiserror::Error)]
pub enum ServerError {
    /// The index.
    #[error(transparent)]
    Index(#[from] Error),
    /// The address.
    #[error("cannot listen on {address}: {source}")]
    Listen {
        /// The address.
        address: SocketAddr,
        /// The error of the operating system.
        source: std::io::Error,
    },
    /// Threads or sockets.
    #[error("cannot start the server: {0}; close other programs and try again")]
    Runtime(std::io::Error),
}

/// An error response: `{"error", "remedy"?}`.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct ApiError {
    #[serde(skip)]
    pub(crate) status: StatusCode,
    /// What is wrong.
    pub(crate) error: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    remedy: Option<String>,
    /// In seconds.
    #[serde(skip)]
    pub(crate) retry_after: Option<u32>,
}

impl ApiError {
    pub(crate) fn new(status: StatusCode, error: impl Into<String>) -> Self {
        Self { status, error: error.into(), remedy: None, retry_after: None }
    }

    pub(crate) fn with_remedy(mut self, remedy: impl Into<String>) -> Self {
        self.remedy = Some(remedy.into());
        self
    }

    pub(crate) fn bad_request(error: impl Into<String>) -> Self {
        Self::new(StatusCode::BAD_REQUEST, error)
    }

    /// The upload has too many bytes.
    pub(crate) fn upload_too_large(limit: usize) -> Self {
        let error = format!("the upload exceeds the limit of {} MB", limit as f64 / 1e6);
        Self::new(StatusCode::PAYLOAD_TOO_LARGE, error)
            .with_remedy("simplify the mesh, or raise the upload limit of the server")
    }

    /// The client sends nothing, or too slowly.
    pub(crate) fn upload_too_slow() -> Self {
        Self::new(StatusCode::REQUEST_TIMEOUT, "the upload did not arrive in time")
            .with_remedy("check the connection and send it again")
    }

    /// Too many requests; the client may retry after this many seconds.
    pub(crate) fn busy(seconds: u32) -> Self {
        let busy = Self::new(StatusCode::SERVICE_UNAVAILABLE, "too many requests in progress")
            .with_remedy(format!("try again in {seconds} seconds"));
        Self { retry_after: Some(seconds), ..busy }
    }

    /// The request took too long.
    pub(crate) fn too_slow(limit: Duration) -> Self {
        let error = format!("the request was not finished within {} seconds", limit.as_secs_f64());
        Self::new(StatusCode::SERVICE_UNAVAILABLE, error).with_remedy(
            "simplify the mesh, try again when the server is less busy, or raise the time limit of the server",
        )
    }

    /// A bug of the program.
    pub(crate) fn internal() -> Self {
        Self::new(StatusCode::INTERNAL_SERVER_ERROR, "internal error; see the server log")
            .with_remedy("report it with the mesh that caused it")
    }

    /// A limit of the server ended the job.
    pub(crate) fn exceeded(exceeded: Exceeded) -> Self {
        match exceeded {
            Exceeded::Time { limit } => Self::too_slow(limit),
            // Nobody reads this: its client has gone, or got an answer at the time limit.
            Exceeded::Cancelled => Self::new(StatusCode::SERVICE_UNAVAILABLE, "the request was cancelled"),
            Exceeded::Steps { .. } => Self::new(StatusCode::UNPROCESSABLE_ENTITY, exceeded.to_string())
                .with_remedy("simplify the mesh"),
            Exceeded::Memory { .. } | Exceeded::Allocation { .. } => {
                Self::new(StatusCode::PAYLOAD_TOO_LARGE, "the mesh needs more memory than allowed")
                    .with_remedy("simplify the mesh")
            }
        }
    }

    fn of_fault(status: StatusCode, error: String, fault: &Error) -> Self {
        let remedy = match status {
            StatusCode::PAYLOAD_TOO_LARGE => Some("raise the vertex limit of the server"),
            _ => remedy(fault),
        };
        Self { status, error, remedy: remedy.map(str::to_owned), retry_after: None }
    }

    /// An error of an uploaded mesh, worded as on the command line and with the name of the file.
    pub(crate) fn of_upload(name: &Path, fault: Error) -> Self {
        let status = match &fault {
            Error::Mesh(MeshError::UnknownFormat { .. }) => StatusCode::UNSUPPORTED_MEDIA_TYPE,
            Error::Mesh(MeshError::File { fault: Fault::OverLimit { .. }, .. }) => {
                StatusCode::PAYLOAD_TOO_LARGE
            }
            Error::Mesh(MeshError::File { .. } | MeshError::StrayFile { .. }) => StatusCode::BAD_REQUEST,
            Error::Index(_) => return fault.into(),
            Error::Exceeded(exceeded) => return Self::exceeded(*exceeded),
            _ => StatusCode::UNPROCESSABLE_ENTITY,
        };
        let text = fault.to_string();
        // The fault may name another file of the same mesh.
        let extensions = Format::of(name).map_or(&[][..], |format| format.extensions);
        let mut files = extensions.iter().map(|e| name.with_extension(e)).chain([name.to_owned()]);
        let is_named = files.any(|file| text.contains(&file.display().to_string()));
        Self::of_fault(status, if is_named { text } else { format!("{}: {text}", name.display()) }, &fault)
    }
}

/// Errors of indexed shapes. Clients must not learn where the index and its meshes lie on this machine, so messages
/// with paths are replaced.
impl From<Error> for ApiError {
    fn from(fault: Error) -> Self {
        let (status, text) = match &fault {
            Error::Index(IndexError::NoSuchShape { id, .. }) => {
                (StatusCode::NOT_FOUND, format!("the index has no shape `{id}`"))
            }
            Error::MeshGone { id, .. } => (StatusCode::NOT_FOUND, format!("cannot read the mesh of `{id}`")),
            Error::MeshChanged { id, .. } => {
                (StatusCode::GONE, format!("the mesh of `{id}` has changed since it was indexed"))
            }
            Error::Exceeded(exceeded) => return Self::exceeded(*exceeded),
            _ => {
                base::write_line(&format!("error: {fault}"));
                return Self::internal();
            }
        };
        Self::of_fault(status, text, &fault)
    }
}

/// What to do about an error, in words that do not depend on a program.
fn remedy(fault: &Error) -> Option<&'static str> {
    Some(match fault.remedy()? {
        Remedy::KeepLargestOrBridge | Remedy::BridgeComponents | Remedy::BridgeOrWeld => {
            "join the components of the mesh, or keep only the largest one"
        }
        Remedy::RestoreMesh => {
            "restore the mesh file, move the index back to the place where it was built, or build the index again"
        }
        Remedy::BuildIndexAgain => "build the index again",
        Remedy::BuildIndexAnew => "build the index in a new file",
        Remedy::UseThreeDimensions => "build the index with forms of three dimensions",
        Remedy::UseFastMarching => "build the index with distances by fast marching",
        Remedy::UseNystrom => "simplify the mesh, or build the index with NMDS, which needs less memory",
        Remedy::NameMember => "send one mesh, or an archive of one",
        Remedy::RaiseMemory => "simplify the mesh",
        Remedy::RaiseTimeLimit => "simplify the mesh, or raise the time limit of the server",
        Remedy::ListShapes => "/api/shapes lists the shapes of the index",
        // No request leads to these.
        Remedy::GiveSamples
        | Remedy::RaiseMaxDistance
        | Remedy::GiveLabels
        | Remedy::ReplaceShape
        | Remedy::BuildFieldAgain
        | Remedy::EvaluateShard => return None,
    })
}

impl IntoResponse for ApiError {
    fn into_response(self) -> Response {
        let mut response = (self.status, Json(&self)).into_response();
        if let Some(seconds) = self.retry_after {
            response.headers_mut().insert(header::RETRY_AFTER, HeaderValue::from(seconds));
        }
        response
    }
}
