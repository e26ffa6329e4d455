//! What repair is to do beyond what is needed.

use serde::{Deserialize, Serialize};

/// Options of [`repair()`](crate::repair()).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(default, rename_all = "kebab-case")]
pub struct RepairOptions {
    /// What happens to a mesh in several pieces. Default: [`ComponentPolicy::Largest`].
    pub components: ComponentPolicy,
    /// Which vertices in the same place become one. Default: [`Weld::Seams`].
    pub weld: Weld,
    /// Whether faces are turned over. Default: [`Orient::Keep`].
    pub orient: Orient,
}

/// What happens to a mesh in several pieces.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ComponentPolicy {
    /// Only the piece of the largest area stays.
    #[default]
    Largest,
    /// All pieces stay and are joined by the shortest straight links between vertices, a minimum
    /// spanning set of them.
    Bridge,
    /// [`MeshError::Disconnected`](crate::MeshError::Disconnected).
    Error,
}

/// Which vertices in exactly the same place become one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Weld {
    /// None, but for the two ends of an edge of length zero.
    None,
    /// Those that lie on a boundary: cracks along seams are closed, while sheets that merely touch
    /// stay apart.
    #[default]
    Seams,
    /// All of them.
    All,
}

/// Whether faces are turned over so that neighbours run the same way round.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Orient {
    /// They stay as they are; nothing intrinsic depends on it.
    #[default]
    Keep,
    /// They are, see [`orient_consistently`](crate::orient_consistently).
    Consistent,
}
