//! What is searched for.

use std::sync::Arc;
use std::time::Instant;

use base::{ContentHash, Observer};
use descriptors::PartDiscAreas;
use index::Shape;
use mesh::{Surface, TriMesh};
use nalgebra::Point3;
use relations::MeshGeometry;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use surface::VertexId;

use super::explain::components;
use super::found::ComponentResult;
use super::options::{Explain, SearchOptions, SearchRank};
use super::search::{Answer, ShapeSearch};
use crate::error::Error;
use crate::form::{DescribeOptions, ShapeDescription, describe, describe_part};

/// A described shape that is searched for, and what else is known of it. As JSON it can be sent to indexes on other machines.
///
/// [`ShapeSearch::query`] makes one of a mesh, [`ShapeSearch::query_of`] one of a shape of the index.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Query {
    /// What it is called in words.
    pub name: String,
    /// The shape, exactly as an index would store it.
    pub shape: Shape,
    /// The options it was described with, as indexes state them.
    pub options: String,
    /// The [hash](crate::content_hash) of its file.
    pub content: Option<ContentHash>,
    /// What its fit as a part is measured by. Only with it can results be ordered by that.
    pub part: Option<PartDiscAreas>,
    /// The mesh in space, by which results are explained.
    #[serde(serialize_with = "write_mesh", deserialize_with = "read_mesh")]
    pub geometry: Option<Arc<MeshGeometry>>,
    /// Whether it is a component of another query.
    pub(super) is_component: bool,
    /// Wall-clock seconds of describing it.
    #[serde(skip)]
    pub(super) seconds: f64,
}

impl From<&ShapeDescription> for Query {
    fn from(description: &ShapeDescription) -> Self {
        Self {
            name: "the query".to_owned(),
            shape: description.shape(),
            options: description.options.text(),
            content: None,
            part: None,
            geometry: None,
            is_component: false,
            seconds: 0.0,
        }
    }
}

impl Query {
    /// The query with a name, and with the hash of its file.
    #[must_use]
    pub fn named(self, name: &str, content: Option<ContentHash>) -> Self {
        Self { name: name.to_owned(), content, ..self }
    }

    /// The query with what its fit as a part is measured by.
    ///
    /// # Errors
    /// Those of embedding the surface.
    pub fn as_part(
        self,
        surface: &Surface,
        options: &DescribeOptions,
        observer: &dyn Observer,
    ) -> Result<Self, Error> {
        Ok(Self { part: Some(describe_part(surface, options, observer)?), ..self })
    }

    /// The different components of a query that comes with its mesh, as queries of their own. Results are to be found for each.
    ///
    /// # Errors
    /// [`Error::Exceeded`].
    pub fn components(&self, observer: &dyn Observer) -> Result<Vec<(ComponentResult, Self)>, Error> {
        let whole = self.geometry.as_deref().filter(|_| !self.is_component);
        match whole.zip(DescribeOptions::from_text(&self.options)) {
            Some((whole, options)) => components(whole, &self.name, &options, &observer.budget()),
            None => Ok(Vec::new()),
        }
    }
}

impl ShapeSearch {
    /// Describes a mesh as the shapes of the index are, with what a search with these options needs. `name` is what it is called
    /// in words, `content` the [hash](crate::content_hash) of its file.
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
        let description = describe(&surface, describe_options, observer)?;
        let mut query = Query::from(&description).named(name, content);
        if options.rank_by == SearchRank::Part {
            query = query.as_part(&surface, describe_options, observer)?;
        }
        if options.explain == Explain::Kind {
            query.geometry = MeshGeometry::new(mesh, content).map(Arc::new);
        }
        query.seconds = start.elapsed().as_secs_f64();
        Ok(query)
    }

    /// [Searches](Self::search) for a mesh.
    ///
    /// # Errors
    /// As of [`query`](Self::query) and [`search`](Self::search).
    pub fn search_mesh(
        &self,
        mesh: &TriMesh,
        options: &SearchOptions,
        observer: &dyn Observer,
    ) -> Result<Answer, Error> {
        self.search(&self.query(mesh, ("the query", None), options, observer)?, options, observer)
    }

    /// A shape of the index as a query, which finds itself. Its mesh is read if it is taken as a part, or if results are
    /// explained; then it need not be there.
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
        let explains = options.explain == Explain::Kind;
        Ok(Query {
            name: id.to_owned(),
            content: Some(shape.entry.content),
            part: (options.rank_by == SearchRank::Part).then(part).transpose()?,
            geometry: explains.then(|| self.geometry(&shape.entry)).flatten().map(Arc::new),
            options: self.index().options().to_owned(),
            shape,
            is_component: false,
            seconds: 0.0,
        })
    }
}

/// What a geometry is sent as.
#[derive(Serialize, Deserialize)]
struct MeshRecord {
    positions: Vec<[f64; 3]>,
    faces: Vec<[VertexId; 3]>,
    content: Option<ContentHash>,
}

fn write_mesh<S: Serializer>(geometry: &Option<Arc<MeshGeometry>>, out: S) -> Result<S::Ok, S::Error> {
    let record = geometry.as_ref().map(|geometry| {
        let TriMesh { positions, faces } = geometry.to_mesh();
        MeshRecord {
            positions: positions.into_iter().map(Into::into).collect(),
            faces,
            content: geometry.content(),
        }
    });
    record.serialize(out)
}

fn read_mesh<'de, D: Deserializer<'de>>(from: D) -> Result<Option<Arc<MeshGeometry>>, D::Error> {
    let record = Option::<MeshRecord>::deserialize(from)?;
    Ok(record.and_then(|MeshRecord { positions, faces, content }| {
        let positions = positions.into_iter().map(Point3::from).collect();
        MeshGeometry::new(&TriMesh { positions, faces }, content).map(Arc::new)
    }))
}
