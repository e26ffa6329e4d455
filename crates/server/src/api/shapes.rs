//! The shapes of the index: list, meshes, forms and thumbnails.

use std::sync::Arc;

use axum::body::Bytes;
use axum::extract::State;
use axum::http::{HeaderMap, header};
use axum::response::{IntoResponse, Response};
use base::object;
use canonform::index::{Entry, Facts};
use canonform::mesh::TriMesh;
use canonform::{Budget, Error};
use report::render::{Background, RenderOptions, View, render};
use report::viewer::Geometry;
use serde::Deserialize;

use super::answer::{Id, Params, is_known, json, tag, tagged};
use crate::app::App;
use crate::collection::Collection;
use crate::cost;
use crate::error::ApiError;
use crate::measured::dots;

/// Maximum number of shapes on one page of the list.
const MOST_LISTED: usize = 500;

/// Width and height of a thumbnail in pixels.
const THUMBNAIL: u32 = 176;

/// Version of the thumbnails, for their tags.
const DRAWING: u32 = 1;

/// Which shapes to list.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ListParams {
    #[serde(default)]
    offset: usize,
    limit: Option<usize>,
    /// Part of a name or a label; case does not matter.
    #[serde(default)]
    q: String,
    label: Option<String>,
}

pub(super) async fn list(
    State(app): State<Arc<App>>,
    Params(params): Params<ListParams>,
) -> Result<Response, ApiError> {
    let limit = params.limit.unwrap_or(50);
    if !(1..=MOST_LISTED).contains(&limit) {
        let error = format!("limit is {limit}; use 1 to {MOST_LISTED}");
        return Err(ApiError::bad_request(error));
    }
    let collection = app.served.collection();
    let part = params.q.to_lowercase();
    let is_meant = |shape: &&Entry| {
        params.label.as_ref().is_none_or(|label| *label == shape.label)
            && (shape.id.to_lowercase().contains(&part) || shape.label.to_lowercase().contains(&part))
    };
    let found: Vec<&Entry> = collection.shapes.iter().filter(is_meant).collect();
    let shapes = found.iter().skip(params.offset).take(limit).map(|shape| {
        let Facts { vertices, faces, area, diameter, .. } = shape.facts;
        object! { id: &shape.id, label: &shape.label, vertices, faces, area, diameter }
    });
    json(&object! { total: found.len(), offset: params.offset, shapes: shapes.collect::<Vec<_>>() })
}

/// The repaired mesh of a shape.
pub(super) async fn mesh(State(app): State<Arc<App>>, Id(id): Id) -> Result<Response, ApiError> {
    let (shared, collection) = (app.clone(), app.served.collection());
    let cost = app.cost(&collection, &id);
    let mesh = move |budget: &Budget| json(&shared.indexed(&collection, &id, budget)?.mesh());
    app.work.run(cost, None, mesh).await
}

/// The form of a shape: a surface, or the points stored in the index if its mesh is missing.
pub(super) async fn form(State(app): State<Arc<App>>, Id(id): Id) -> Result<Response, ApiError> {
    let (shared, collection) = (app.clone(), app.served.collection());
    let cost = app.cost(&collection, &id);
    let form = move |budget: &Budget| match shared.indexed(&collection, &id, budget) {
        Ok(measured) => json(&measured.form()),
        Err(fault) if is_missing(&fault) => json(&points(&collection, &id)?),
        Err(fault) => Err(fault.into()),
    };
    app.work.run(cost, None, form).await
}

/// The mesh file of a shape, as it was indexed.
pub(super) async fn file(State(app): State<Arc<App>>, Id(id): Id) -> Result<Response, ApiError> {
    let collection = app.served.collection();
    let cost = collection.n_vertices(&id) as f64 * cost::DRAWN_VERTEX;
    let read = move |_: &Budget| {
        let files = collection.search.files(&id)?;
        let (path, content) = files.into_iter().next().ok_or_else(ApiError::internal)?;
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let kind = (header::CONTENT_TYPE, "application/octet-stream".to_owned());
        // A name in UTF-8 (RFC 8187).
        let name = name.bytes().map(|byte| match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'.' | b'-' | b'_' => char::from(byte).to_string(),
            _ => format!("%{byte:02X}"),
        });
        let name = name.collect::<String>();
        let disposition = (header::CONTENT_DISPOSITION, format!("attachment; filename*=UTF-8''{name}"));
        Ok(([kind, disposition], content).into_response())
    };
    app.work.run(cost, None, read).await
}

/// The points of the form in the index, as dots.
pub(super) fn points(collection: &Collection, id: &str) -> Result<Geometry, Error> {
    Ok(Geometry::new(&dots(&collection.search.prepared(id)?.form)))
}

/// Whether the mesh of a shape is missing or has changed.
pub(super) fn is_missing(fault: &Error) -> bool {
    matches!(fault, Error::MeshGone { .. } | Error::MeshChanged { .. })
}

/// A picture of a shape: its mesh, or the points of its form if the mesh is missing.
pub(super) async fn thumbnail(
    State(app): State<Arc<App>>,
    Id(id): Id,
    headers: HeaderMap,
) -> Result<Response, ApiError> {
    const PNG: &str = "image/png";
    let (shared, collection) = (app.clone(), app.served.collection());
    // A known picture needs no job. Shapes that do not exist get their error from the job.
    let content = collection.shape(&id).map(|shape| shape.content.to_string()).unwrap_or_default();
    let tag = tag(&format!("{content}-{DRAWING}"));
    if !content.is_empty() {
        if is_known(&headers, &tag) {
            return Ok(tagged(tag, PNG, None));
        }
        if let Some(picture) = app.thumbnails.get(&content) {
            return Ok(tagged(tag, PNG, Some(picture)));
        }
    }
    let cost = collection.n_vertices(&id) as f64 * cost::DRAWN_VERTEX;
    let drawing = move |budget: &Budget| match collection.search.mesh(&id) {
        Ok(mesh) => {
            let picture = draw(&mesh, View::default(), budget)?;
            shared.thumbnails.put(content, picture.clone(), picture.len());
            Ok(tagged(tag, PNG, Some(picture)))
        }
        // Under another tag, and not cached: the mesh may come back.
        Err(fault) if is_missing(&fault) => {
            let picture = draw(&dots(&collection.search.prepared(&id)?.form), View::Principal, budget)?;
            Ok(tagged(super::answer::tag("points"), PNG, Some(picture)))
        }
        Err(fault) => Err(fault.into()),
    };
    app.work.run(cost, None, drawing).await
}

fn draw(mesh: &TriMesh, view: View, budget: &Budget) -> Result<Bytes, ApiError> {
    let options = RenderOptions {
        width: THUMBNAIL,
        height: THUMBNAIL,
        background: Background::Transparent,
        view,
        ..RenderOptions::default()
    };
    let image = render(mesh, &options, budget).map_err(ApiError::exceeded)?;
    image.to_png().map(Bytes::from).map_err(|_| ApiError::internal())
}
