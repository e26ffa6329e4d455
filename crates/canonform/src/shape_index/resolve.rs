//! From what is searched for to what is known of it.

use base::Observer;
use mesh::Surface;
use relations::MeshGeometry;

use super::options::{Explain, SearchOptions, SearchRank};
use super::predict::Completeness;
use super::query::{DescribedQuery, KnownQuery, Query};
use super::search::ShapeSearch;
use crate::error::Error;
use crate::form::{describe, describe_part};

impl ShapeSearch {
    /// Describes or looks up a query. A geometry that explanations need is kept in `made`.
    pub(super) fn resolved<'a>(
        &self,
        query: Query<'a>,
        options: &SearchOptions,
        made: &'a mut Option<MeshGeometry>,
        observer: &dyn Observer,
    ) -> Result<KnownQuery<'a>, Error> {
        let explains = options.explain == Explain::Kind;
        let as_part = options.rank_by == SearchRank::Part;
        let repair = &self.describe_options().form.repair;
        let part_of = |surface: &Surface| describe_part(surface, self.describe_options(), observer);
        match query {
            Query::Mesh { mesh, name, content } => {
                let surface = Surface::new(mesh, repair, observer)?;
                let description = describe(&surface, self.describe_options(), observer)?;
                *made = explains.then(|| MeshGeometry::new(mesh, content)).flatten();
                Ok(KnownQuery {
                    shape: description.prepare()?,
                    form_spectrum: description.form_spectrum(),
                    name,
                    content,
                    geometry: made.as_ref(),
                    part: as_part.then(|| part_of(&surface)).transpose()?,
                    complete: Completeness::of(&description),
                })
            }
            Query::Described(DescribedQuery { description, surface, geometry, name, content }) => {
                self.index().expect_options(&description.options.text())?;
                Ok(KnownQuery {
                    shape: description.prepare()?,
                    form_spectrum: description.form_spectrum(),
                    name,
                    content,
                    geometry: geometry.filter(|_| explains),
                    part: surface.filter(|_| as_part).map(part_of).transpose()?,
                    complete: Completeness::of(description),
                })
            }
            Query::Id(id) => {
                let entry = self.index().entry(id)?;
                *made = explains.then(|| self.geometry(id, &entry)).flatten();
                let part = || part_of(&Surface::new(&self.mesh(id)?, repair, observer)?);
                Ok(KnownQuery {
                    shape: self.prepared(id)?,
                    form_spectrum: self.form_spectrum(id)?,
                    name: id,
                    content: Some(entry.content),
                    geometry: made.as_ref(),
                    part: as_part.then(part).transpose()?,
                    complete: Completeness::of_entry(&entry),
                })
            }
        }
    }
}
