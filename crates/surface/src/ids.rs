//! Index newtypes, so that a vertex can never be used as a face.

use serde::{Deserialize, Serialize};

/// Index of a vertex of a mesh, counted from zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default, Serialize, Deserialize)]
#[repr(transparent)]
pub struct VertexId(pub u32);

impl VertexId {
    /// The corners of a face in ascending order, by which equal faces are found.
    pub fn sorted(mut face: [Self; 3]) -> [Self; 3] {
        face.sort_unstable();
        face
    }
}

/// Index of a face of a mesh, counted from zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[repr(transparent)]
pub struct FaceId(pub u32);

/// Index of an undirected edge of a [`Topology`](crate::Topology), counted from zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[repr(transparent)]
pub struct EdgeId(pub u32);

/// A corner of a face: corner `i` of face `f` has the index `3 f + i`.
///
/// A corner stands for the vertex in it and for the side of the face opposite it. The side runs from the
/// [next](Self::next) corner to the [previous](Self::prev) one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default, Serialize)]
#[repr(transparent)]
pub struct CornerId(pub u32);

macro_rules! index_newtypes {
    ($($name:ident),+) => {$(
        impl $name {
            /// The index as a `usize`, for slices.
            #[inline]
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }

        impl From<usize> for $name {
            /// # Panics
            /// If `index` does not fit into 32 bits; readers reject such meshes.
            #[inline]
            fn from(index: usize) -> Self {
                assert!(u32::try_from(index).is_ok(), "index {index} does not fit into 32 bits");
                Self(index as u32)
            }
        }

        impl std::fmt::Display for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                self.0.fmt(f)
            }
        }
    )+};
}

index_newtypes!(VertexId, FaceId, EdgeId, CornerId);

impl FaceId {
    /// The corners, in the order of the face's vertices.
    #[inline]
    pub fn corners(self) -> [CornerId; 3] {
        let first = 3 * self.0;
        [CornerId(first), CornerId(first + 1), CornerId(first + 2)]
    }
}

impl CornerId {
    /// The corner in the given slot (0, 1 or 2) of a face.
    #[inline]
    pub fn new(face: FaceId, slot: usize) -> Self {
        Self(3 * face.0 + slot as u32)
    }

    /// The face of this corner.
    #[inline]
    pub fn face(self) -> FaceId {
        FaceId(self.0 / 3)
    }

    /// Which corner of its face this is: 0, 1 or 2.
    #[inline]
    pub fn slot(self) -> usize {
        (self.0 % 3) as usize
    }

    /// The corner after this one in its face.
    #[inline]
    #[must_use]
    pub fn next(self) -> Self {
        // Tables here and below: a branch would be mispredicted every third time.
        Self(self.0.wrapping_add_signed([1, 1, -2][self.slot()]))
    }

    /// The corner before this one in its face.
    #[inline]
    #[must_use]
    pub fn prev(self) -> Self {
        Self(self.0.wrapping_add_signed([2, -1, -1][self.slot()]))
    }
}
