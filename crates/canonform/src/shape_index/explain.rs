//! What kind of match a query and a shape of an index are, what its components are, and of what it is a component.

use budget::Budget;
use descriptors::{Handedness, PreparedShape, ShapeDistance, ShapeMetric, Verdict, VerdictKind};
use index::ShapeEntry;

use super::components::described;
use super::found::{ComponentResult, SearchResult, StoredComponent};
use super::predict::Completeness;
use super::record::{COMPONENTS, OTHER_COMPONENTS, components};
use super::search::{Query, SearchOptions, SearchRank, ShapeSearch};
use super::source::read_unchanged;
use crate::compare::{MatchEvidence, MeshGeometry};
use crate::error::Error;

/// Most different components of a query that are searched for, the largest by area.
const MOST_SEARCHED: usize = 12;

/// Most shapes of which a query is named as a component.
const MOST_WHOLES: usize = 10;

impl ShapeSearch {
    /// The evidence on a query and a shape with this verdict. The file of the shape is read again if it is unchanged; otherwise
    /// the evidence is [by descriptions](crate::Basis::Descriptions). Files of shapes that are firmly different are read only if
    /// one of the two has several components, and may be part of the other.
    pub(super) fn evidence(
        &self,
        query: &Query<'_>,
        id: &str,
        verdict: Verdict,
    ) -> Result<MatchEvidence, Error> {
        let entry = self.index().entry(id)?;
        let content = [query.content, Some(entry.content)];
        let described = MatchEvidence::of_shapes(content, verdict);
        let is_file = query.content == Some(entry.content);
        let several = |geometry: &MeshGeometry| {
            geometry.n_components() > 1 || entry.fact(COMPONENTS).is_some_and(|n| n > 1.0)
        };
        let wanted = |geometry: &&MeshGeometry| {
            !is_file && (verdict.kind != VerdictKind::Different || several(geometry))
        };
        let pair = query.geometry.filter(wanted).and_then(|a| Some((a, self.geometry(id, &entry)?)));
        let evidence = match &pair {
            Some((a, b)) => MatchEvidence::new([a, b], verdict),
            None => described,
        };
        Ok(evidence.named(query.name, id))
    }

    /// The mesh of a shape in space, if its file can be read and is unchanged.
    pub(super) fn geometry(&self, id: &str, entry: &ShapeEntry) -> Option<MeshGeometry> {
        let mesh = read_unchanged(self.index().path(), id, entry).ok()?;
        MeshGeometry::new(&mesh, Some(entry.content))
    }

    /// Searches for each different component of a query that has several, largest first. A component that cannot be described
    /// is left out.
    pub(super) fn search_components(
        &self,
        query: &Query<'_>,
        options: &SearchOptions,
        budget: &Budget,
    ) -> Result<Vec<ComponentResult>, Error> {
        let Some(whole) = query.geometry else { return Ok(Vec::new()) };
        let mut found = Vec::new();
        for (part, copies) in whole.different_components().into_iter().take(MOST_SEARCHED) {
            budget.check()?;
            let Some(description) = described(part, self.describe_options(), budget)? else { continue };
            let name = match copies {
                1 => format!("a component of {}", query.name),
                _ => format!("each of {copies} components of {}", query.name),
            };
            let known = Query { name: &name, content: None, geometry: Some(part), part: None };
            // The nearest one is wanted.
            let options = SearchOptions { k: 1, rank_by: SearchRank::Plain, ..options.clone() };
            let complete = Completeness::default();
            let nearest = self.nearest(&description.prepare()?, &known, complete, &options, budget)?;
            found.push(ComponentResult {
                copies,
                area_share: (part.size() / whole.size()).powi(2),
                n_vertices: part.n_vertices(),
                nearest: nearest.results.into_iter().next(),
            });
        }
        Ok(found)
    }

    /// The shapes with a component, not the largest, that is the query: nearest first.
    pub(super) fn search_wholes(
        &self,
        shape: &PreparedShape,
        query: &Query<'_>,
        budget: &Budget,
    ) -> Result<Vec<SearchResult>, Error> {
        let asked = ShapeMetric::without_size(shape.fused());
        // Components have no forms in the index, so signatures decide.
        let distance = |stored: &StoredComponent| {
            let known = ShapeMetric::without_size(&stored.fused);
            let combined = ShapeMetric::robust(asked, known);
            ShapeDistance { fused: ShapeMetric::fused(asked, known), combined }
        };
        let mut near: Vec<(ShapeDistance, &str)> = self
            .stored_components()?
            .iter()
            .map(|stored| (distance(stored), stored.id.as_str()))
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
            let verdict = ShapeMetric::verdict(distance, Handedness::Unknown, 1.0);
            let n_components = entry.fact(COMPONENTS).unwrap_or(2.0) as usize;
            let evidence = self.evidence(query, id, verdict)?.of_component(n_components);
            wholes.push(SearchResult {
                rank: wholes.len() + 1,
                id: id.to_owned(),
                label: entry.label,
                path: entry.path,
                distance: distance.combined,
                fused: distance.fused,
                on_graph: None,
                as_part: None,
                verdict,
                comparison: None,
                evidence: Some(evidence),
            });
        }
        Ok(wholes)
    }

    /// The components of all shapes, but the largest of each; read once.
    fn stored_components(&self) -> Result<&[StoredComponent], Error> {
        if let Some(known) = self.components.get() {
            return Ok(known);
        }
        let mut stored = Vec::new();
        for (id, entry) in self.index().entries()? {
            if entry.fact(OTHER_COMPONENTS).is_some() {
                let vectors = components(self.index().vectors(&id)?);
                stored.extend(vectors.into_iter().map(|fused| StoredComponent { id: id.clone(), fused }));
            }
        }
        Ok(self.components.get_or_init(|| stored))
    }
}
