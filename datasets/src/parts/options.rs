//! How parts become triangles.

/// How the surface of a [`MechanicalPart`](super::MechanicalPart) is divided into triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PartMesh {
    /// Number of segments of a full circle, at least 6.
    pub arcs: usize,
    /// How planar faces are divided.
    pub diagonals: Diagonals,
}

impl Default for PartMesh {
    fn default() -> Self {
        Self { arcs: 32, diagonals: Diagonals::Clipped }
    }
}

/// How planar faces are divided into triangles. The surface is the same, and so are its vertices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Diagonals {
    /// By clipping ears: many triangles are long and thin.
    Clipped,
    /// With other diagonals, which make the worst triangles better.
    Even,
}
