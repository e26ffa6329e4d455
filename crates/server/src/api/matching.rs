//! Corresponding points of two shapes.

use std::sync::Arc;

use axum::extract::State;
use canonform::Budget;
use canonform::maps::{CorrespondOptions, MappedSurface, VertexMap, correspond};
use report::viewer::Geometry;
use serde::Serialize;

use super::answer::{Params, Written};
use super::compare::CompareParams;
use crate::app::App;
use crate::collection::Collection;
use crate::cost;
use crate::error::ApiError;

#[derive(Serialize)]
struct Answer {
    a: String,
    b: String,
    /// From the first mesh to the second, at most two of different kinds: the direct one first, unless it distorts distances
    /// clearly more.
    maps: Vec<VertexMap>,
    /// Both meshes; points that the first map joins have the same colour.
    meshes: [Geometry; 2],
}

pub(super) async fn matching(
    State(app): State<Arc<App>>,
    Params(params): Params<CompareParams>,
) -> Result<Written, ApiError> {
    params.answered(&app, cost::MATCHED_VERTEX, answer).await
}

fn answer(
    app: &App,
    collection: &Collection,
    params: CompareParams,
    budget: &Budget,
) -> Result<Answer, ApiError> {
    let (name, a) = match (params.query, params.a) {
        (Some(query), None) => {
            let query = app.query(collection, &query)?;
            (query.described.name.clone(), query.measured.clone())
        }
        (None, Some(id)) => {
            let measured = app.indexed(collection, &id, budget)?;
            (id, measured)
        }
        _ => return Err(CompareParams::not_two()),
    };
    let b = app.indexed(collection, &params.b, budget)?;
    let options = CorrespondOptions::default();
    let [from, to] = [&a, &b].map(|side| MappedSurface::new(&side.surface, &options, budget));
    let maps = correspond(&from?, &to?, &options, budget)?.maps;
    let carried = maps.first().map_or_else(|| a.mesh(), |map| a.carried(&b, map));
    Ok(Answer { a: name, maps, meshes: [carried, b.mesh()], b: params.b })
}
