//! Middleware: who may ask for what, security headers, panics.

use std::net::IpAddr;
use std::panic::AssertUnwindSafe;
use std::sync::Arc;

use axum::Extension;
use axum::extract::{Request, State};
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode, Uri, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use futures_util::FutureExt;

use crate::app::App;
use crate::error::ApiError;
use crate::options::ServeOptions;
use crate::pace::{Pace, Phase};
use crate::upload::SharedBody;

const SEC_FETCH_SITE: HeaderName = HeaderName::from_static("sec-fetch-site");

/// Headers of every response. Plotly inserts style rules and renders its drawings to images.
const HEADERS: [(HeaderName, &str); 5] = [
    (
        header::CONTENT_SECURITY_POLICY,
        "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; \
         connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    ),
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::REFERRER_POLICY, "no-referrer"),
    (header::X_FRAME_OPTIONS, "DENY"),
    (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
];

/// Refuses requests for other servers, turns panics into responses, and adds the headers.
pub(crate) async fn guard(
    State(app): State<Arc<App>>,
    Extension(pace): Extension<Arc<Pace>>,
    request: Request,
    next: Next,
) -> Response {
    pace.begin(Phase::Working);
    let (request, body) = SharedBody::of(request);
    let mut response = match check(&app, request.uri(), request.headers()) {
        Ok(()) => {
            let answer = AssertUnwindSafe(next.run(request)).catch_unwind().await;
            answer.unwrap_or_else(|_| ApiError::internal().into_response())
        }
        Err(refused) => refused.into_response(),
    };
    tokio::spawn(body.drained());
    pace.begin(Phase::Waiting);
    let headers = response.headers_mut();
    for (name, value) in HEADERS {
        headers.insert(name, HeaderValue::from_static(value));
    }
    // No cache keeps responses, except for images and scripts, which have their own header.
    headers.entry(header::CACHE_CONTROL).or_insert(HeaderValue::from_static("no-store"));
    response
}

/// Refuses what a page elsewhere asks for, whatever the method: it cannot read answers, but every one of them costs work.
/// Browsers say where a request comes from in `Sec-Fetch-Site`. Old ones, and all on plain HTTP from another machine, send
/// only `Origin`, whose scheme says nothing behind a proxy. Other programs send neither.
pub(crate) async fn refuse_foreign_pages(request: Request, next: Next) -> Result<Response, ApiError> {
    let headers = request.headers();
    let is_own = match (single(headers, &SEC_FETCH_SITE)?, single(headers, &header::ORIGIN)?) {
        (Some(site), _) => matches!(site, "same-origin" | "none"),
        (None, Some(origin)) => {
            let host = single(headers, &header::HOST)?.unwrap_or_default();
            origin.split_once("://").is_some_and(|(_, from)| from.eq_ignore_ascii_case(host))
        }
        (None, None) => true,
    };
    if is_own {
        return Ok(next.run(request).await);
    }
    Err(ApiError::new(StatusCode::FORBIDDEN, "cross-origin requests are not allowed")
        .with_remedy("send the request from a page of this server, or from a program that is not a browser"))
}

/// The value of a header. With several, another program on the way may read another one.
fn single<'a>(headers: &'a HeaderMap, name: &HeaderName) -> Result<Option<&'a str>, ApiError> {
    let mut values = headers.get_all(name).iter();
    match (values.next(), values.next()) {
        (_, Some(_)) => Err(ApiError::bad_request(format!("the request has several `{name}` headers"))),
        (value, None) => Ok(value.map(|value| value.to_str().unwrap_or_default())),
    }
}

fn check(app: &App, uri: &Uri, headers: &HeaderMap) -> Result<(), ApiError> {
    let host = single(headers, &header::HOST)?;
    let host = host.ok_or_else(|| ApiError::bad_request("the request has no Host header"))?;
    if uri.authority().is_some_and(|authority| authority.as_str() != host) {
        return Err(ApiError::bad_request("the address of the request and its Host header differ"));
    }
    // A page elsewhere can resolve its own name to this machine (DNS rebinding), but not change the Host header.
    let ServeOptions { listen, public_host, .. } = &app.options;
    let name = without_port(host);
    let is_public = public_host.as_ref().is_some_and(|public| public.eq_ignore_ascii_case(name));
    if listen.ip().is_loopback() && !is_loopback(name) && !is_public {
        let error = format!("this server is not `{}`", host.chars().take(100).collect::<String>());
        return Err(ApiError::new(StatusCode::MISDIRECTED_REQUEST, error).with_remedy(
            "open it as localhost, let the server listen on the address that others use, or tell it the host name of its proxy",
        ));
    }
    Ok(())
}

/// A host without its port.
fn without_port(host: &str) -> &str {
    let is_port = |port: &str| port.bytes().all(|digit| digit.is_ascii_digit());
    match host.rsplit_once(':') {
        Some((name, port)) if is_port(port) && !name.ends_with(':') => name,
        _ => host,
    }
}

/// Whether a host without a port is a loopback name or address.
fn is_loopback(name: &str) -> bool {
    let address = name.strip_prefix('[').and_then(|name| name.strip_suffix(']')).unwrap_or(name);
    name.eq_ignore_ascii_case("localhost")
        || address.parse().is_ok_and(|address: IpAddr| address.is_loopback())
}
