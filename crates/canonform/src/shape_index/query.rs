//! What is searched for.

use std::sync::Arc;

use base::{ContentHash, Observer};
use descriptors::{PartDiscAreas, SignatureKind};
use index::Shape;
use mesh::{Surface, TriMesh};
use relations::MeshGeometry;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::options::{SearchOptions, SearchRank};
use crate::error::Error;
use crate::form::{DescribeOptions, describe_part};

/// A described shape that is searched for, and what else is known of it. As JSON it can be sent to indexes on other machines.
///
/// [`ShapeSearch::query`](crate::search::ShapeSearch::query) makes one of a mesh, and
/// [`query_of`](crate::search::ShapeSearch::query_of) one of a shape of the index.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Query {
    /// What it is called in words.
    pub name: String,
    /// The shape, exactly as an index would store it.
    pub shape: Shape,
    /// The options it was described with, as indexes state them.
    pub options: String,
    /// The [hash](crate::collection::content_hash) of its file.
    pub content: Option<ContentHash>,
    /// The shape of the index that it is, which has no vote on its own class. Of a file, that is the first one with its bytes.
    pub id: Option<String>,
    /// What its fit as a part is measured by. Only with it can results be ordered by that.
    pub part: Option<PartDiscAreas>,
    /// The mesh in space, by which results are explained, and ordered if it has noise.
    #[serde(serialize_with = "write_geometry", deserialize_with = "read_geometry")]
    pub geometry: Option<Arc<MeshGeometry>>,
    /// Whether it is a component of another query.
    pub(super) is_component: bool,
    /// Wall-clock seconds of describing it.
    #[serde(skip)]
    pub(super) seconds: f64,
}

impl Query {
    /// A shape that was described with these options.
    pub fn new(shape: Shape, options: &DescribeOptions) -> Self {
        Self {
            name: "the query".to_owned(),
            shape,
            options: options.text(),
            content: None,
            id: None,
            part: None,
            geometry: None,
            is_component: false,
            seconds: 0.0,
        }
    }

    /// The query with a name, and with the hash of its file.
    #[must_use]
    pub fn named(self, name: &str, content: Option<ContentHash>) -> Self {
        Self { name: name.to_owned(), content, ..self }
    }

    /// The query with what a search needs of its mesh and its repaired `surface`.
    ///
    /// # Errors
    /// Those of embedding the surface.
    pub fn with_mesh(
        mut self,
        mesh: &TriMesh,
        surface: &Surface,
        (search, describe): (&SearchOptions, &DescribeOptions),
        observer: &dyn Observer,
    ) -> Result<Self, Error> {
        if search.rank_by == SearchRank::Part {
            self.part = Some(describe_part(surface, describe, observer)?);
        }
        let content = self.content;
        Ok(self.with_geometry(|| MeshGeometry::new(mesh, content), search))
    }

    /// The query with its mesh in space, if that is needed to explain results or to order them.
    pub(super) fn with_geometry(
        mut self,
        geometry: impl FnOnce() -> Option<MeshGeometry>,
        options: &SearchOptions,
    ) -> Self {
        if options.explain || matches!(options.rank_by, SearchRank::Plain | SearchRank::Graph) {
            self.geometry = geometry().map(Arc::new);
        }
        if !options.explain && self.noisy_surface().is_none() {
            self.geometry = None;
        }
        self
    }

    /// Its mesh in space, unless it is a part without noise: a part with noise may be described as a body.
    pub(super) fn noisy_surface(&self) -> Option<&MeshGeometry> {
        let is_mechanical = self.shape.signatures.contains_key(SignatureKind::Rigid.name());
        self.geometry.as_deref().filter(|geometry| !is_mechanical || geometry.has_noisy_planes())
    }
}

fn write_geometry<S: Serializer>(geometry: &Option<Arc<MeshGeometry>>, out: S) -> Result<S::Ok, S::Error> {
    geometry.as_deref().serialize(out)
}

fn read_geometry<'de, D: Deserializer<'de>>(from: D) -> Result<Option<Arc<MeshGeometry>>, D::Error> {
    Ok(Option::<MeshGeometry>::deserialize(from)?.map(Arc::new))
}
