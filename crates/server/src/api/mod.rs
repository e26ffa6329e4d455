//! The JSON interface, described by `openapi.json`.

mod answer;
mod compare;
mod csv;
mod matching;
mod search;
mod shapes;

use std::sync::{Arc, LazyLock};

use axum::Router;
use axum::extract::State;
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use base::object;

use self::answer::json;
use self::compare::answered;
use crate::app::App;
use crate::cost;
use crate::error::ApiError;
use crate::formats::filled_in;

pub(crate) use answer::{is_known, tag, tagged};

/// The description of the interface.
static OPENAPI: LazyLock<String> = LazyLock::new(|| filled_in(include_str!("../../openapi.json")));

/// The routes, as the description lists them.
pub(crate) fn router() -> Router<Arc<App>> {
    let compare = |app, params| answered(app, params, cost::COMPARED_VERTEX, compare::compare);
    let matching = |app, params| answered(app, params, cost::MATCHED_VERTEX, matching::matching);
    Router::new()
        .route("/api/search", get(search::search_again).post(search::search))
        .route("/api/shapes", get(shapes::list))
        .route("/api/shapes/{id}/mesh", get(shapes::mesh))
        .route("/api/shapes/{id}/form", get(shapes::form))
        .route("/api/shapes/{id}/file", get(shapes::file))
        .route("/api/shapes/{id}/thumbnail", get(shapes::thumbnail))
        .route("/api/compare", get(compare))
        .route("/api/match", get(matching))
        .route("/api/duplicates", get(duplicates))
        .route("/api/openapi.json", get(openapi))
        .route("/healthz", get(health))
        .fallback(|| async { no_route(StatusCode::NOT_FOUND, "not found") })
        .method_not_allowed_fallback(|| async {
            no_route(StatusCode::METHOD_NOT_ALLOWED, "method not allowed")
        })
}

async fn openapi() -> impl IntoResponse {
    ([(header::CONTENT_TYPE, "application/json")], OPENAPI.as_str())
}

fn no_route(status: StatusCode, error: &str) -> ApiError {
    ApiError::new(status, error).with_remedy("see /api/openapi.json for all paths and methods")
}

/// The duplicates of the index, or how far the search for them is.
async fn duplicates(State(app): State<Arc<App>>) -> Result<Response, ApiError> {
    app.duplicates.ask(&app.served.collection())
}

/// Status, size of the index, and limits.
async fn health(State(app): State<Arc<App>>) -> Result<Response, ApiError> {
    let collection = app.served.collection();
    json(&object! {
        status: "ok",
        version: env!("CARGO_PKG_VERSION"),
        shapes: collection.shapes.len(),
        index: object! {
            // Changes with the content of the index in service.
            version: &collection.version,
            // Whether that is the content of its file.
            state: app.served.state(),
        },
        max_upload: app.options.max_upload,
        max_vertices: app.options.max_vertices,
    })
}
