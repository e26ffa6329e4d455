//! What is known of a shortcut.

use serde::Serialize;
use surface::VertexId;

use crate::remap::Remapped;

/// The kind of a shortcut.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ShortcutKind {
    /// Parts of the surface that share one vertex.
    Pinch,
    /// A short and narrow handle, or a short and narrow tunnel.
    Handle,
}

/// A place where two distant parts of a surface are probably welded.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Shortcut {
    /// Whether the parts share a vertex or a handle.
    pub kind: ShortcutKind,
    /// The shared vertex, or a vertex of the shortest loop around the handle.
    pub vertex: VertexId,
    /// Length of the shortest loop around the handle, in mesh units; 0 for a vertex.
    pub girth: f64,
    /// Distance along edges between the two sides once the shortcut is cut, in mesh units.
    pub detour: f64,
}

/// A surface without its shortcuts.
#[derive(Debug, Clone, PartialEq)]
pub struct CutSurface {
    /// The mesh, with new vertices where it was cut. Vertices of a cut that a weld had pulled out of their surface are moved
    /// back.
    pub cut: Remapped,
    /// What was cut: pinches first, then handles from the narrowest to the widest.
    pub shortcuts: Vec<Shortcut>,
}

/// Most handles that are cut, and most shared vertices. A surface with more has them by design.
pub(super) const MOST: usize = 32;
