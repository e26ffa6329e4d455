//! What kind of match a query and a shape of an index are.

use descriptors::{Verdict, VerdictKind};
use index::ShapeEntry;

use super::record::COMPONENTS;
use super::search::{Query, ShapeSearch};
use super::source::read_unchanged;
use crate::compare::{MatchEvidence, MeshGeometry};
use crate::error::Error;

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
}
