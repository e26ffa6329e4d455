//! Middleware of every request: checks of host and origin, security headers, panics.

use std::net::IpAddr;
use std::panic::AssertUnwindSafe;
use std::sync::Arc;

use axum::extract::{Request, State};
use axum::http::{HeaderMap, HeaderName, HeaderValue, Method, StatusCode, Uri, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use futures_util::FutureExt;

use crate::app::App;
use crate::connection::pace_of;
use crate::error::ApiError;
use crate::pace::Phase;

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

/// Rejects requests for other servers, turns panics into responses, and adds the headers.
pub(crate) async fn guard(State(app): State<Arc<App>>, request: Request, next: Next) -> Response {
    let pace = pace_of(&request);
    let begin = |phase| pace.iter().for_each(|pace| pace.begin(phase));
    begin(Phase::Working);
    let mut response = match check(&app, request.method(), request.uri(), request.headers()) {
        Ok(()) => {
            let answer = AssertUnwindSafe(next.run(request)).catch_unwind().await;
            answer.unwrap_or_else(|_| ApiError::internal().into_response())
        }
        Err(refused) => refused.into_response(),
    };
    begin(Phase::Waiting);
    let headers = response.headers_mut();
    for (name, value) in HEADERS {
        headers.insert(name, HeaderValue::from_static(value));
    }
    // No cache keeps responses, except for images and scripts, which have their own header.
    headers.entry(header::CACHE_CONTROL).or_insert(HeaderValue::from_static("no-store"));
    response
}

fn check(app: &App, method: &Method, uri: &Uri, headers: &HeaderMap) -> Result<(), ApiError> {
    // With several values, another program on the way may read another one.
    let single = |name: HeaderName| {
        let mut values = headers.get_all(&name).iter();
        let value = values.next().and_then(|value| value.to_str().ok());
        match values.next() {
            Some(_) => Err(ApiError::bad_request(format!("the request has several `{name}` headers"))),
            None => Ok(value),
        }
    };
    let host = single(header::HOST)?;
    let host = host.ok_or_else(|| ApiError::bad_request("the request has no Host header"))?;
    if uri.authority().is_some_and(|authority| authority.as_str() != host) {
        return Err(ApiError::bad_request("the address of the request and its Host header differ"));
    }
    // A page elsewhere can resolve its own name to this machine (DNS rebinding), but not change the Host header.
    if app.options.listen.ip().is_loopback() && !is_loopback(host) {
        let error = format!("this server is not `{}`", host.chars().take(100).collect::<String>());
        return Err(ApiError::new(StatusCode::MISDIRECTED_REQUEST, error)
            .with_remedy("open it as localhost, or let the server listen on the address that others use"));
    }
    let origin = single(header::ORIGIN)?;
    let foreign = origin.is_some_and(|origin| origin.strip_prefix("http://") != Some(host));
    if foreign && method != Method::GET && method != Method::HEAD {
        return Err(ApiError::new(StatusCode::FORBIDDEN, "cross-origin requests are not allowed"));
    }
    Ok(())
}

/// Whether a host, with or without a port, is a loopback name or address.
fn is_loopback(host: &str) -> bool {
    let is_port = |port: &str| port.bytes().all(|digit| digit.is_ascii_digit());
    let name = match host.rsplit_once(':') {
        Some((name, port)) if is_port(port) && !name.ends_with(':') => name,
        _ => host,
    };
    let address = name.strip_prefix('[').and_then(|name| name.strip_suffix(']')).unwrap_or(name);
    name.eq_ignore_ascii_case("localhost")
        || address.parse().is_ok_and(|address: IpAddr| address.is_loopback())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_loopback_names_and_addresses_pass() {
        for host in
            ["localhost", "LOCALHOST:7878", "127.0.0.1", "127.0.0.1:1", "127.1.2.3:80", "[::1]:7878", "[::1]"]
        {
            assert!(is_loopback(host), "{host}");
        }
        for host in [
            "",
            ":80",
            "example.com",
            "localhost.example.com",
            "127.0.0.1.example.com:80",
            "10.0.0.1",
            "[::2]:1",
        ] {
            assert!(!is_loopback(host), "{host}");
        }
    }
}
