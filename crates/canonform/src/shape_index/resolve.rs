//! From what is searched for to what is known of it.

use base::Observer;
use mesh::Surface;
use relations::MeshGeometry;

use super::options::{Explain, SearchOptions, SearchRank};
use super::predict::Completeness;
use super::query::{DescribedQuery, HeldGeometry, KnownQuery, Query};
use super::search::ShapeSearch;
use crate::error::Error;
use crate::form::{describe, describe_part};

impl ShapeSearch {
    /// Describes or looks up a query.
    pub(super) fn resolved<'a>(
        &self,
        query: Query<'a>,
        options: &SearchOptions,
        observer: &dyn Observer,
    ) -> Result<KnownQuery<'a>, Error> {
        let explains = options.explain == Explain::Kind;
        let as_part = options.rank_by == SearchRank::Part;
        let part_of = |surface: &Surface| describe_part(surface, self.describe_options(), observer);
        match query {
            Query::Mesh { mesh, name, content } => {
                let surface = Surface::new(mesh, &self.describe_options().form.repair, observer)?;
                let description = describe(&surface, self.describe_options(), observer)?;
                Ok(KnownQuery {
                    shape: description.prepare()?,
                    form_spectrum: description.form_spectrum(),
                    name,
                    content,
                    geometry: explains
                        .then(|| MeshGeometry::new(mesh, content))
                        .flatten()
                        .map(|geometry| HeldGeometry::Owned(Box::new(geometry))),
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
                    geometry: geometry.filter(|_| explains).map(HeldGeometry::Borrowed),
                    part: surface.filter(|_| as_part).map(part_of).transpose()?,
                    complete: Completeness::of(description),
                })
            }
            Query::Id(id) => {
                let entry = self.index().entry(id)?;
                let geometry = explains.then(|| self.geometry(id, &entry)).flatten();
                let repair = &self.describe_options().form.repair;
                let part = || part_of(&Surface::new(&self.mesh(id)?, repair, observer)?);
                Ok(KnownQuery {
                    shape: self.prepared(id)?,
                    form_spectrum: self.form_spectrum(id)?,
                    name: id,
                    content: Some(entry.content),
                    geometry: geometry.map(|geometry| HeldGeometry::Owned(Box::new(geometry))),
                    part: as_part.then(part).transpose()?,
                    complete: Completeness::of_entry(&entry),
                })
            }
        }
    }
}
