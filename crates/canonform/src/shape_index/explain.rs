//! How a query and a shape of an index are related, what its components are, and of what it is a component.

use base::Budget;
use descriptors::{ShapeDistance, ShapeMetric};
use index::ShapeEntry;

use super::components::described;
use super::found::{ComponentResult, SearchResult, ShardMatch};
use super::options::{SearchOptions, SearchRank};
use super::predict::Completeness;
use super::query::KnownQuery;
use super::record::{COMPONENTS, OTHER_COMPONENTS};
use super::search::ShapeSearch;
use super::source::read_unchanged;
use crate::error::Error;
use crate::form::{DescribeOptions, ShapeDescription};
use relations::{MeshGeometry, Relation, RelationKind};

/// Most different components of a query that are searched for, the largest by area.
const MOST_SEARCHED: usize = 12;

/// Most shapes of which a query is named as a component.
const MOST_WHOLES: usize = 10;

/// A component of a query.
pub(super) struct QueryComponent<'a> {
    /// Its place among the different components.
    pub(super) place: usize,
    pub(super) geometry: &'a MeshGeometry,
    pub(super) description: ShapeDescription,
    /// What it is called.
    pub(super) name: String,
    /// What is said of it, without a shape.
    pub(super) found: ComponentResult,
}

/// The different components of a query that has several, largest first. One that cannot be described is left out.
pub(super) fn components<'a>(
    whole: &'a MeshGeometry,
    name: &str,
    options: &DescribeOptions,
    budget: &Budget,
) -> Result<Vec<QueryComponent<'a>>, Error> {
    let mut found = Vec::new();
    for (place, (geometry, copies)) in
        whole.different_components().into_iter().take(MOST_SEARCHED).enumerate()
    {
        budget.check()?;
        let Some(description) = described(geometry, options, budget)? else { continue };
        let name = match copies {
            1 => format!("a component of {name}"),
            _ => format!("each of {copies} components of {name}"),
        };
        let area_share = (geometry.size() / whole.size()).powi(2);
        let about = ComponentResult { copies, area_share, n_vertices: geometry.n_vertices(), nearest: None };
        found.push(QueryComponent { place, geometry, description, name, found: about });
    }
    Ok(found)
}

impl ShapeSearch {
    /// How a query and a shape are related, once their files and meshes are known, too: as [`compare_meshes`](crate::compare_meshes)
    /// says. The file of the shape is read again if it is unchanged; otherwise the relation is
    /// [by descriptions](crate::Basis::Descriptions).
    pub(super) fn related(
        &self,
        query: &KnownQuery<'_>,
        id: &str,
        by_distance: Relation,
    ) -> Result<Relation, Error> {
        let entry = self.index().entry(id)?;
        let known = by_distance.by_files([query.content, Some(entry.content)]);
        let wanted = query.geometry.filter(|_| known.kind != RelationKind::IdenticalFile);
        let pair = wanted.and_then(|a| Some((a, self.geometry(id, &entry)?)));
        Ok(match &pair {
            Some((a, b)) => known.by_meshes([a, b]),
            None => known,
        })
    }

    /// The mesh of a shape in space, if its file can be read and is unchanged.
    pub(super) fn geometry(&self, id: &str, entry: &ShapeEntry) -> Option<MeshGeometry> {
        let mesh = read_unchanged(self.index().path(), id, entry).ok()?;
        MeshGeometry::new(&mesh, Some(entry.content))
    }

    /// Searches for each different component of a query that has several.
    pub(super) fn search_components(
        &self,
        query: &KnownQuery<'_>,
        options: &SearchOptions,
        budget: &Budget,
    ) -> Result<Vec<ComponentResult>, Error> {
        let Some(whole) = query.geometry else { return Ok(Vec::new()) };
        // The nearest one is wanted.
        let options = SearchOptions { k: 1, rank_by: SearchRank::Plain, ..options.clone() };
        let mut found = Vec::new();
        for part in components(whole, query.name, self.describe_options(), budget)? {
            let known = KnownQuery {
                shape: part.description.prepare()?,
                form_spectrum: part.description.form_spectrum(),
                name: &part.name,
                content: None,
                geometry: Some(part.geometry),
                part: None,
                complete: Completeness::default(),
            };
            let nearest = self.nearest(&known, &options, budget)?.results.into_iter().next();
            found.push(ComponentResult { nearest, ..part.found });
        }
        Ok(found)
    }

    /// The shapes with a component, not the largest, that is the query: nearest first.
    pub(super) fn search_wholes(
        &self,
        query: &KnownQuery<'_>,
        budget: &Budget,
    ) -> Result<Vec<SearchResult>, Error> {
        let asked = ShapeMetric::without_size(query.shape.fused());
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
        let mut wholes: Vec<SearchResult> = Vec::new();
        for (distance, id) in near {
            budget.check()?;
            if wholes.len() == MOST_WHOLES || wholes.iter().any(|known| known.id == id) {
                continue;
            }
            let entry = self.index().entry(id)?;
            let n_components = entry.fact(COMPONENTS).unwrap_or(2.0) as usize;
            let found = ShardMatch {
                id: id.to_owned(),
                label: entry.label,
                path: entry.path,
                distance: distance.combined,
                fused: distance.fused,
                shape_distance: distance,
                scale: 1.0,
                order: None,
            };
            let found = found.into_result(wholes.len() + 1, query.name);
            let relation = self.related(query, id, found.relation)?.to_component(n_components);
            wholes.push(SearchResult { relation, ..found });
        }
        Ok(wholes)
    }

    /// The shape and the fused vector of every component, but the largest of each shape; read once.
    fn stored_components(&self) -> Result<&[(String, Vec<f32>)], Error> {
        if let Some(known) = self.components.get() {
            return Ok(known);
        }
        let mut stored = Vec::new();
        for (id, entry) in self.index().entries()? {
            if entry.fact(OTHER_COMPONENTS).is_some() {
                let components = self.index().vectors(&id)?.components;
                stored.extend(components.into_iter().map(|fused| (id.clone(), fused)));
            }
        }
        Ok(self.components.get_or_init(|| stored))
    }
}
