//! Corresponding points of two shapes.

use std::sync::Arc;

use axum::extract::State;
use canonform::{Budget, CorrespondOptions, MappedSurface, VertexMap, correspond};
use report::viewer::Geometry;
use serde::Serialize;

use super::answer::{Params, Written};
use super::compare::CompareParams;
use crate::app::{App, Query};

use crate::collection::Collection;
use crate::error::ApiError;
use crate::measured::Measured;

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

/// The first shape.
enum First {
    Query(Arc<Query>),
    Shape(String, Arc<Measured>),
}

impl First {
    fn name(&self) -> &str {
        match self {
            Self::Query(query) => &query.name,
            Self::Shape(id, _) => id,
        }
    }

    fn measured(&self) -> &Measured {
        match self {
            Self::Query(query) => &query.measured,
            Self::Shape(_, measured) => measured,
        }
    }
}

pub(super) async fn matching(
    State(app): State<Arc<App>>,
    Params(params): Params<CompareParams>,
) -> Result<Written, ApiError> {
    let (shared, collection) = (app.clone(), app.served.collection());
    let cost = params.cost(&app, &collection);
    let job = move |budget: &Budget| Written::new(&answer(&shared, &collection, params, budget)?);
    app.work.run(cost, None, job).await
}

fn answer(
    app: &App,
    collection: &Collection,
    params: CompareParams,
    budget: &Budget,
) -> Result<Answer, ApiError> {
    let a = match (params.query, params.a) {
        (Some(query), None) => First::Query(app.query(collection, &query)?),
        (None, Some(id)) => {
            let measured = app.indexed(collection, &id, budget)?;
            First::Shape(id, measured)
        }
        _ => return Err(CompareParams::not_two()),
    };
    let b = app.indexed(collection, &params.b, budget)?;
    let options = CorrespondOptions::default();
    let [from, to] = [a.measured(), &b].map(|side| MappedSurface::new(&side.surface, &options, budget));
    let maps = correspond(&from?, &to?, &options, budget)?.maps;
    let carried = maps.first().map_or_else(|| a.measured().mesh(), |map| a.measured().carried(&b, map));
    Ok(Answer { a: a.name().to_owned(), maps, meshes: [carried, b.mesh()], b: params.b })
}
