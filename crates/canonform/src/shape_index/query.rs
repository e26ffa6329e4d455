//! What is searched for, and what is known of it.

use base::ContentHash;
use descriptors::{PartDiscAreas, PreparedShape};
use mesh::{Surface, TriMesh};
use relations::MeshGeometry;

use super::predict::Completeness;
use crate::form::ShapeDescription;

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
    /// A mesh that was described with the [options of the index](crate::ShapeSearch::describe_options).
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
    pub(super) geometry: Option<&'a MeshGeometry>,
    /// The spectrum of its form, with the precision of an index.
    pub(super) form_spectrum: Vec<f32>,
    /// If results are ordered by how the query fits as a part.
    pub(super) part: Option<PartDiscAreas>,
    pub(super) complete: Completeness,
}
