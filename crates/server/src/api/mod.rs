//! The JSON interface, described by `openapi.json`.

mod answer;
mod compare;
mod csv;
mod duplicates;
mod matching;
mod search;
mod shapes;

use std::sync::{Arc, LazyLock};

use axum::Router;
use axum::extract::State;
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::routing::{MethodRouter, get, post};
use base::object;

use self::answer::json;
use crate::app::App;
use crate::error::ApiError;
use crate::formats::filled_in;

pub(crate) use answer::{is_known, tag, tagged};

/// The description of the interface.
static OPENAPI: LazyLock<String> = LazyLock::new(|| filled_in(include_str!("../../openapi.json")));

/// A route: its method as in the description, its path, and its handler.
type Route = (&'static str, &'static str, MethodRouter<Arc<App>>);

fn routes() -> Vec<Route> {
    vec![
        ("get", "/api/search", get(search::search_again)),
        ("post", "/api/search", post(search::search)),
        ("get", "/api/shapes", get(shapes::list)),
        ("get", "/api/shapes/{id}/mesh", get(shapes::mesh)),
        ("get", "/api/shapes/{id}/form", get(shapes::form)),
        ("get", "/api/shapes/{id}/file", get(shapes::file)),
        ("get", "/api/shapes/{id}/thumbnail", get(shapes::thumbnail)),
        ("get", "/api/compare", get(compare::compare)),
        ("get", "/api/match", get(matching::matching)),
        ("get", "/api/duplicates", get(duplicates::duplicates)),
        ("get", "/api/openapi.json", get(openapi)),
        ("get", "/healthz", get(health)),
    ]
}

pub(crate) fn router() -> Router<Arc<App>> {
    let all =
        routes().into_iter().fold(Router::new(), |router, (_, path, answers)| router.route(path, answers));
    all.fallback(not_found).method_not_allowed_fallback(wrong_method)
}

async fn openapi() -> impl IntoResponse {
    ([(header::CONTENT_TYPE, "application/json")], OPENAPI.as_str())
}

async fn not_found() -> ApiError {
    ApiError::new(StatusCode::NOT_FOUND, "not found")
        .with_remedy("see /api/openapi.json for all paths and methods")
}

async fn wrong_method() -> ApiError {
    ApiError::new(StatusCode::METHOD_NOT_ALLOWED, "method not allowed")
        .with_remedy("see /api/openapi.json for all paths and methods")
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

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn the_description_lists_exactly_the_routes() {
        let description: serde_json::Value = serde_json::from_str(&OPENAPI).unwrap();
        let mut described = BTreeSet::new();
        for (path, methods) in description["paths"].as_object().unwrap() {
            for method in methods.as_object().unwrap().keys().filter(|name| *name != "parameters") {
                described.insert((method.clone(), path.clone()));
            }
        }
        let routes = routes().into_iter().map(|(method, path, _)| (method.to_owned(), path.to_owned()));
        assert_eq!(routes.collect::<BTreeSet<_>>(), described);
    }
}
