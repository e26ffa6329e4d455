//! Kinds of match and what they are told from.

use serde::Serialize;

/// How two meshes match, by what changed least. The kinds are in descending order of what the meshes have in common.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum EvidenceKind {
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
    /// Some components of one mesh are the other mesh.
    PartOf,
    /// The same shape in another pose.
    OtherPose,
    /// Two shapes of one class.
    SameClass,
    /// Shapes of different classes.
    Different,
}

/// A change from the first mesh to the second. Several can be combined.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
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
}

/// What the evidence is taken from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Basis {
    /// The bytes of both files.
    Files,
    /// Both meshes. In a search, the file of the shape was read again.
    Meshes,
    /// What an index stores of the shapes: the file of one is missing or has changed.
    Descriptions,
}
