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
    n_old: usize,
    /// For every old vertex, its new one; none at all if all keep their numbers.
    to_new: Option<Vec<Option<VertexId>>>,
    /// For every new vertex, the first of its old ones, or one near it; without those that keep their numbers.
    to_old: Vec<VertexId>,
}

impl Remap {
    /// Of old vertices that keep their numbers, with new ones behind them, each from an old one near it.
    pub fn extended(n_old: usize, origins: Vec<VertexId>) -> Self {
        Self { n_old, to_new: None, to_old: origins }
    }

    /// Of old vertices that became one of `n_new`, several perhaps the same, or were dropped.
    ///
    /// # Panics
    /// If a new vertex does not exist.
    pub fn new(to_new: Vec<Option<VertexId>>, n_new: usize) -> Self {
        let n_old = to_new.len();
        let stays = |(old, new): (usize, &Option<VertexId>)| *new == Some(VertexId::from(old));
        if n_old == n_new && to_new.iter().enumerate().all(stays) {
            return Self::extended(n_old, Vec::new());
        }
        let mut to_old = vec![VertexId(u32::MAX); n_new];
        for (old, new) in to_new.iter().enumerate().rev() {
            new.iter().for_each(|new| to_old[new.index()] = VertexId::from(old));
        }
        Self { n_old, to_new: Some(to_new), to_old }
    }

    /// Number of old vertices.
    pub fn n_old(&self) -> usize {
        self.n_old
    }

    /// Number of new vertices.
    pub fn n_new(&self) -> usize {
        self.to_old.len() + if self.to_new.is_none() { self.n_old } else { 0 }
    }

    /// Whether all old vertices keep their numbers.
    pub(crate) fn keeps_numbers(&self) -> bool {
        self.to_new.is_none()
    }

    /// Whether all vertices keep their numbers and there are no others.
    pub fn is_identity(&self) -> bool {
        self.to_new.is_none() && self.to_old.is_empty()
    }

    /// The new vertex of an old one; `None` if it was dropped or does not exist.
    pub fn to_new(&self, old: VertexId) -> Option<VertexId> {
        match &self.to_new {
            Some(to_new) => *to_new.get(old.index())?,
            None => (old.index() < self.n_old).then_some(old),
        }
    }

    /// The old vertex of a new one, or one near it: the first of those that were merged.
    ///
    /// # Panics
    /// If there is no such new vertex.
    pub fn to_old(&self, new: VertexId) -> VertexId {
        let kept = if self.to_new.is_none() { self.n_old } else { 0 };
        new.index().checked_sub(kept).map_or(new, |i| self.to_old[i])
    }

    /// The new vertices of all old ones.
    pub fn all_to_new(&self) -> impl ExactSizeIterator<Item = Option<VertexId>> + '_ {
        (0..self.n_old).map(|old| self.to_new(VertexId::from(old)))
    }

    /// The old vertices near those behind the old ones.
    pub(crate) fn origins(&self) -> &[VertexId] {
        if self.to_new.is_none() { &self.to_old } else { &[] }
    }

    /// This map, and then the next one.
    pub fn then(&self, next: &Self) -> Self {
        let to_old = |new: VertexId| self.to_old(next.to_old(new));
        if self.to_new.is_none() && next.to_new.is_none() {
            let behind = (self.n_old..next.n_new()).map(VertexId::from);
            return Self::extended(self.n_old, behind.map(to_old).collect());
        }
        Self {
            n_old: self.n_old,
            to_new: Some(self.all_to_new().map(|new| next.to_new(new?)).collect()),
            to_old: (0..next.n_new()).map(|new| to_old(VertexId::from(new))).collect(),
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
    /// The mesh itself.
    pub(crate) fn unchanged(mesh: TriMesh) -> Self {
        Self::extended(mesh, Vec::new())
    }

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_in_sequence_lead_where_each_of_them_does() {
        let v = |i: u32| Some(VertexId(i));
        let maps = [
            Remap::new(vec![v(2), None, v(0), v(1), v(0)], 3),
            Remap::extended(3, vec![VertexId(2), VertexId(0)]),
            Remap::extended(5, vec![VertexId(4)]),
            Remap::new(vec![v(0), v(0), v(1), v(2), None, v(3)], 4),
            Remap::extended(4, Vec::new()),
        ];
        let whole = maps.iter().skip(1).fold(maps[0].clone(), |so_far, next| so_far.then(next));
        assert_eq!((whole.n_old(), whole.n_new()), (5, 4));
        for old in (0..6).map(VertexId) {
            let expected = maps.iter().try_fold(old, |at, map| map.to_new(at));
            assert_eq!(whole.to_new(old), expected, "{old}");
        }
        for new in (0..4).map(VertexId) {
            let expected = maps.iter().rev().fold(new, |at, map| map.to_old(at));
            assert_eq!(whole.to_old(new), expected, "{new}");
        }
        assert_eq!(maps[1].then(&maps[2]), Remap::extended(3, vec![VertexId(2), VertexId(0), VertexId(0)]));
        assert!(Remap::new(vec![v(0), v(1)], 2).is_identity() && !whole.is_identity());
    }
}
