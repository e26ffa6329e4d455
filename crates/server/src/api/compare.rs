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
use crate::error::ApiError;
use crate::measured::{Measured, in_space, overlaid};

/// The two shapes: `query` or `a`, and `b`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CompareParams {
    /// The `query_id` of an upload.
    query: Option<String>,
    /// A shape of the index.
    a: Option<String>,
    /// A shape of the index.
    b: String,
}

impl CompareParams {
    /// Both shapes.
    pub(super) fn sides(
        self,
        app: &App,
        collection: &Collection,
        budget: &Budget,
    ) -> Result<[ComparedShape; 2], ApiError> {
        let of_shape = |name: String| -> Result<ComparedShape, Error> {
            let shape = collection.search.prepared(&name)?;
            let content = Some(collection.search.index().entry(&name)?.content);
            match app.indexed(collection, &name, budget) {
                Err(fault) if !is_missing(&fault) => Err(fault),
                measured => Ok(ComparedShape { name, shape, measured, content }),
            }
        };
        let a = match (self.query, self.a) {
            (Some(query), None) => {
                let query = app.query(collection, &query)?;
                let shape = collection.search.prepared_query(&query.described)?;
                let (name, content) = (query.described.name.clone(), query.described.content);
                ComparedShape { name, shape, measured: Ok(query.measured.clone()), content }
            }
            (None, Some(id)) => of_shape(id)?,
            _ => return Err(ApiError::bad_request("give either an upload with `query` or a shape with `a`")),
        };
        Ok([a, of_shape(self.b)?])
    }
}

/// One of the two shapes.
pub(super) struct ComparedShape {
    pub(super) name: String,
    shape: PreparedShape,
    /// An error if the mesh is missing.
    pub(super) measured: Result<Arc<Measured>, Error>,
    content: Option<ContentHash>,
}

impl ComparedShape {
    fn compared(&self) -> Compared<'_> {
        let (shape, measured) = (&self.shape, self.measured.as_deref().ok());
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

/// Answers about two shapes in a job, which costs `each` for every vertex once both meshes are measured.
pub(super) async fn answered<T: Serialize + 'static>(
    State(app): State<Arc<App>>,
    Params(params): Params<CompareParams>,
    each: f64,
    answer: fn(&App, &Collection, CompareParams, &Budget) -> Result<T, ApiError>,
) -> Result<Response, ApiError> {
    let (shared, collection) = (app.clone(), app.served.collection());
    let ids = params.a.iter().chain([&params.b]);
    let measuring: f64 = ids.clone().map(|id| app.cost(&collection, id)).sum();
    let uploaded = params.query.as_ref().and_then(|query| app.kept(&collection, query));
    let uploaded = uploaded.map_or(0, |query| query.n_vertices());
    let vertices = uploaded + ids.map(|id| collection.n_vertices(id)).sum::<u64>();
    let cost = measuring + vertices as f64 * each;
    let job = move |budget: &Budget| json(&answer(&shared, &collection, params, budget)?);
    app.work.run(cost, None, job).await
}

pub(super) fn compare(
    app: &App,
    collection: &Collection,
    params: CompareParams,
    budget: &Budget,
) -> Result<impl Serialize + use<>, ApiError> {
    let sides = params.sides(app, collection, budget)?;
    budget.check().map_err(ApiError::exceeded)?;
    let [of_a, of_b] = sides.each_ref().map(ComparedShape::compared);
    let dot = of_a.form.spread();
    let mut found = compare_meshes([of_a, of_b])?;
    let [a, b] = sides.each_ref().map(|side| &side.name);
    found.relation = found.relation.named(a, b);
    let forms = [0, 1].map(|i| overlaid(&found.overlay, i, sides[i].measured.as_deref().ok(), dot));
    budget.check().map_err(ApiError::exceeded)?;
    let laid = match (of_a.geometry, of_b.geometry) {
        (Some(a), Some(b)) => found.relation.overlay([a, b]),
        _ => None,
    };
    let meshes = laid.as_ref().map(in_space);
    let gap = laid.map(|laid| Residual::new(&laid.gaps.concat()));
    let residual = found.overlay.residual();
    Ok(object! {
        a: a.clone(),
        b: b.clone(),
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
