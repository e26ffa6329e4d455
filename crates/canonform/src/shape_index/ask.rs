//! Queries made of meshes and of shapes of an index.

use std::time::Instant;

use base::{ContentHash, Observer};
use mesh::{Surface, TriMesh};

use super::options::{SearchOptions, SearchRank};
use super::query::Query;
use super::search::ShapeSearch;
use crate::error::Error;
use crate::form::{describe, describe_part};

impl ShapeSearch {
    /// Describes a mesh as the shapes of the index are, with what a search with these options needs. `name` is what it is called
    /// in words, `content` the [hash](crate::collection::content_hash) of its file.
    ///
    /// # Errors
    /// Those of describing a mesh.
    pub fn query(
        &self,
        mesh: &TriMesh,
        (name, content): (&str, Option<ContentHash>),
        options: &SearchOptions,
        observer: &dyn Observer,
    ) -> Result<Query, Error> {
        let start = Instant::now();
        let describe_options = self.describe_options();
        let surface = Surface::new(mesh, &describe_options.form.repair, observer)?;
        let query = Query::new(describe(&surface, describe_options, observer)?, describe_options);
        let query =
            query.named(name, content).with_mesh(mesh, &surface, (options, describe_options), observer)?;
        Ok(Query { seconds: start.elapsed().as_secs_f64(), ..query })
    }

    /// A shape of the index as a query, which finds itself. Its mesh is read, but need not be there unless it is taken
    /// as a part.
    ///
    /// # Errors
    /// [`Error::Index`] for an unknown shape; for a part [`Error::MeshGone`] and [`Error::MeshChanged`].
    pub fn query_of(
        &self,
        id: &str,
        options: &SearchOptions,
        observer: &dyn Observer,
    ) -> Result<Query, Error> {
        let shape = self.index().shape(id)?;
        let describe_options = self.describe_options();
        let part = || {
            let surface = Surface::new(&self.mesh(id)?, &describe_options.form.repair, observer)?;
            describe_part(&surface, describe_options, observer)
        };
        let part = (options.rank_by == SearchRank::Part).then(part).transpose()?;
        let entry = shape.entry.clone();
        let query = Query::new(shape, describe_options).named(id, Some(entry.content));
        let query = Query { part, id: Some(id.to_owned()), ..query };
        Ok(query.with_geometry(|| self.geometry(&entry), options))
    }
}
