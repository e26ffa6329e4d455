//! Index newtypes: a vertex can never be used where a face is meant.

use serde::{Deserialize, Serialize};

/// Index of a vertex of a mesh, counted from zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[repr(transparent)]
pub struct VertexId(pub u32);

/// Index of a face of a mesh, counted from zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[repr(transparent)]
pub struct FaceId(pub u32);

/// Index of an undirected edge of a [`Topology`](crate::Topology), counted from zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[repr(transparent)]
pub struct EdgeId(pub u32);

/// A corner of a face: corner `i` of face `f` is `3 f + i`. It names the vertex in that corner and,
/// equally, the edge of the face that lies opposite.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[repr(transparent)]
pub struct CornerId(pub u32);

macro_rules! index_newtype {
    ($name:ident) => {
        impl $name {
            /// The index as a `usize`, for slices.
            #[inline]
            #[must_use]
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }

        impl From<usize> for $name {
            /// # Panics
            /// When `index` does not fit into 32 bits; readers reject such meshes before.
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
    };
}

index_newtype!(VertexId);
index_newtype!(FaceId);
index_newtype!(EdgeId);
index_newtype!(CornerId);

impl CornerId {
    /// The face this corner belongs to.
    #[inline]
    #[must_use]
    pub fn face(self) -> FaceId {
        FaceId(self.0 / 3)
    }

    /// Which of the three corners of its face this is: 0, 1 or 2.
    #[inline]
    #[must_use]
    pub fn slot(self) -> usize {
        (self.0 % 3) as usize
    }
}
