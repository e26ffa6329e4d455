//! Kinds of relation, and changes between two meshes.

use serde::{Deserialize, Serialize};

/// How two meshes are related, by what changed least.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RelationKind {
    /// The files have the same bytes.
    IdenticalFile,
    /// The same vertices and faces at the same size, perhaps moved, turned or in another order.
    IdenticalGeometry,
    /// The same vertices and faces at another size.
    Scaled,
    /// The same vertices and faces after a reflection, perhaps at another size.
    Mirrored,
    /// The same faces, with noise on the vertices.
    Noisy,
    /// The same surface with other triangles: decimated, subdivided or remeshed.
    Remeshed,
    /// All components of one mesh are the other mesh.
    Copies,
    /// Some components of one mesh are the other mesh, or one was cut out of the other.
    PartOf,
    /// The same part with another hole, thickness, length or detail.
    Variant,
    /// The same shape in another pose.
    OtherPose,
    /// Two shapes of one class.
    SameClass,
    /// Shapes of different classes.
    Different,
}

impl RelationKind {
    /// All kinds, in descending order of what the meshes have in common.
    pub const ALL: [Self; 12] = [
        Self::IdenticalFile,
        Self::IdenticalGeometry,
        Self::Scaled,
        Self::Mirrored,
        Self::Noisy,
        Self::Remeshed,
        Self::Copies,
        Self::PartOf,
        Self::Variant,
        Self::OtherPose,
        Self::SameClass,
        Self::Different,
    ];

    /// Whether both have the same vertices and faces at one size.
    pub fn is_one_geometry(self) -> bool {
        matches!(self, Self::IdenticalFile | Self::IdenticalGeometry)
    }

    /// Whether both are one surface, at any size, mirrored or not.
    pub fn is_one_surface(self) -> bool {
        self.is_one_geometry() || matches!(self, Self::Scaled | Self::Mirrored | Self::Noisy | Self::Remeshed)
    }

    /// Whether the distance of their shapes is all that says so.
    pub fn is_by_distance(self) -> bool {
        matches!(self, Self::OtherPose | Self::SameClass | Self::Different)
    }

    /// What the two have in common, in a few words.
    pub fn words(self) -> &'static str {
        match self {
            Self::IdenticalFile => "the same file",
            Self::IdenticalGeometry => "the same geometry",
            Self::Scaled => "the same geometry, scaled",
            Self::Mirrored => "the mirror image",
            Self::Noisy => "the same surface with noise",
            Self::Remeshed => "the same surface, remeshed",
            Self::Copies => "several copies",
            Self::PartOf => "one is part of the other",
            Self::Variant => "a variant of the same part",
            Self::OtherPose => "the same shape",
            Self::SameClass => "a similar shape",
            Self::Different => "not the same shape",
        }
    }
}

/// A change from the first mesh to the second. Several can be combined.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Change {
    /// It lies elsewhere.
    Moved,
    /// It is turned.
    Rotated,
    /// It has another size.
    Scaled,
    /// It is the mirror image.
    Mirrored,
    /// It has fewer vertices.
    Decimated,
    /// It has the same vertices and more.
    Subdivided,
    /// It has other triangles.
    Remeshed,
    /// One of the two has noise.
    Noisy,
    /// It is in another pose, or may be.
    Posed,
    /// One was cut out of the other.
    Cut,
}

impl Change {
    /// Of a mesh that is larger by a factor, beyond a tolerance, and perhaps a mirror image.
    pub(super) fn from_similarity(scale: f64, tolerance: f64, mirrored: bool) -> Vec<Self> {
        let is_resized = scale.ln().abs() > tolerance;
        let changes = [(is_resized, Self::Scaled), (mirrored, Self::Mirrored)];
        changes.into_iter().filter_map(|(is_changed, change)| is_changed.then_some(change)).collect()
    }
}
