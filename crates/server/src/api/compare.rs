//! Comparison of two shapes.

use std::sync::Arc;

use axum::extract::State;
use axum::response::Response;
use base::object;
use canonform::compare::{Compared, Residual, compare_meshes};
use canonform::descriptors::PreparedShape;
use canonform::{Budget, ContentHash, Error};
use serde::{Deserialize, Serialize};

use super::answer::{Params, json};
use super::shapes::is_missing;
use crate::app::App;
use crate::collection::Collection;
use crate::cost;
use crate::error::ApiError;
use crate::measured::{Measured, in_space, overlaid};

/// The two shapes: `query` or `a`, and `b`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CompareParams {
    /// The `query_id` of an upload.
    pub(super) query: Option<String>,
    /// A shape of the index.
    pub(super) a: Option<String>,
    /// A shape of the index.
    pub(super) b: String,
}

impl CompareParams {
    /// Answers in a job, which costs `each` for every vertex once both meshes are measured.
    pub(super) async fn answered<T: Serialize + 'static>(
        self,
        app: &Arc<App>,
        each: f64,
        answer: fn(&App, &Collection, Self, &Budget) -> Result<T, ApiError>,
    ) -> Result<Response, ApiError> {
        let (shared, collection) = (app.clone(), app.served.collection());
        let ids = self.a.iter().chain([&self.b]);
        let measuring: f64 = ids.clone().map(|id| app.cost(&collection, id)).sum();
        let uploaded = self.query.as_ref().and_then(|query| app.kept(&collection, query));
        let uploaded = uploaded.map_or(0, |query| query.n_vertices());
        let vertices = uploaded + ids.map(|id| collection.n_vertices(id)).sum::<u64>();
        let cost = measuring + vertices as f64 * each;
        let job = move |budget: &Budget| json(&answer(&shared, &collection, self, budget)?);
        app.work.run(cost, None, job).await
    }

    /// The error that there is no first shape, or two of them.
    pub(super) fn not_two() -> ApiError {
        ApiError::bad_request("give either an upload with `query` or a shape with `a`")
    }
}

/// One of the two shapes.
struct ComparedShape {
    shape: PreparedShape,
    /// None if the mesh is missing.
    measured: Option<Arc<Measured>>,
    content: Option<ContentHash>,
}

impl ComparedShape {
    fn of_shape(app: &App, collection: &Collection, id: &str, budget: &Budget) -> Result<Self, Error> {
        let shape = collection.search.prepared(id)?;
        let content = Some(collection.search.index().entry(id)?.content);
        match app.indexed(collection, id, budget) {
            Err(fault) if !is_missing(&fault) => Err(fault),
            measured => Ok(Self { shape, measured: measured.ok(), content }),
        }
    }

    fn compared(&self) -> Compared<'_> {
        let (shape, measured) = (&self.shape, self.measured.as_deref());
        Compared {
            shape,
            reference: shape,
            form: measured.map_or(&shape.form, |measured| &measured.form),
            surface: measured.map(|measured| &measured.surface),
            geometry: measured.and_then(|measured| measured.geometry.as_deref()),
            content: self.content,
        }
    }
}

pub(super) async fn compare(
    State(app): State<Arc<App>>,
    Params(params): Params<CompareParams>,
) -> Result<Response, ApiError> {
    params.answered(&app, cost::COMPARED_VERTEX, answer).await
}

fn answer(
    app: &App,
    collection: &Collection,
    params: CompareParams,
    budget: &Budget,
) -> Result<impl Serialize + use<>, ApiError> {
    let (name, a) = match (params.query, params.a) {
        (Some(query), None) => {
            let query = app.query(collection, &query)?;
            let shape = collection.search.prepared_query(&query.described)?;
            let (measured, content) = (Some(query.measured.clone()), query.described.content);
            (query.described.name.clone(), ComparedShape { shape, measured, content })
        }
        (None, Some(id)) => {
            let side = ComparedShape::of_shape(app, collection, &id, budget)?;
            (id, side)
        }
        _ => return Err(CompareParams::not_two()),
    };
    let b = ComparedShape::of_shape(app, collection, &params.b, budget)?;
    budget.check().map_err(ApiError::exceeded)?;
    let [of_a, of_b] = [a.compared(), b.compared()];
    let dot = of_a.form.spread();
    let mut found = compare_meshes([of_a, of_b])?;
    found.relation = found.relation.named(&name, &params.b);
    let form = |i, side: &ComparedShape| overlaid(&found.overlay, i, side.measured.as_deref(), dot);
    let forms = [form(0, &a), form(1, &b)];
    budget.check().map_err(ApiError::exceeded)?;
    let laid = match (of_a.geometry, of_b.geometry) {
        (Some(a), Some(b)) => found.relation.overlay([a, b]),
        _ => None,
    };
    let meshes = laid.as_ref().map(in_space);
    let gap = laid.map(|laid| Residual::new(&laid.gaps.concat()));
    let residual = found.overlay.residual();
    Ok(object! {
        a: name,
        b: params.b,
        #[serde(flatten)]
        found,
        // Of either form from the other, in units of the first mesh.
        residual,
        // Both forms after alignment, colored by the distance of each point from the other form.
        forms,
        // Both meshes after alignment in space, colored by the distance of each vertex from the other mesh, if they are
        // alike as rigid bodies.
        meshes,
        // How far the meshes are apart, in units of the first.
        gap,
    })
}
