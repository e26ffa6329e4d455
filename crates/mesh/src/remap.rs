//! Where the vertices of a mesh went, and where those of the new mesh came from.

use serde::{Deserialize, Serialize};
use surface::VertexId;

use crate::tri_mesh::TriMesh;

/// The vertices of a mesh that was made of another one.
///
/// ```
/// use canonform_mesh::Remap;
/// use surface::VertexId;
///
/// // Vertex 1 was dropped and vertex 3 merged into vertex 0; then a copy of the last vertex was added.
/// let repaired = Remap::new([Some(0), None, Some(1), Some(0)].map(|v| v.map(VertexId)).to_vec(), 2);
/// let copied = repaired.then(&Remap::extended(2, vec![VertexId(1)]));
/// assert_eq!((copied.to_new(VertexId(1)), copied.to_new(VertexId(3))), (None, Some(VertexId(0))));
/// assert_eq!((copied.to_old(VertexId(2)), copied.n_new()), (VertexId(2), 3));
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Remap {
    /// For every old vertex, its new one.
    to_new: Vec<Option<VertexId>>,
    /// For every new vertex, the first of its old ones, or one near it.
    to_old: Vec<VertexId>,
}

impl Remap {
    /// Of old vertices that keep their numbers, with new ones behind them, each from an old one near it.
    pub fn extended(n_old: usize, origins: Vec<VertexId>) -> Self {
        let old = || (0..n_old).map(VertexId::from);
        Self { to_new: old().map(Some).collect(), to_old: old().chain(origins).collect() }
    }

    /// Of old vertices that became one of `n_new`, several perhaps the same, or were dropped.
    ///
    /// # Panics
    /// If a new vertex does not exist.
    pub fn new(to_new: Vec<Option<VertexId>>, n_new: usize) -> Self {
        let mut to_old = vec![VertexId(u32::MAX); n_new];
        for (old, new) in to_new.iter().enumerate().rev() {
            new.iter().for_each(|new| to_old[new.index()] = VertexId::from(old));
        }
        Self { to_new, to_old }
    }

    /// Number of old vertices.
    pub fn n_old(&self) -> usize {
        self.to_new.len()
    }

    /// Number of new vertices.
    pub fn n_new(&self) -> usize {
        self.to_old.len()
    }

    /// Whether all old vertices keep their numbers.
    pub(crate) fn keeps_numbers(&self) -> bool {
        self.to_new.iter().zip(0..).all(|(new, old)| *new == Some(VertexId(old)))
    }

    /// Whether all vertices keep their numbers and there are no others.
    pub fn is_identity(&self) -> bool {
        self.n_old() == self.n_new() && self.keeps_numbers()
    }

    /// The new vertex of an old one; `None` if it was dropped or does not exist.
    pub fn to_new(&self, old: VertexId) -> Option<VertexId> {
        *self.to_new.get(old.index())?
    }

    /// The old vertex of a new one, or one near it: the first of those that were merged.
    ///
    /// # Panics
    /// If there is no such new vertex.
    pub fn to_old(&self, new: VertexId) -> VertexId {
        self.to_old[new.index()]
    }

    /// The new vertices of all old ones.
    pub fn all_to_new(&self) -> impl ExactSizeIterator<Item = Option<VertexId>> + '_ {
        self.to_new.iter().copied()
    }

    /// The old vertices near those behind the old ones, if these keep their numbers.
    pub(crate) fn origins(&self) -> &[VertexId] {
        &self.to_old[self.n_old()..]
    }

    /// This map, and then the next one.
    pub fn then(&self, next: &Self) -> Self {
        Self {
            to_new: self.all_to_new().map(|new| next.to_new(new?)).collect(),
            to_old: next.to_old.iter().map(|new| self.to_old(*new)).collect(),
        }
    }
}

/// A mesh that was made of another one.
#[derive(Debug, Clone, PartialEq)]
pub struct Remapped {
    /// The new mesh.
    pub mesh: TriMesh,
    /// From the old mesh to the new one.
    pub remap: Remap,
}

impl Remapped {
    /// A mesh whose last vertices are new.
    pub(crate) fn extended(mesh: TriMesh, origins: Vec<VertexId>) -> Self {
        Self { remap: Remap::extended(mesh.n_vertices() - origins.len(), origins), mesh }
    }

    /// What `next` made of this mesh.
    #[must_use]
    pub fn then(self, next: Self) -> Self {
        Self { mesh: next.mesh, remap: self.remap.then(&next.remap) }
    }
}
