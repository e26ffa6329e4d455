//! Receives a multipart form with a mesh into memory, within limits of size, time and memory.

use std::future::poll_fn;
use std::path::PathBuf;
use std::pin::Pin;
use std::sync::Arc;
use std::time::Duration;

use axum::body::HttpBody;
use axum::extract::multipart::MultipartError;
use axum::extract::{DefaultBodyLimit, FromRequest, Multipart, Request};
use axum::http::StatusCode;
use canonform::mesh::io::mesh_files;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time::{Instant, timeout_at};

use crate::error::ApiError;
use crate::options::ServeOptions;

/// Allowance for boundaries and headers of a form, in bytes.
pub(crate) const FRAME: usize = 64 << 10;

/// Maximum number of files in a form.
const MOST_FILES: usize = 16;

/// Number of characters of a file name to keep.
const LONGEST_NAME: usize = 200;

/// The rate in bytes per second at which a client does not keep the server waiting.
const RATE: f64 = 4000.0;

/// Seconds after which a client may send an upload again for which there was no memory.
const RETRY_AFTER: u32 = 2;

/// How long the server waits for the client of a connection: for a request, for its body, and until a response is taken.
#[derive(Clone, Copy)]
pub(crate) struct Patience(pub(crate) Duration);

/// Names without folders, and contents.
pub(crate) type Files = Vec<(PathBuf, Vec<u8>)>;

/// The announced length of a body, in bytes; 0 if it is not announced.
pub(crate) fn announced(request: &Request) -> u64 {
    request.body().size_hint().lower()
}

/// Receives a form. A client that sends nothing for as long as the `patience` lasts is too slow; every byte puts that off. Every
/// byte is a permit of `memory`, too, until the permits returned with the files are dropped.
pub(crate) async fn receive(
    request: Request,
    Patience(patience): Patience,
    memory: &Arc<Semaphore>,
    options: &ServeOptions,
) -> Result<(Files, OwnedSemaphorePermit), ApiError> {
    let (announced, most) = (announced(&request), options.max_upload + FRAME);
    let (head, mut body) = request.into_parts();
    let check_size = |bytes: usize| match bytes > most {
        true => Err(ApiError::upload_too_large(options.max_upload)),
        false => Ok(()),
    };
    let hold = |bytes: usize| {
        let permit = memory.clone().try_acquire_many_owned(bytes as u32);
        permit.map_err(|_| ApiError::busy(RETRY_AFTER))
    };
    check_size(announced as usize)?;
    let (mut received, mut held) = (Vec::new(), hold(0)?);
    let latest = Instant::now() + options.upload_time;
    let mut deadline = latest.min(Instant::now() + patience);
    loop {
        let next = poll_fn(|context| Pin::new(&mut body).poll_frame(context));
        let next = timeout_at(deadline, next).await.map_err(|_| ApiError::upload_too_slow())?;
        let Some(frame) = next else { break };
        let frame = frame.map_err(|_| ApiError::bad_request("the request breaks off"))?;
        let Ok(piece) = frame.into_data() else { continue };
        check_size(received.len() + piece.len())?;
        held.merge(hold(piece.len())?);
        received.extend_from_slice(&piece);
        deadline += Duration::from_secs_f64(piece.len() as f64 / RATE);
        deadline = deadline.min(Instant::now() + patience).min(latest);
    }
    Ok((files(Request::from_parts(head, received.into())).await?, held))
}

/// The files of a form that has been received.
async fn files(mut request: Request) -> Result<Files, ApiError> {
    DefaultBodyLimit::disable().apply(&mut request);
    let mut form = Multipart::from_request(request, &()).await.map_err(|_| {
        ApiError::new(StatusCode::UNSUPPORTED_MEDIA_TYPE, "the request is not a form with a file")
            .with_remedy(form_remedy())
    })?;
    let faulty = |fault: MultipartError| {
        ApiError::bad_request(format!("the form cannot be read: {}", fault.body_text()))
            .with_remedy(form_remedy())
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
