//! The duplicates of the index.

use std::sync::Arc;

use axum::Json;
use axum::extract::State;
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};

use crate::app::App;
use crate::duplicates::Known;
use crate::error::ApiError;

/// Seconds after which a client may ask again.
const AGAIN: &str = "1";

pub(super) async fn duplicates(State(app): State<Arc<App>>) -> Result<Response, ApiError> {
    Ok(match app.duplicates.ask(&app.served.collection())? {
        Known::Report(report) => ([(header::CONTENT_TYPE, "application/json")], report).into_response(),
        Known::Progress(progress) => {
            (StatusCode::ACCEPTED, [(header::RETRY_AFTER, AGAIN)], Json(progress)).into_response()
        }
    })
}
