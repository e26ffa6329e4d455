//! What is searched for, and what is known of it.

use std::ops::Deref;

use base::{ContentHash, Observer};
use descriptors::{PartDiscAreas, PreparedShape};
use mesh::{Surface, TriMesh};
use relations::MeshGeometry;

use super::predict::Completeness;
use super::record::{DROPPED, SHORTCUTS};
use super::search::{Explain, SearchOptions, SearchRank, ShapeSearch};
use crate::error::Error;
use crate::form::{ShapeDescription, describe, describe_part};

/// What a query is called unless it has a name.
const UNNAMED: &str = "the query";

/// What is searched for.
#[derive(Debug, Clone, Copy)]
pub enum Query<'a> {
    /// A mesh, which is described as the shapes of the index are.
    Mesh {
        /// The mesh.
        mesh: &'a TriMesh,
        /// What it is called in words.
        name: &'a str,
        /// The [hash](crate::content_hash) of its file.
        content: Option<ContentHash>,
    },
    /// A mesh that was described with the [options of the index](ShapeSearch::describe_options).
    Described(DescribedQuery<'a>),
    /// A shape of the index, which finds itself. Its mesh is read if it is taken as a part, or if results are explained; then
    /// it need not be there.
    Id(&'a str),
}

/// A mesh that was described, with what else is known of it.
#[derive(Debug, Clone, Copy)]
pub struct DescribedQuery<'a> {
    /// The description.
    pub description: &'a ShapeDescription,
    /// The surface that was described. Only with it can the query be taken as a part.
    pub surface: Option<&'a Surface>,
    /// The mesh in space, by which results are explained.
    pub geometry: Option<&'a MeshGeometry>,
    /// What it is called in words.
    pub name: &'a str,
    /// The [hash](crate::content_hash) of its file.
    pub content: Option<ContentHash>,
}

impl<'a> From<&'a TriMesh> for Query<'a> {
    fn from(mesh: &'a TriMesh) -> Self {
        Self::Mesh { mesh, name: UNNAMED, content: None }
    }
}

impl<'a> From<&'a ShapeDescription> for Query<'a> {
    fn from(description: &'a ShapeDescription) -> Self {
        let (surface, geometry, content) = (None, None, None);
        Self::Described(DescribedQuery { description, surface, geometry, name: UNNAMED, content })
    }
}

/// A query with everything that a search needs of it.
pub(super) struct KnownQuery<'a> {
    pub(super) shape: PreparedShape,
    pub(super) name: &'a str,
    pub(super) content: Option<ContentHash>,
    /// If results are explained.
    pub(super) geometry: Option<HeldGeometry<'a>>,
    /// If results are ordered by how the query fits as a part.
    pub(super) part: Option<PartDiscAreas>,
    pub(super) complete: Completeness,
}

/// A geometry of the caller, or one that was made for the search.
pub(super) enum HeldGeometry<'a> {
    Owned(Box<MeshGeometry>),
    Borrowed(&'a MeshGeometry),
}

impl Deref for HeldGeometry<'_> {
    type Target = MeshGeometry;

    fn deref(&self) -> &MeshGeometry {
        match self {
            Self::Owned(geometry) => geometry,
            Self::Borrowed(geometry) => geometry,
        }
    }
}

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
                    name: id,
                    content: Some(entry.content),
                    geometry: geometry.map(|geometry| HeldGeometry::Owned(Box::new(geometry))),
                    part: as_part.then(part).transpose()?,
                    complete: Completeness {
                        dropped: entry.fact(DROPPED).unwrap_or(0.0),
                        shortcuts: entry.fact(SHORTCUTS).unwrap_or(0.0) as usize,
                        ..Completeness::default()
                    },
                })
            }
        }
    }
}
