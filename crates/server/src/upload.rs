//! Receives a multipart form with a mesh into memory, within limits.

use std::path::PathBuf;
use std::pin::{Pin, pin};
use std::sync::{Arc, Mutex, PoisonError};
use std::task::{Context, Poll};
use std::time::Duration;

use axum::body::{Body, BodyDataStream, Bytes};
use axum::extract::multipart::MultipartError;
use axum::extract::{DefaultBodyLimit, FromRequest, Multipart, Request};
use axum::http::{StatusCode, header};
use canonform::mesh::io::mesh_files;
use futures_util::future::{Either, select};
use futures_util::{Stream, StreamExt};

use crate::error::ApiError;
use crate::options::ServeOptions;
use crate::pace::{Pace, Phase};
use crate::places::Place;

/// Allowance for boundaries and headers of a form, in bytes.
const FRAME: usize = 64 << 10;

/// Maximum number of files in a form.
const MOST_FILES: usize = 16;

/// Number of characters of a file name to keep.
const LONGEST_NAME: usize = 200;

/// After a rejection the server keeps reading for this long, so that the client sees the response instead of a reset.
const REFUSED_TIME: Duration = Duration::from_secs(5);
const REFUSED_BYTES: usize = 256 << 20;

/// Names without folders, and contents.
pub(crate) type Files = Vec<(PathBuf, Vec<u8>)>;

/// The announced length of a body, in bytes; 0 if it is not announced.
pub(crate) fn announced(request: &Request) -> usize {
    let length = request.headers().get(header::CONTENT_LENGTH).and_then(|length| length.to_str().ok());
    length.and_then(|length| length.parse().ok()).unwrap_or(0)
}

/// Receives a form. The client must keep its pace, or it loses the `place`.
pub(crate) async fn receive(
    mut request: Request,
    place: &Place,
    pace: &Pace,
    options: &ServeOptions,
) -> Result<Files, ApiError> {
    if announced(&request) > options.max_upload + FRAME {
        return Err(ApiError::upload_too_large(options.max_upload));
    }
    DefaultBodyLimit::max(options.max_upload + FRAME).apply(&mut request);
    pace.begin(Phase::Receiving);
    let form = pin!(read(request, options));
    let slow = pin!(pace.is_over(Phase::Receiving));
    let late = pin!(tokio::time::sleep(options.upload_time));
    let lost = pin!(place.lost());
    let received = match select(form, select(select(slow, late), lost)).await {
        Either::Left((form, _)) => form,
        Either::Right((Either::Left(_), _)) => {
            Err(ApiError::upload_too_slow("the upload did not arrive in time"))
        }
        Either::Right((Either::Right(_), _)) => {
            Err(ApiError::upload_too_slow("the upload arrived too slowly while others were waiting"))
        }
    };
    pace.begin(Phase::Working);
    received
}

async fn read(request: Request, options: &ServeOptions) -> Result<Files, ApiError> {
    let mut form = Multipart::from_request(request, &()).await.map_err(|_| {
        ApiError::new(StatusCode::UNSUPPORTED_MEDIA_TYPE, "the request is not a form with a file")
            .with_remedy(form_remedy())
    })?;
    let faulty = |fault: MultipartError| match fault.status() {
        StatusCode::PAYLOAD_TOO_LARGE => ApiError::upload_too_large(options.max_upload),
        _ => ApiError::bad_request(format!("the form cannot be read: {}", fault.body_text()))
            .with_remedy(form_remedy()),
    };
    let mut files = Files::new();
    while let Some(part) = form.next_field().await.map_err(faulty)? {
        if files.len() == MOST_FILES {
            return Err(ApiError::bad_request(format!("the form has more than {MOST_FILES} files")));
        }
        let Some(name) = part.file_name().map(clean_name) else {
            return Err(ApiError::bad_request("a field of the form is no file")
                .with_remedy("give parameters in the address, such as /api/search?k=5"));
        };
        let content = part.bytes().await.map_err(faulty)?;
        // Browsers send nothing of this name if no file was chosen.
        if !(name.as_os_str().is_empty() && content.is_empty()) {
            files.push((name, content.into()));
        }
    }
    Ok(files)
}

fn form_remedy() -> String {
    format!("send multipart/form-data with one mesh: {}", mesh_files())
}

/// A file name without folders and control characters; only the end of a long one.
fn clean_name(name: &str) -> PathBuf {
    let name = name.rsplit(['/', '\\']).next().unwrap_or_default();
    let skipped = name.chars().count().saturating_sub(LONGEST_NAME);
    let clean = |c: char| if c.is_control() { char::REPLACEMENT_CHARACTER } else { c };
    name.chars().skip(skipped).map(clean).collect::<String>().into()
}

/// The body of a request, of which something may be left when the request is answered.
#[derive(Clone)]
pub(crate) struct SharedBody(Arc<Mutex<BodyDataStream>>);

impl Stream for SharedBody {
    type Item = Result<Bytes, axum::Error>;

    fn poll_next(self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Option<Self::Item>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).poll_next_unpin(context)
    }
}

impl SharedBody {
    /// The request, and its body.
    pub(crate) fn of(request: Request) -> (Request, Self) {
        let (head, body) = request.into_parts();
        let body = Self(Arc::new(Mutex::new(body.into_data_stream())));
        (Request::from_parts(head, Body::from_stream(body.clone())), body)
    }

    /// Reads the rest for a while and drops it: many clients read the response only after they have sent everything, and
    /// not at all if the connection breaks before.
    pub(crate) async fn drained(mut self) {
        let mut left = REFUSED_BYTES;
        let draining = async {
            while let Some(Ok(piece)) = self.next().await {
                left = left.saturating_sub(piece.len());
                if left == 0 {
                    break;
                }
            }
        };
        // Both outcomes are fine.
        let _ = tokio::time::timeout(REFUSED_TIME, draining).await;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lose_folders_and_control_characters() {
        for (name, expected) in [
            ("cat0.off", "cat0.off"),
            ("../../etc/passwd", "passwd"),
            ("C:\\meshes\\cat.obj", "cat.obj"),
            ("a\u{1b}[2J\n.off", "a\u{fffd}[2J\u{fffd}.off"),
            ("folder/", ""),
            ("..", ".."),
        ] {
            assert_eq!(clean_name(name), PathBuf::from(expected), "{name:?}");
        }
        let long = clean_name(&format!("{}.off", "x".repeat(5000)));
        assert_eq!(long.to_string_lossy().len(), LONGEST_NAME);
        assert!(canonform::mesh::io::is_mesh_path(&long));
    }
}
