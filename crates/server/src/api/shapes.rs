//! The shapes of the index: list, meshes, forms and thumbnails.

use std::sync::Arc;

use axum::body::Bytes;
use axum::extract::State;
use axum::http::HeaderMap;
use axum::response::Response;
use canonform::Error;
use mesh::TriMesh;
use serde::{Deserialize, Serialize};
use view::interactive::Geometry;
use view::render::{Background, RenderOptions, View, render};

use super::answer::{Id, Params, Written, is_known, tag, tagged};
use crate::app::{App, ShapeSummary};
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
    #[serde(default = "usual_limit")]
    limit: usize,
    /// Part of a name or a label; case does not matter.
    #[serde(default)]
    q: String,
    label: Option<String>,
}

fn usual_limit() -> usize {
    50
}

#[derive(Serialize)]
struct List<'a> {
    total: usize,
    offset: usize,
    shapes: Vec<&'a ShapeSummary>,
}

pub(super) async fn list(
    State(app): State<Arc<App>>,
    Params(params): Params<ListParams>,
) -> Result<Written, ApiError> {
    if !(1..=MOST_LISTED).contains(&params.limit) {
        let error = format!("limit is {}; use 1 to {MOST_LISTED}", params.limit);
        return Err(ApiError::bad_request(error));
    }
    let part = params.q.to_lowercase();
    let is_meant = |shape: &&ShapeSummary| {
        params.label.as_ref().is_none_or(|label| *label == shape.label)
            && (shape.id.to_lowercase().contains(&part) || shape.label.to_lowercase().contains(&part))
    };
    let (mut total, mut shapes) = (0, Vec::new());
    for shape in app.shapes.iter().filter(is_meant) {
        if total >= params.offset && shapes.len() < params.limit {
            shapes.push(shape);
        }
        total += 1;
    }
    Written::new(&List { total, offset: params.offset, shapes })
}

/// The repaired mesh of a shape.
pub(super) async fn mesh(State(app): State<Arc<App>>, Id(id): Id) -> Result<Written, ApiError> {
    let shared = app.clone();
    app.work.run(None, move || Written::new(&shared.indexed(&id)?.mesh())).await
}

/// The form of a shape: a surface, or the points stored in the index if its mesh is missing.
pub(super) async fn form(State(app): State<Arc<App>>, Id(id): Id) -> Result<Written, ApiError> {
    let shared = app.clone();
    let form = move || match shared.indexed(&id) {
        Ok(measured) => Written::new(&measured.form()),
        Err(fault) if is_missing(&fault) => Written::new(&points(&shared, &id)?),
        Err(fault) => Err(fault.into()),
    };
    app.work.run(None, form).await
}

/// The points of the form in the index, as dots.
pub(super) fn points(app: &App, id: &str) -> Result<Geometry, Error> {
    Ok(Geometry::new(&dots(app.search.prepared(id)?.form())))
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
    let shared = app.clone();
    let drawing = move || {
        let tag =
            tag(&format!("{}-{DRAWING}", shared.search.index().entry(&id).map_err(Error::from)?.content));
        if is_known(&headers, &tag) {
            return Ok(tagged(tag, PNG, None));
        }
        if let Some(picture) = shared.thumbnails.get(&id) {
            return Ok(tagged(tag, PNG, Some(picture)));
        }
        match shared.search.mesh(&id) {
            Ok(mesh) => {
                let picture = draw(&mesh, View::default())?;
                shared.thumbnails.put(id, picture.clone(), picture.len());
                Ok(tagged(tag, PNG, Some(picture)))
            }
            // Under another tag, and not cached: the mesh may come back.
            Err(fault) if is_missing(&fault) => {
                let picture = draw(&dots(shared.search.prepared(&id)?.form()), View::Principal)?;
                Ok(tagged(super::answer::tag("points"), PNG, Some(picture)))
            }
            Err(fault) => Err(fault.into()),
        }
    };
    app.work.run(None, drawing).await
}

fn draw(mesh: &TriMesh, view: View) -> Result<Bytes, ApiError> {
    let options = RenderOptions {
        width: THUMBNAIL,
        height: THUMBNAIL,
        background: Background::Transparent,
        view,
        ..RenderOptions::default()
    };
    render(mesh, &options).to_png().map(Bytes::from).map_err(|_| ApiError::internal())
}
