//! How a query and a shape of an index are related, what its components are, and of what it is a component.

use base::{Budget, Observer};
use descriptors::{ShapeDistance, ShapeMetric};
use index::Entry;

use super::found::{ComponentResult, Hit};
use super::options::{SearchOptions, SearchRank};
use super::query::Query;
use super::search::{Asked, ShapeSearch};
use super::source::read_unchanged;
use crate::error::Error;
use relations::{MeshGeometry, Relation, RelationKind};
use rigid::Handedness;

/// Most shapes of which a query is named as a component.
const MOST_WHOLES: usize = 10;

impl ShapeSearch {
    /// How a query and a shape are related, once their files and meshes are known, too: as [`compare_meshes`](crate::compare::compare_meshes)
    /// says. The file of the shape is read again if it is unchanged; otherwise the relation is
    /// [by descriptions](crate::relations::Basis::Descriptions).
    pub(super) fn related(
        &self,
        query: &Query,
        entry: &Entry,
        by_distance: Relation,
    ) -> Result<Relation, Error> {
        let known = by_distance.by_files([query.content, Some(entry.content)]);
        let wanted = query.geometry.as_deref().filter(|_| known.kind != RelationKind::IdenticalFile);
        let pair = wanted.and_then(|a| Some((a, self.geometry(entry)?)));
        Ok(match &pair {
            Some((a, b)) => known.by_meshes([a, b]),
            None => known,
        })
    }

    /// The mesh of a shape in space, if its file can be read and is unchanged.
    pub(super) fn geometry(&self, entry: &Entry) -> Option<MeshGeometry> {
        let mesh = read_unchanged(&self.index().path, entry).ok()?;
        MeshGeometry::new(&mesh, Some(entry.content))
    }

    /// Searches for each different component of a query that has several.
    pub(super) fn search_components(
        &self,
        query: &Query,
        options: &SearchOptions,
        observer: &dyn Observer,
    ) -> Result<Vec<ComponentResult>, Error> {
        // The nearest one is wanted.
        let options = SearchOptions { k: 1, rank_by: SearchRank::Plain, ..options.clone() };
        let parts = query.components(observer)?.into_iter();
        let found = parts.map(|(about, part)| {
            let answer = self.search_among(&part, None, &options, observer)?;
            Ok(ComponentResult { nearest: answer.results.into_iter().next(), ..about })
        });
        found.collect()
    }

    /// The shapes with a component, not the largest, that is the query: nearest first.
    pub(super) fn search_wholes(
        &self,
        Asked { query, shape, .. }: &Asked<'_>,
        budget: &Budget,
    ) -> Result<Vec<Hit>, Error> {
        let asked = ShapeMetric::without_size(&shape.fused);
        // Components have no forms in the index, so signatures decide.
        let distance = |fused: &[f32]| {
            let known = ShapeMetric::without_size(fused);
            let combined = ShapeMetric::robust(asked, known);
            ShapeDistance { fused: ShapeMetric::fused(asked, known), combined }
        };
        let stored = self.stored_components()?.iter();
        let mut near: Vec<(ShapeDistance, &str)> = stored
            .map(|(id, fused)| (distance(fused), id.as_str()))
            .filter(|(distance, _)| distance.combined < ShapeMetric::SAME_SHAPE.at)
            .collect();
        near.sort_by(|x, y| x.0.combined.total_cmp(&y.0.combined).then(x.1.cmp(y.1)));
        let mut wholes: Vec<Hit> = Vec::new();
        for (distances, id) in near {
            budget.check()?;
            if wholes.len() == MOST_WHOLES || wholes.iter().any(|known| known.id == id) {
                continue;
            }
            let entry = self.index().entry(id)?;
            let by_distance =
                Relation::by_distance(distances, 1.0, Handedness::Unknown).named(&query.name, id);
            let relation = self.related(query, &entry, by_distance)?;
            let Entry { id, label, path, facts, .. } = entry;
            let ShapeDistance { fused, combined: distance } = distances;
            let relation = relation.to_component(facts.components as usize);
            let (rank, itself, order, comparison) = (wholes.len() + 1, false, None, None);
            wholes.push(Hit { rank, id, label, itself, path, distance, fused, order, relation, comparison });
        }
        Ok(wholes)
    }

    /// The shape and the fused vector of every component, but the largest of each shape; read once.
    fn stored_components(&self) -> Result<&[(String, Vec<f32>)], Error> {
        if let Some(known) = self.components.get() {
            return Ok(known);
        }
        let stored = self.index().components()?;
        Ok(self.components.get_or_init(|| stored))
    }
}
