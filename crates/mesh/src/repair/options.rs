//! Options of repair.

use serde::{Deserialize, Serialize};

/// Options of [`repair()`](crate::repair()).
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, rename_all = "kebab-case")]
pub struct RepairOptions {
    /// What happens to a mesh with several components. Default: [`ComponentPolicy::Largest`].
    pub components: ComponentPolicy,
    /// Which vertices in the same or nearly the same position are merged. Default: [`Weld::Seams`].
    pub weld: Weld,
    /// Whether faces are oriented. Default: [`Orient::Keep`].
    pub orient: Orient,
}

/// What happens to a mesh with several components.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum ComponentPolicy {
    /// Keep the component with the largest area
    #[default]
    Largest,
    /// Join the components by links, all along narrow gaps
    ///
    /// Links are straight, between vertices: a minimum spanning tree, and links all along gaps that are no wider than the boundary edges beside them.
    Bridge,
    /// Refuse the mesh
    ///
    /// The error is [`MeshError::Disconnected`](crate::MeshError::Disconnected).
    Error,
}

/// Which vertices are merged. Two vertices of one edge are merged only if its length is zero, and vertices that do not
/// coincide only if, along every axis, they and all that are merged with them are within the tolerance.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Weld {
    /// None, except for the two ends of an edge of length zero.
    None,
    /// Boundary vertices in exactly the same position, and the ends of boundary edges that nearly coincide: both ends
    /// of one are within 2 % of the shortest side of the two faces from those of the other. This closes cracks along
    /// seams, and keeps wider gaps open and sheets apart that merely touch.
    #[default]
    Seams,
    /// Boundary vertices within this distance, in mesh units.
    Within(f64),
    /// All vertices in exactly the same position.
    All,
}

impl std::str::FromStr for Weld {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let tolerance: Option<f64> = text.parse().ok().filter(|tolerance: &f64| tolerance.is_finite());
        match text {
            "none" => Ok(Self::None),
            "seams" => Ok(Self::Seams),
            "all" => Ok(Self::All),
            _ => tolerance.filter(|tolerance| *tolerance >= 0.0).map(Self::Within).ok_or_else(|| {
                format!("`{text}` is neither `seams`, `all` or `none` nor a distance in mesh units")
            }),
        }
    }
}

/// Whether faces are flipped so that neighbors are oriented consistently.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Orient {
    /// Flip nothing. Intrinsic geometry does not depend on orientation.
    #[default]
    Keep,
    /// Flip faces, see [`orient_consistently`](crate::orient_consistently).
    Consistent,
}
