//! The shapes of the index: their list, meshes, forms and pictures.

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

/// Shapes of one page of the list.
const MOST_LISTED: usize = 500;

/// Pixels of a thumbnail, either way.
const THUMBNAIL: u32 = 176;

/// Counts changes of how thumbnails are drawn.
const DRAWING: u32 = 1;

/// Which shapes are listed.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ListParams {
    #[serde(default)]
    offset: usize,
    #[serde(default = "usual_limit")]
    limit: usize,
    /// Part of a name or a label, in any case.
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
        let error = format!("limit is {}; it goes from 1 to {MOST_LISTED}", params.limit);
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

/// The mesh of a shape, as it was repaired.
pub(super) async fn mesh(State(app): State<Arc<App>>, Id(id): Id) -> Result<Written, ApiError> {
    let shared = app.clone();
    app.work.run(None, move || Written::new(&shared.indexed(&id)?.mesh())).await
}

/// The form of a shape: as a surface, or as the points in the index where its mesh is gone.
pub(super) async fn form(State(app): State<Arc<App>>, Id(id): Id) -> Result<Written, ApiError> {
    let shared = app.clone();
    app.work.run(None, move || Written::new(&form_of(&shared, &id)?)).await
}

pub(super) fn form_of(app: &App, id: &str) -> Result<Geometry, Error> {
    match app.indexed(id) {
        Ok(measured) => Ok(measured.form()),
        Err(fault) if is_missing(&fault) => Ok(Geometry::new(&dots(app.search.prepared(id)?.form()))),
        Err(fault) => Err(fault),
    }
}

/// Whether a shape is known but its mesh is not what it was.
pub(super) fn is_missing(fault: &Error) -> bool {
    matches!(fault, Error::MeshGone { .. } | Error::MeshChanged { .. })
}

/// A picture of a shape: of its mesh, or of the points of its form where that is gone.
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
            // Under another tag, and not kept: the mesh may come back.
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
    render(mesh, &options).to_png().map(Bytes::from).map_err(|_| ApiError::fault())
}
