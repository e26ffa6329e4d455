//! Request parameters, and responses with JSON and pictures.

use axum::body::{Body, Bytes};
use axum::extract::{FromRequestParts, Path, Query};
use axum::http::request::Parts;
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::error::ApiError;

/// The query string.
pub(super) struct Params<T>(pub(super) T);

impl<T: DeserializeOwned, S: Send + Sync> FromRequestParts<S> for Params<T> {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Self, ApiError> {
        Query::try_from_uri(&parts.uri).map(|Query(params)| Self(params)).map_err(|fault| {
            let text = fault.body_text();
            let what = in_words(text.rsplit_once("query string: ").map_or(&text, |(_, what)| what));
            ApiError::bad_request(format!("the parameters of the address are wrong: {what}"))
                .with_remedy("/api/openapi.json lists them, with their values")
        })
    }
}

/// What is wrong with a parameter: its name, and the words of the parser.
fn in_words(what: &str) -> String {
    let is_number = |what: &str| ["digit", "integer", "number too"].iter().any(|word| what.contains(word));
    match (what.split_once(": "), what.strip_prefix("missing field ")) {
        (_, Some(name)) => format!("{name} is missing"),
        (Some((name, what)), _) if what.contains("`true` or `false`") => format!("{name}: use true or false"),
        (Some((name, what)), _) if is_number(what) => format!("{name}: use a whole number, 0 or more"),
        _ => what.to_owned(),
    }
}

/// The name in the path.
pub(super) struct Id(pub(super) String);

impl<S: Send + Sync> FromRequestParts<S> for Id {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, ApiError> {
        let found = Path::from_request_parts(parts, state).await;
        found.map(|Path(id)| Self(id)).map_err(|fault| ApiError::bad_request(fault.body_text()))
    }
}

/// A response as JSON, written by the job that computed it because large ones take time.
pub(super) fn json(answer: &impl Serialize) -> Result<Response, ApiError> {
    let content = serde_json::to_vec(answer).map_err(|_| ApiError::internal())?;
    Ok(([(header::CONTENT_TYPE, "application/json")], content).into_response())
}

/// An entity tag: `text` in quotes.
pub(crate) fn tag(text: &str) -> HeaderValue {
    // Digits and letters always make a header.
    HeaderValue::from_str(&format!("\"{text}\"")).unwrap_or(HeaderValue::from_static("\"\""))
}

/// Whether the client already has the content with this tag.
pub(crate) fn is_known(headers: &HeaderMap, tag: &HeaderValue) -> bool {
    let known = headers.get(header::IF_NONE_MATCH).and_then(|known| known.to_str().ok());
    let tag = tag.to_str().unwrap_or_default();
    known.is_some_and(|known| known.split(',').any(|known| known.trim().trim_start_matches("W/") == tag))
}

/// A response that clients may keep but must revalidate every time; without content, 304.
pub(crate) fn tagged(tag: HeaderValue, kind: &'static str, content: Option<Bytes>) -> Response {
    let status = if content.is_some() { StatusCode::OK } else { StatusCode::NOT_MODIFIED };
    let mut response = (status, Body::from(content.unwrap_or_default())).into_response();
    let headers = response.headers_mut();
    headers.insert(header::ETAG, tag);
    headers.insert(header::CACHE_CONTROL, HeaderValue::from_static("private, no-cache"));
    if status == StatusCode::OK {
        headers.insert(header::CONTENT_TYPE, HeaderValue::from_static(kind));
    }
    response
}
