//! What a server cannot do, and what it says to a request that is no good.

use std::net::SocketAddr;
use std::path::Path;
use std::time::Duration;

use axum::Json;
use axum::http::{HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use canonform::index::IndexError;
use canonform::{Error, Remedy};
use mesh::{Fault, MeshError};
use serde::Serialize;

/// Why a server does not start or does not go on.
#[derive(Debug, thiserror::Error)]
pub enum ServerError {
    /// The index.
    #[error(transparent)]
    Pipeline(#[from] Error),
    /// The address.
    #[error("cannot listen on {address}: {source}; {remedy}", remedy = listen_remedy(source))]
    Listen {
        /// The address.
        address: SocketAddr,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// Threads or sockets.
    #[error("cannot serve: {0}; close other programs and start again")]
    Runtime(std::io::Error),
}

fn listen_remedy(source: &std::io::Error) -> &'static str {
    match source.kind() {
        std::io::ErrorKind::AddrInUse => {
            "another program has it: end that one, or pass --listen with another port (0 takes a free one)"
        }
        std::io::ErrorKind::PermissionDenied => "pass --listen with a port above 1023",
        _ => "pass --listen with an address of this machine",
    }
}

/// What a request is told that cannot be answered: `{"error", "remedy"?}`.
#[derive(Debug)]
pub(crate) struct ApiError {
    status: StatusCode,
    body: Body,
    /// In seconds.
    ask_again: Option<u32>,
}

#[derive(Debug, Serialize)]
struct Body {
    error: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    remedy: Option<String>,
}

impl ApiError {
    pub(crate) fn new(status: StatusCode, error: impl Into<String>) -> Self {
        Self { status, body: Body { error: error.into(), remedy: None }, ask_again: None }
    }

    pub(crate) fn with_remedy(mut self, remedy: impl Into<String>) -> Self {
        self.body.remedy = Some(remedy.into());
        self
    }

    pub(crate) fn bad_request(error: impl Into<String>) -> Self {
        Self::new(StatusCode::BAD_REQUEST, error)
    }

    /// More bytes than are taken.
    pub(crate) fn upload_too_large(limit: usize) -> Self {
        let limit = limit as f64 / 1e6;
        let error = format!("the upload is larger than the {limit} MB that are taken");
        Self::new(StatusCode::PAYLOAD_TOO_LARGE, error)
            .with_remedy("simplify the mesh, or start the server with a larger --max-upload")
    }

    /// The client sends nothing, or too slowly.
    pub(crate) fn upload_too_slow() -> Self {
        Self::new(StatusCode::REQUEST_TIMEOUT, "the upload did not arrive in time")
            .with_remedy("check the connection and send it again")
    }

    pub(crate) fn busy(seconds: u32) -> Self {
        let error = "too many requests are being worked on";
        let remedy = format!("ask again in {seconds} seconds");
        let busy = Self::new(StatusCode::SERVICE_UNAVAILABLE, error).with_remedy(remedy);
        Self { ask_again: Some(seconds), ..busy }
    }

    pub(crate) fn too_slow(limit: Duration) -> Self {
        let error = format!("the work was not done within {} seconds", limit.as_secs_f64());
        Self::new(StatusCode::SERVICE_UNAVAILABLE, error).with_remedy(
            "simplify the mesh, ask again when less is asked, or start the server with a larger --time-limit",
        )
    }

    /// A fault of the program.
    pub(crate) fn fault() -> Self {
        let error = "the server made a mistake; what it was stands in its terminal";
        Self::new(StatusCode::INTERNAL_SERVER_ERROR, error)
            .with_remedy("report it with the mesh that led to it")
    }

    /// What is wrong with a mesh that was sent, in the words of the command line: with its name in front unless the
    /// fault has it.
    pub(crate) fn of_upload(name: &Path, fault: &Error) -> Self {
        let status = match fault {
            Error::Mesh(MeshError::UnknownFormat { .. }) => StatusCode::UNSUPPORTED_MEDIA_TYPE,
            Error::Mesh(MeshError::File { fault: Fault::OverLimit { .. }, .. }) => {
                StatusCode::PAYLOAD_TOO_LARGE
            }
            Error::Mesh(MeshError::File { .. } | MeshError::StrayFile { .. }) => StatusCode::BAD_REQUEST,
            Error::Index(_) => return fault.into(),
            _ => StatusCode::UNPROCESSABLE_ENTITY,
        };
        let text = fault.to_string();
        // Of a `.vert`/`.tri` pair the fault may lie in the other half.
        let names = [name.to_owned(), name.with_extension("vert"), name.with_extension("tri")];
        let is_named = names.iter().any(|name| text.contains(&name.display().to_string()));
        let too_large = status == StatusCode::PAYLOAD_TOO_LARGE;
        let error = Self::new(status, if is_named { text } else { format!("{}: {text}", name.display()) });
        match remedy(fault) {
            _ if too_large => error.with_remedy("start the server with a larger --max-vertices"),
            Some(remedy) => error.with_remedy(remedy),
            None => error,
        }
    }

    #[cfg(test)]
    pub(crate) fn status(&self) -> u16 {
        self.status.as_u16()
    }
}

/// Faults of indexed shapes.
impl From<&Error> for ApiError {
    fn from(fault: &Error) -> Self {
        let status = match fault {
            Error::Index(IndexError::NoSuchShape { .. }) | Error::MeshGone { .. } => StatusCode::NOT_FOUND,
            Error::MeshChanged { .. } => StatusCode::GONE,
            _ => StatusCode::INTERNAL_SERVER_ERROR,
        };
        let error = Self::new(status, fault.to_string());
        match remedy(fault) {
            Some(remedy) => error.with_remedy(remedy),
            None => error,
        }
    }
}

/// What to do about an error, in words that do not depend on a program.
pub(crate) fn remedy(fault: &Error) -> Option<&'static str> {
    Some(match fault.remedy()? {
        Remedy::KeepLargestOrBridge | Remedy::BridgeComponents => {
            "join the components of the mesh, or keep the largest one only"
        }
        Remedy::RestoreMesh => {
            "put the mesh file back, start the server in the folder that the index was built in, or build the index \
             again"
        }
        Remedy::BuildIndexAgain => "build the index again",
        Remedy::UseNystrom => "simplify the mesh, or build the index with NMDS, which needs less memory",
        _ => return None,
    })
}

impl From<Error> for ApiError {
    fn from(fault: Error) -> Self {
        Self::from(&fault)
    }
}

impl IntoResponse for ApiError {
    fn into_response(self) -> Response {
        let mut response = (self.status, Json(self.body)).into_response();
        if let Some(seconds) = self.ask_again {
            response.headers_mut().insert(header::RETRY_AFTER, HeaderValue::from(seconds));
        }
        response
    }
}
