//! Who may ask for what, and the headers of every response.

use std::net::IpAddr;
use std::sync::Arc;

use axum::extract::{Request, State};
use axum::http::uri::Authority;
use axum::http::{HeaderMap, HeaderName, StatusCode, header};
use axum::middleware::Next;
use axum::response::Response;

use crate::app::App;
use crate::error::ApiError;
use crate::options::ServeOptions;

const SEC_FETCH_SITE: HeaderName = HeaderName::from_static("sec-fetch-site");

/// Headers of every response. Plotly inserts style rules and renders its drawings to images.
pub(crate) const HEADERS: [(HeaderName, &str); 5] = [
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

/// Refuses requests for other servers.
pub(crate) async fn refuse_other_hosts(
    State(app): State<Arc<App>>,
    request: Request,
    next: Next,
) -> Result<Response, ApiError> {
    let host = single(request.headers(), &header::HOST)?;
    let host = host.ok_or_else(|| ApiError::bad_request("the request has no Host header"))?;
    if request.uri().authority().is_some_and(|authority| authority.as_str() != host) {
        return Err(ApiError::bad_request("the address of the request and its Host header differ"));
    }
    // A page elsewhere can resolve its own name to this machine (DNS rebinding), but not change the Host header.
    let ServeOptions { listen, public_host, .. } = &app.options;
    let authority = host.parse::<Authority>().ok();
    let name = authority.as_ref().map_or("", Authority::host);
    let is_public = public_host.as_ref().is_some_and(|public| public.eq_ignore_ascii_case(name));
    if listen.ip().is_loopback() && !is_loopback(name) && !is_public {
        let error = format!("this server is not `{}`", host.chars().take(100).collect::<String>());
        return Err(ApiError::new(StatusCode::MISDIRECTED_REQUEST, error).with_remedy(
            "open it as localhost, let the server listen on the address that others use, or tell it the host name of its proxy",
        ));
    }
    Ok(next.run(request).await)
}

/// Whether a host without a port is a loopback name or address.
fn is_loopback(name: &str) -> bool {
    let address = name.strip_prefix('[').and_then(|name| name.strip_suffix(']')).unwrap_or(name);
    name.eq_ignore_ascii_case("localhost")
        || address.parse().is_ok_and(|address: IpAddr| address.is_loopback())
}
