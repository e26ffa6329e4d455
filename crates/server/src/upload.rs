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

/// Allowance for boundaries, headers and other fields of a form, in bytes.
const FRAME: usize = 64 << 10;

/// Maximum number of parts of a form, and size of one that is not a file.
const MOST_PARTS: usize = 16;
const LONGEST_FIELD: usize = 1 << 10;

/// Number of characters of a file name to keep.
const LONGEST_NAME: usize = 200;

/// After a rejection the server keeps reading for this long, so that the client sees the response instead of a reset.
const REFUSED_TIME: Duration = Duration::from_secs(5);
const REFUSED_BYTES: usize = 256 << 20;

/// The contents of a form.
#[derive(Debug, Default)]
pub(crate) struct Upload {
    /// Names without folders, and contents.
    pub(crate) files: Vec<(PathBuf, Vec<u8>)>,
    /// Names and texts.
    pub(crate) fields: Vec<(String, String)>,
}

impl Upload {
    /// Size of the files.
    pub(crate) fn bytes(&self) -> usize {
        self.files.iter().map(|(_, content)| content.len()).sum()
    }
}

/// The announced length of a body, in bytes; 0 if it is not announced.
pub(crate) fn announced(request: &Request) -> usize {
    let length = request.headers().get(header::CONTENT_LENGTH).and_then(|length| length.to_str().ok());
    length.and_then(|length| length.parse().ok()).unwrap_or(0)
}

/// Receives a form. The client must keep its pace, or it loses the `place`.
pub(crate) async fn receive(
    request: Request,
    place: &Place,
    pace: &Pace,
    options: &ServeOptions,
) -> Result<Upload, ApiError> {
    let announced = announced(&request);
    let (head, body) = request.into_parts();
    let body = Shared(Arc::new(Mutex::new(body.into_data_stream())));
    let mut request = Request::from_parts(head, Body::from_stream(body.clone()));
    DefaultBodyLimit::max(options.max_upload + FRAME).apply(&mut request);
    let received = async {
        if announced > options.max_upload + FRAME {
            return Err(ApiError::upload_too_large(options.max_upload));
        }
        let form = pin!(read(request, options));
        let slow = pin!(pace.is_over(Phase::Receiving));
        let late = pin!(tokio::time::sleep(options.upload_time));
        let lost = pin!(place.lost());
        match select(form, select(select(slow, late), lost)).await {
            Either::Left((form, _)) => form,
            Either::Right((Either::Left(_), _)) => {
                Err(ApiError::upload_too_slow("the upload did not arrive in time"))
            }
            Either::Right((Either::Right(_), _)) => {
                Err(ApiError::upload_too_slow("the upload arrived too slowly while others were waiting"))
            }
        }
    };
    pace.begin(Phase::Receiving);
    let received = received.await;
    pace.begin(Phase::Working);
    if received.is_err() {
        tokio::spawn(drained(body));
    }
    received
}

async fn read(request: Request, options: &ServeOptions) -> Result<Upload, ApiError> {
    let mut form = Multipart::from_request(request, &()).await.map_err(|_| {
        ApiError::new(StatusCode::UNSUPPORTED_MEDIA_TYPE, "the request is not a form with a file")
            .with_remedy(form_remedy())
    })?;
    let faulty = |fault: MultipartError| match fault.status() {
        StatusCode::PAYLOAD_TOO_LARGE => ApiError::upload_too_large(options.max_upload),
        _ => ApiError::bad_request(format!("the form cannot be read: {}", fault.body_text()))
            .with_remedy(form_remedy()),
    };
    let mut upload = Upload::default();
    while let Some(part) = form.next_field().await.map_err(faulty)? {
        if upload.files.len() + upload.fields.len() == MOST_PARTS {
            return Err(ApiError::bad_request(format!("the form has more than {MOST_PARTS} parts")));
        }
        let (name, file) = (part.name().unwrap_or_default().to_owned(), part.file_name().map(clean_name));
        let content = part.bytes().await.map_err(faulty)?;
        match file {
            // Browsers send this if no file was chosen.
            Some(file) if file.as_os_str().is_empty() && content.is_empty() => {}
            Some(file) => upload.files.push((file, content.into())),
            None if content.len() > LONGEST_FIELD => {
                let error = format!("a field of the form has more than {LONGEST_FIELD} bytes");
                return Err(ApiError::bad_request(error));
            }
            None => upload.fields.push((name, String::from_utf8_lossy(&content).trim().to_owned())),
        }
    }
    Ok(upload)
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

/// The body of a request, shared by its reader and [`drained`].
#[derive(Clone)]
struct Shared(Arc<Mutex<BodyDataStream>>);

impl Stream for Shared {
    type Item = Result<Bytes, axum::Error>;

    fn poll_next(self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Option<Self::Item>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).poll_next_unpin(context)
    }
}

/// Reads and drops the body of a request that is rejected without reading it.
pub(crate) fn drain(request: Request) {
    tokio::spawn(drained(request.into_body().into_data_stream()));
}

/// Reads on for a while and drops everything: many clients read the response only after they have sent everything, and
/// not at all if the connection breaks before.
async fn drained(mut body: impl Stream<Item = Result<Bytes, axum::Error>> + Unpin) {
    let mut left = REFUSED_BYTES;
    let draining = async {
        while let Some(Ok(piece)) = body.next().await {
            left = left.saturating_sub(piece.len());
            if left == 0 {
                break;
            }
        }
    };
    // Both outcomes are fine.
    let _ = tokio::time::timeout(REFUSED_TIME, draining).await;
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
