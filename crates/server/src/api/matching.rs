//! Corresponding points of two shapes.

use base::object;
use canonform::Budget;
use canonform::maps::{CorrespondOptions, MappedSurface, correspond};
use serde::Serialize;

use super::compare::{CompareParams, ComparedShape};
use crate::app::App;
use crate::collection::Collection;
use crate::error::ApiError;

pub(super) fn matching(
    app: &App,
    collection: &Collection,
    params: CompareParams,
    budget: &Budget,
) -> Result<impl Serialize + use<>, ApiError> {
    let [ComparedShape { name, measured: a, .. }, ComparedShape { name: other, measured: b, .. }] =
        params.sides(app, collection, budget)?;
    let (a, b, options) = (a?, b?, CorrespondOptions::default());
    let [from, to] = [&a, &b].map(|side| MappedSurface::new(&side.surface, &options, budget));
    let maps = correspond(&from?, &to?, &options, budget)?.maps;
    let carried = maps.first().map_or_else(|| a.mesh(), |map| a.carried(&b, map));
    Ok(object! {
        a: name,
        b: other,
        // From the first mesh to the second, at most two of different kinds: the direct one first, unless it distorts
        // distances clearly more.
        maps,
        // Points that the first map joins have the same color.
        meshes: [carried, b.mesh()],
    })
}
